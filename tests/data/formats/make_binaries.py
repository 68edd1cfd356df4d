#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the binary sample files of this folder: a box 1 x 2 x 3, some with a lamp on top.

3DS: two materials, a spot, a point light and a camera; z is up in that format.
"""
import struct

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 2, 0), (0, 2, 0), (0, 0, 3), (1, 0, 3), (1, 2, 3), (0, 2, 3)]
SIDES = [(3, 2, 1, 0), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7), (4, 5, 6, 7)]
TRIANGLES = [t for s in SIDES for t in ((s[0], s[1], s[2]), (s[0], s[2], s[3]))]


def write(name, data):
    with open(name, "wb") as file:
        file.write(data)


def ply(endian, word):
    head = (f"ply\nformat binary_{word}_endian 1.0\ncomment box 1 x 2 x 3\nelement vertex 8\n"
            "property float x\nproperty float y\nproperty double z\nproperty uchar red\n"
            "element face 6\nproperty list uchar int vertex_indices\nend_header\n")
    body = b"".join(struct.pack(endian + "ffdB", *p, 200) for p in CORNERS)
    body += b"".join(struct.pack(endian + "B4i", 4, *s) for s in SIDES)
    return head.encode() + body


def stl():
    def facet(t):
        flat = [c for i in t for c in CORNERS[i]]
        return struct.pack("<12fH", 0, 0, 0, *flat, 0)
    return b"solid but binary".ljust(80, b"\0") + struct.pack("<I", len(TRIANGLES)) + \
        b"".join(facet(t) for t in TRIANGLES)


def chunk(kind, *parts):
    body = b"".join(parts)
    return struct.pack("<HI", kind, 6 + len(body)) + body


def text(name):
    return name.encode() + b"\0"


def floats(*values):
    return struct.pack(f"<{len(values)}f", *values)


def material(name, diffuse, shine=None):
    parts = [chunk(0xA000, text(name)), chunk(0xA020, chunk(0x0010, floats(*diffuse)))]
    if shine is not None:
        parts.append(chunk(0xA084, chunk(0x0030, struct.pack("<H", shine))))
    return chunk(0xAFFF, *parts)


def mesh():
    faces = struct.pack("<H", 12) + b"".join(struct.pack("<4H", *t, 7) for t in TRIANGLES)
    groups = b"".join(chunk(0x4130, text(name), struct.pack(f"<H{len(ids)}H", len(ids), *ids))
                      for name, ids in (("wall", range(10)), ("lid", (10, 11))))
    points = struct.pack("<H", 8) + floats(*[c for p in CORNERS for c in p])
    return chunk(0x4000, text("box"), chunk(0x4100, chunk(0x4110, points),
                                            chunk(0x4120, faces, groups)))


def discreet():
    lamp = chunk(0x4000, text("lamp"), chunk(0x4600, floats(0.5, 1, 2), chunk(0x0010, floats(1, 0.5, 0.25)),
                                             chunk(0x465B, floats(8))))
    spot = chunk(0x4000, text("spot"), chunk(0x4600, floats(0.5, 1, 2.5), chunk(0x0010, floats(1, 1, 1)),
                                             chunk(0x4610, floats(0.5, 1, 0, 30, 50))))
    camera = chunk(0x4000, text("camera"), chunk(0x4700, floats(0.5, -4, 1.5, 0.5, 1, 1.5, 0, 40)))
    edit = chunk(0x3D3D, chunk(0x3D3E, struct.pack("<I", 3)),
                 material("wall", (0.5, 0.25, 0.75)), material("lid", (0.125, 0.5, 0.5)),
                 mesh(), lamp, spot, camera)
    return chunk(0x4D4D, chunk(0x0002, struct.pack("<I", 3)), edit)


write("box_little.ply", ply("<", "little"))
write("box_big.ply", ply(">", "big"))
write("box_binary.stl", stl())
write("box.3ds", discreet())

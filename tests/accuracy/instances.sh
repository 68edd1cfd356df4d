#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A crowd of one wavy ball in a hall, by reference: memory and seconds. Give the mesh's rings (708
# makes 1,001,112 triangles) and how many times it stands along each side of a square (32: 10^9
# triangles), and options of render, if any. With TO=FOLDER the files are only made there.
#   ISOLUX=build/isolux tests/accuracy/instances.sh 708 32
set -eu
rings=${1:-708} side=${2:-32}
shift $(($# < 2 ? $# : 2))
dir=${TO:-$(mktemp -d)}
[ -n "${TO:-}" ] || trap 'rm -rf "$dir"' EXIT

# A ball whose radius waves, of `rings` rings of as many quads, its poles fans of triangles.
awk -v n="$rings" 'BEGIN {
    pi = atan2(0, -1)
    print "ply\nformat ascii 1.0\nelement vertex " n * (n - 1) + 2
    print "property float x\nproperty float y\nproperty float z"
    print "element face " 2 * n * (n - 1) "\nproperty list uchar int vertex_indices\nend_header"
    for (i = 1; i < n; i++)
        for (k = 0; k < n; k++) {
            a = pi * i / n
            b = 2 * pi * k / n
            r = 1 + 0.15 * sin(7 * b) * sin(a) ^ 3 * sin(5 * a)
            printf "%.7g %.7g %.7g\n", r * sin(a) * cos(b), r * sin(a) * sin(b), r * cos(a)
        }
    print "0 0 1\n0 0 -1"
    top = n * (n - 1)
    for (k = 0; k < n; k++) {
        j = (k + 1) % n
        print 3, top, k, j
        for (i = 0; i < n - 2; i++) {
            print 3, i * n + k, (i + 1) * n + k, (i + 1) * n + j
            print 3, i * n + k, (i + 1) * n + j, i * n + j
        }
        print 3, top - n + k, top + 1, top - n + j
    }
}' >"$dir/ball.ply"

awk -v n="$side" 'BEGIN {
    w = 2.2 * n
    printf "SCREEN <320, 200> EYEP (%g, %g, %g) LOOKP (%g, %g, 0) UP (0, 0, 1) FOV <45>\n",
        -0.25 * w, -0.25 * w, 3 + 0.3 * w, 0.45 * w, 0.45 * w
    print "BACKGROUND (0.3, 0.4, 0.6)"
    print "SURFACE 1 0 ; (0.5, 0.5, 0.5) 1 ; (0, 0, 0) 0, 1"
    print "SURFACE 2 0 ; (0.7, 0.3, 0.2) 1 ; (0, 0, 0) 0, 1"
    print "SURFACE 3 0 ; (0.2, 0.5, 0.3) 1 ; (0, 0, 0) 0, 1"
    print "SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (9, 8, 7)"
    printf "QUADRANGLE 1 (%g, %g, -1.2) (%g, %g, -1.2) (%g, %g, -1.2) (%g, %g, -1.2)\n",
        -w, -w, 2 * w, -w, 2 * w, 2 * w, -w, 2 * w
    z = 0.8 * w + 4
    printf "QUADRANGLE 4 (0, 0, %g) (0, %g, %g) (%g, %g, %g) (%g, 0, %g)\n", z, w, z, w, w, z, w, z
    for (i = 0; i < n * n; i++)
        printf "SCALE(%g, %g, %g) * ROT_X(%g) * ROT_Z(%g) * TRANS(%g, %g, 0) " \
            "BREPOBJ %d \"ball.ply\"\n",
            1 - 0.3 * (i % 3 == 0), 1, 1 - 0.2 * (i % 4 == 1), 37 * i % 360, 101 * i % 360,
            2.2 * (i % n), 2.2 * int(i / n), 2 + i % 2
}' >"$dir/crowd.msd"
[ -z "${TO:-}" ] || exit 0

/usr/bin/time -f "%e s by the clock, %U s of processor, %M KB at most" "${ISOLUX:-build/isolux}" \
    render "$dir/crowd.msd" --renderer path --spp 16 --progress plain \
    -o "${PICTURE:-$dir/crowd}.exr" "$@"

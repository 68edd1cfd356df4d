#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Meshes by reference: the same picture as of all faces, the same bytes from any threads; refusals.
. "$(dirname "$0")/tap.inc"
TO=$DIR tests/accuracy/instances.sh 12 3
crowd=$DIR/crowd.msd
fast=(--renderer path --spp 16 --size 48x30 --progress none)

ok "faces of all copies" exits 0 render "$crowd" "${fast[@]}" --instances flatten \
    -o "$DIR/flat.exr" --json "$DIR/flat.json"
ok "references" exits 0 render "$crowd" "${fast[@]}" --instances keep -o "$DIR/kept.exr" \
    --json "$DIR/kept.json"
ok "few copies are faces by default" exits 0 render "$crowd" "${fast[@]}" -o "$DIR/auto.exr"
ok "compare the two" exits 0 compare "$DIR/flat.exr" "$DIR/auto.exr" --json "$DIR/c.json"
ok "they are one" grep -q '"all": 0.0' "$DIR/c.json"
# 2 * 12 * 11 triangles, nine times, and two squares.
ok "triangles of faces" grep -q '"triangles": 2380' "$DIR/flat.json"
ok "own triangles" grep -q '"triangles": 4' "$DIR/kept.json"
ok "triangles in all" grep -q '"triangles_in_all": 2380' "$DIR/kept.json"
ok "placed" grep -q '"placed_meshes": 9' "$DIR/kept.json"

# The samples are the same, so only rounding tells the two apart: it moves the few rays that pass
# edges nearer than that. Copies are turned but not stretched: a kept mesh is smooth in its own
# space.
sed 's/SCALE([^)]*) \* //' "$crowd" >"$DIR/turned.msd"
ok "turned, faces" exits 0 render "$DIR/turned.msd" "${fast[@]}" --instances flatten \
    -o "$DIR/tf.exr"
ok "turned, kept" exits 0 render "$DIR/turned.msd" "${fast[@]}" --instances keep -o "$DIR/tk.exr"
ok "compared" exits 0 compare "$DIR/tf.exr" "$DIR/tk.exr" --json "$DIR/c.json"
ok "the same picture" awk '/"all":/ { sub(/,/, ""); exit !($2 < 0.01) }' "$DIR/c.json"
ok "one thread" exits 0 render "$crowd" "${fast[@]}" --instances keep --threads 1 -o "$DIR/1.exr"
ok "three threads" exits 0 render "$crowd" "${fast[@]}" --instances keep --threads 3 -o "$DIR/3.exr"
ok "same numbers" cmp "$DIR/1.exr" "$DIR/3.exr"
ok "same picture" cmp "$DIR/1.png" "$DIR/3.png"

ok "no patches of references" fails 3 'by reference; patches need them flattened.* GB' \
    render "$crowd" --instances keep
ok "nor to solve" fails 3 'renderer path' solve "$crowd" --instances keep
ok "check" exits 0 check "$crowd" --instances keep
ok "counts them" grep -q 'placed  *9 times one of 1 meshes.* 2380 triangles in all' "$DIR/out"
sed '/^QUADRANGLE 4/d; s/BREPOBJ 3/BREPOBJ 4/' "$crowd" >"$DIR/lamps.msd"
ok "lamps by reference" exits 0 render "$DIR/lamps.msd" --instances keep --renderer path --spp 1 \
    --size 8x5 --progress plain -o "$DIR/l.exr"
ok "their noise is told of" grep -q '4 meshes that give light.*lamps-by-chance' "$DIR/err"
# glTF: an octahedron that five nodes show, one mirrored, one beneath another; floor and lamp.
# The numbers 0, 1, -1 in float, then indices.
octa_bytes() {
    local o='\0\0\0\0' l='\0\0\200\77' m='\0\0\200\277'
    printf "$l$o$o$m$o$o$o$l$o$o$m$o$o$o$l$o$o$m" # x, -x, y, -y, z, -z
    printf "$m$o$l$l$o$l$l$o$m$m$o$m"             # a square, seen from above
    printf '\0\2\4\2\1\4\1\3\4\3\0\4\2\0\5\1\2\5\3\1\5\0\3\5'
    printf '\0\1\2\0\2\3'
}
octa_bytes >"$DIR/octa.bin"
cat >"$DIR/octa.gltf" <<'END'
{ "asset": { "version": "2.0" }, "buffers": [ { "uri": "octa.bin", "byteLength": 150 } ],
  "bufferViews": [ { "buffer": 0, "byteLength": 120 },
    { "buffer": 0, "byteOffset": 120, "byteLength": 30 } ],
  "accessors": [
    { "bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3" },
    { "bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 4, "type": "VEC3" },
    { "bufferView": 1, "componentType": 5121, "count": 24, "type": "SCALAR" },
    { "bufferView": 1, "byteOffset": 24, "componentType": 5121, "count": 6, "type": "SCALAR" } ],
  "materials": [ { "name": "red", "pbrMetallicRoughness": { "metallicFactor": 0,
      "baseColorFactor": [ 0.7, 0.3, 0.2, 1 ] } },
    { "name": "lamp", "emissiveFactor": [ 1, 1, 1 ] }, { "name": "grey" } ],
  "meshes": [
    { "primitives": [ { "attributes": { "POSITION": 0 }, "indices": 2, "material": 0 } ] },
    { "primitives": [ { "attributes": { "POSITION": 1 }, "indices": 3, "material": 1 } ] },
    { "primitives": [ { "attributes": { "POSITION": 1 }, "indices": 3, "material": 2 } ] } ],
  "cameras": [ { "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.1 } } ],
  "nodes": [ { "camera": 0, "translation": [ 0, 2, 9 ] },
    { "mesh": 2, "scale": [ 6, 1, 6 ], "translation": [ 0, -1, 0 ] },
    { "mesh": 1, "scale": [ 2, -1, 2 ], "translation": [ 0, 6, 0 ] },
    { "mesh": 0 }, { "mesh": 0, "translation": [ 3, 0, 1 ], "scale": [ -1, 1, 0.5 ] },
    { "mesh": 0, "translation": [ -3, 0, 0 ], "rotation": [ 0, 0.6, 0, 0.8 ] },
    { "translation": [ 0, 2.5, 0 ], "children": [ 7, 8 ] },
    { "mesh": 0, "scale": [ 0.5, 0.5, 0.5 ] }, { "mesh": 0, "translation": [ 2, 0, -1 ] } ] }
END
ok "glTF as faces" exits 0 render "$DIR/octa.gltf" "${fast[@]}" -o "$DIR/oflat.exr" \
    --json "$DIR/oflat.json"
ok "glTF by reference" exits 0 render "$DIR/octa.gltf" "${fast[@]}" --instances keep \
    -o "$DIR/okept.exr" --json "$DIR/okept.json"
ok "its faces" grep -q '"triangles": 44' "$DIR/oflat.json"
ok "its own faces" grep -q '"triangles": 4' "$DIR/okept.json"
ok "and all" grep -q '"triangles_in_all": 44' "$DIR/okept.json"
ok "five places" grep -q '"placed_meshes": 5' "$DIR/okept.json"
ok "glTF compared" exits 0 compare "$DIR/oflat.exr" "$DIR/okept.exr" --json "$DIR/c.json"
ok "one picture of glTF" awk '/"all":/ { sub(/,/, ""); exit !($2 < 0.01) }' "$DIR/c.json"
ok "of light and shadow" exits 0 check "$DIR/octa.gltf" --instances keep
ok "check counts glTF's" grep -q 'placed  *5 times one of 1 meshes.* 44 triangles in all' \
    "$DIR/out"
ok "a wrong word" fails 2 'instances' render "$crowd" --instances some
finish

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
# edges nearer than that.
ok "compared" exits 0 compare "$DIR/flat.exr" "$DIR/kept.exr" --json "$DIR/c.json"
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
ok "a wrong word" fails 2 'instances' render "$crowd" --instances some
finish

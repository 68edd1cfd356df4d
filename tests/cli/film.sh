#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Pictures otherwise: projections, parts, lens, filters, tone curves, false colours, develop.
. "$(dirname "$0")/tap.inc"
box=scenes/files/cornell.msd
fast=(--quality draft --patches 200 --rays 16 --spp 2 --size 64x48 --progress none)

differ() { ! cmp -s "$1" "$2" && [ -s "$1" ] && [ -s "$2" ]; }
is_png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ]; }

# has_window FILE LEFT TOP RIGHT BOTTOM: the EXR's data window, which follows its name, its type and
# four bytes of size.
has_window() {
    local at
    at=$(grep -obUa dataWindow "$1" | head -n 1 | cut -d : -f 1)
    [ "$(od -A n -t d4 -j $((at + 21)) -N 16 "$1" | xargs)" = "$2 $3 $4 $5" ]
}

for kind in perspective orthographic fisheye panorama; do
    ok "--projection $kind" exits 0 render $box "${fast[@]}" --projection $kind -o "$DIR/$kind.exr"
done
ok "projections differ" differ "$DIR/fisheye.exr" "$DIR/panorama.exr"
ok "a lens" exits 0 render $box "${fast[@]}" --aperture 0.5 --focus 9 -o "$DIR/lens.exr"
ok "a lens blurs" differ "$DIR/lens.exr" "$DIR/perspective.exr"
ok "a wide perspective" fails 2 'below 180' render $box "${fast[@]}" --fov 200 -o "$DIR/x.exr"

ok "--crop" exits 0 render $box "${fast[@]}" --crop 10,5,40,30 -o "$DIR/part.exr"
ok "a part says where it belongs" has_window "$DIR/part.exr" 10 5 39 29
ok "a part beyond the picture" fails 2 'reaches beyond' \
    render $box "${fast[@]}" --crop 10,5,70,30 -o "$DIR/x.exr"
ok "an empty part" fails 2 'left,top,right,bottom' render $box --crop 10,5,10,30

for shape in tent gauss blackman-harris; do
    ok "--pixel-filter $shape" exits 0 \
        render $box "${fast[@]}" --pixel-filter $shape -o "$DIR/$shape.exr"
done
ok "filters differ" differ "$DIR/tent.exr" "$DIR/gauss.exr"

noise=(--quality draft --patches 200 --rays 16 --size 64x48 --progress none)
ok "an error asked for" exits 0 render $box "${noise[@]}" --error 5% --spp 1024 -o "$DIR/n.exr" \
    --json "$DIR/n.json"
ok "it is told" grep -q '"standard_error"' "$DIR/n.json"
ok "an error out of reach" exits 4 render $box "${noise[@]}" --error 0.00001 --spp 8 \
    -o "$DIR/m.exr"
ok "no error at all" fails 2 'error' render $box --error 0%
ok "rays for every sample" exits 0 render $box "${fast[@]}" --record-rays 0 -o "$DIR/r.exr"
ok "records are another picture" differ "$DIR/r.exr" "$DIR/perspective.exr"

ok "false colours beside the picture" exits 0 \
    render $box "${fast[@]}" --false-colour illuminance --isolines -o "$DIR/a.exr"
ok "they are there" is_png "$DIR/a.illuminance.png"
ok "--log alone" fails 2 'belong to --false-colour' render $box --log
ok "a range upside down" fails 2 'lower first' render $box --false-colour luminance --range 5,1
ok "a logarithm of 0" fails 2 'above 0' render $box --false-colour luminance --log --range 0,1

ok "develop" exits 0 develop "$DIR/a.exr" --tone filmic --exposure 1 -o "$DIR/b.png"
ok "another curve is another picture" differ "$DIR/a.png" "$DIR/b.png"
ok "develop as render did" exits 0 develop "$DIR/a.exr" -o "$DIR/c.png"
ok "develop false colours" exits 0 develop "$DIR/a.exr" --false-colour illuminance --isolines \
    -o "$DIR/d.png"
ok "a name is made" exits 0 develop "$DIR/a.exr" --false-colour luminance --log
ok "it is there" is_png "$DIR/a.luminance.png"
ok "no such layer" fails 3 'no channel' develop tests/fuzz/corpus/exr/none-half.exr \
    --false-colour illuminance
ok "no such file" fails 3 'nothere' develop "$DIR/nothere.exr"
ok "not a PNG" fails 2 'ends in .png' develop "$DIR/a.exr" -o "$DIR/a.jpg"
ok "a difference" exits 0 compare "$DIR/perspective.exr" "$DIR/lens.exr" -o "$DIR/e.png"
ok "it is there" is_png "$DIR/e.png"
ok "none of meshes" fails 2 'two pictures' compare a.ply b.ply -o "$DIR/e.png"
finish

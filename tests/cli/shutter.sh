#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# --time and --shutter: what they go with, and what is told.
. "$(dirname "$0")/tap.inc"
box=scenes/files/cornell.msd
fast=(--quality draft --patches 100 --rays 16 --spp 4 --size 48x36 --progress none)
cat >"$DIR/moving.msd" <<'END_OF_SCENE'
CAMERA fixed = ( (0.3, 0.3, 1.5) (2, 2, 1) (0, 0, 1) 70 60 );
CAMERA drive = ( (0.3 + TIME, 0.3, 1.5) (2, 2, 1) (0, 0, 1) 70 60 );
SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
SURFACE 2 0 ; (0,0,0) 1 ; (0,0,0) 0, 1 EMISSIVE (5, 5, 5)
BEGIN GROUP "room" BOX 1 (1.5, 1.5, 1.5) <1.5, 1.5, 1.5> END
BEGIN GROUP "lamp" QUADRANGLE 2 (1, 1, 2.9) (1, 2, 2.9) (2, 2, 2.9) (2, 1, 2.9) END
END_OF_SCENE
sed 's/BEGIN GROUP "lamp"/TRANS(TIME, 0, 0) BEGIN GROUP "lamp"/' "$DIR/moving.msd" >"$DIR/lamp.msd"
moving=$DIR/moving.msd
lamp=$DIR/lamp.msd

differ() { ! cmp -s "$1" "$2" && [ -s "$1" ] && [ -s "$2" ]; }
same_light() {
    "$ISOLUX" compare "$1" "$2" --json "$DIR/same.json" 2>"$DIR/err"
    grep -q '"all": 0.0,' "$DIR/same.json"
}
says() { tr -d ' \n' <"$1" | grep -qF -- "$2"; }

ok "a moment" exits 0 render "$moving" "${fast[@]}" --camera drive --time 0.5 -o "$DIR/a.exr"
ok "another" exits 0 render "$moving" "${fast[@]}" --camera drive --time 0.25 -o "$DIR/b.exr"
ok "they differ" differ "$DIR/a.png" "$DIR/b.png"
ok "one moment of a shutter" exits 0 render "$moving" "${fast[@]}" --camera drive --shutter 0,1 \
    --time-samples 1 -o "$DIR/c.exr"
ok "is that in its middle" same_light "$DIR/a.exr" "$DIR/c.exr"
ok "a moving camera" exits 0 render "$moving" "${fast[@]}" --camera all --shutter 0,0.5 \
    --time-samples 4 -o "$DIR/d-{camera}.exr" --json "$DIR/d.json"
ok "one solution for all" says "$DIR/d.json" '"time_samples":4,"solutions":1,'
ok "a moving lamp" exits 0 render "$lamp" "${fast[@]}" --camera fixed --shutter 0,0.5 \
    --time-samples 3 -o "$DIR/e.exr" --json "$DIR/e.json" --false-colour luminance --light-groups
ok "a solution for each" says "$DIR/e.json" '"time_samples":3,"solutions":3,'
ok "by groups" grep -qa 'lightgroup.lamp.R' "$DIR/e.exr"
ok "false colours of the mean" test -s "$DIR/e.luminance.png"
ok "any number of threads" exits 0 render "$lamp" "${fast[@]}" --camera fixed --shutter 0,0.5 \
    --time-samples 3 -o "$DIR/f.exr" --false-colour luminance --light-groups --threads 1
ok "any number of threads: same bytes" cmp "$DIR/e.exr" "$DIR/f.exr"
ok "plain rays" exits 0 render "$lamp" --renderer whitted --camera fixed --size 48x36 --spp 6 \
    --shutter 0,0.5 --time-samples 3 -o "$DIR/w.exr" --json "$DIR/w.json"
ok "each moment has its share of them" says "$DIR/w.json" '"samples_per_pixel":6.0,'
ok "solve at a time" exits 0 solve "$lamp" --patches 100 --rays 16 --progress none --time 0.3 \
    -o "$DIR/g.ply"
ok "solve at another" exits 0 solve "$lamp" --patches 100 --rays 16 --progress none --time 0.6 \
    -o "$DIR/h.ply"
ok "they differ" differ "$DIR/g.ply" "$DIR/h.ply"

run render $box "${fast[@]}" --shutter 0,1 -o "$DIR/x.exr"
ok "nothing moves" test "$CODE" = 0
ok "nothing moves: told" grep -q 'time-unused' "$DIR/err"
run check $box --time 2
ok "nothing depends on it: told" grep -q 'time-unused' "$DIR/err"

ok "out of time" exits 5 render "$lamp" --quality draft --patches 100 --rays 16 --camera fixed \
    --size 200x150 --shutter 0,0.5 --time-samples 4000 --time-limit 0.5s --progress none \
    -o "$DIR/i.exr"
ok "it says so" grep -qE "of 4000 moments|hurried|stopped while" "$DIR/err"

ok "a time and a shutter" fails 2 'not both' render $box --time 1 --shutter 0,1
ok "a shutter that does not open" fails 2 'lower first' render $box --shutter 1,1
ok "samples of no shutter" fails 2 'belongs to --shutter' render $box --time-samples 4
ok "no checkpoints" fails 2 'do not go with --shutter' render $box --shutter 0,1 --checkpoint 5min
ok "no kept factors" fails 2 'of one moment' render $box --shutter 0,1 --factors "$DIR/f.bin"
ok "no time in this file" exits 0 check scenes/files/gem.obj --time 1
finish

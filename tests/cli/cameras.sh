#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Several cameras in one run.
. "$(dirname "$0")/tap.inc"
shapes=scenes/files/shapes.msd
fast=(--quality draft --patches 300 --rays 16 --spp 2 --size "$(sized 64x48 32x24)"
    --progress none --record-rays 0)

# same_light A B: all pixels of two pictures are equal.
same_light() {
    "$ISOLUX" compare "$1" "$2" --json - 2>"$DIR/err" >"$DIR/same.json"
    tr -d ' \n' <"$DIR/same.json" | grep -q '"all":0.0,'
}
count() { tr ',' '\n' <"$1" | grep -c -- "$2"; }

ok "all cameras" exits 0 render $shapes "${fast[@]}" --camera all -o "$DIR/a-{camera}.exr" \
    --false-colour luminance --json "$DIR/a.json"
for name in SCREEN corner; do
    ok "$name: its files" test -s "$DIR/a-$name.exr" -a -s "$DIR/a-$name.png" -a \
        -s "$DIR/a-$name.luminance.png"
    ok "$name alone" exits 0 render $shapes "${fast[@]}" --camera $name -o "$DIR/one-$name.exr"
    ok "$name alone is the same" same_light "$DIR/one-$name.exr" "$DIR/a-$name.exr"
done
ok "two cameras are two pictures" bash -c "! cmp -s '$DIR/a-SCREEN.png' '$DIR/a-corner.png'"
ok "each has its report" test "$(count "$DIR/a.json" '"camera":')" = 2
ok "some cameras" exits 0 render $shapes "${fast[@]}" --camera corner,SCREEN -o "$DIR/b-{camera}.png"
ok "the same whatever their order" same_light "$DIR/a-corner.exr" "$DIR/b-corner.exr"
ok "one camera, a mark" exits 0 render $shapes "${fast[@]}" --camera corner -o "$DIR/{camera}.exr"
ok "it is filled in" test -s "$DIR/corner.exr"
for kind in path whitted; do
    ok "$kind" exits 0 render $shapes --renderer $kind --size 32x24 --spp 1 --camera all \
        --progress none -o "$DIR/$kind-{camera}.exr"
    ok "$kind: both" test -s "$DIR/$kind-SCREEN.exr" -a -s "$DIR/$kind-corner.exr"
done

ok "no mark" fails 2 '2 cameras need a name' render $shapes --camera all -o "$DIR/x.exr"
ok "no such camera" fails 2 "no camera 'door'; the file has 'SCREEN', 'corner'" \
    render $shapes --camera corner,door -o "$DIR/{camera}.exr"
ok "twice" fails 2 'stands there twice' render $shapes --camera corner,corner
ok "not for bench" fails 2 'for render' bench $shapes --camera all

# Broken off in the second picture, once that is told of. The error is out of reach: exit code 4.
some=(--quality draft --patches 300 --rays 16 --size "$(sized 48x36 24x18)" --progress none
    --camera all)
ok "unbroken" exits 4 render $shapes "${some[@]}" -o "$DIR/c-{camera}.exr" --error 0.4%
interrupted TERM "grep -q '2 of 2' '$DIR/err'" render $shapes "${some[@]}" --error 0.4% \
    -o "$DIR/d-{camera}.exr" --checkpoint 1h --progress plain
ok "broken off" test "$CODE" = 5
first=$(stat -c %Y.%i "$DIR/d-SCREEN.exr")
ok "resumed" exits 4 render $shapes "${some[@]}" --error 0.4% -o "$DIR/d-{camera}.exr" \
    --resume "$DIR/d-{camera}.exr.checkpoint"
ok "what was finished stays" test "$first" = "$(stat -c %Y.%i "$DIR/d-SCREEN.exr")"
for name in SCREEN corner; do
    ok "$name resumed: same bytes" cmp "$DIR/c-$name.exr" "$DIR/d-$name.exr"
done
rm "$DIR/d-SCREEN.exr"
ok "resumed without it" exits 4 render $shapes "${some[@]}" --error 0.4% \
    -o "$DIR/d-{camera}.exr" --resume "$DIR/d-{camera}.exr.checkpoint"
for name in SCREEN corner; do
    ok "$name made again: same bytes" cmp "$DIR/c-$name.exr" "$DIR/d-$name.exr"
done
finish

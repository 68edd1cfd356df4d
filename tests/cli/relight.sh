#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Changes of light and paint, against scenes that were written that way.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
some=(--patches 600 --rays 64 --no-adapt --progress none --tolerance 1e-9)

# Irradiances of two solutions differ by less than this many per cent.
near() {
    run compare "$1" "$2"
    awk '$1 == "error" { exit !($2 < 0.001) }' "$DIR/err"
}
# The same box with a dim lamp, and with a floor of another colour.
sed 's/^Ke .*/Ke 2 1 4/' "$DIR/cube.mtl" >"$DIR/dim.mtl"
sed 's/cube.mtl/dim.mtl/' "$cube" >"$DIR/dim.obj"
{ cat "$DIR/cube.mtl"; printf 'newmtl paint\nKd 0.1 0.8 0.2\n'; } >"$DIR/paint.mtl"
sed 's/cube.mtl/paint.mtl/; s/^g floor/usemtl paint\ng floor/; s/^g x0/usemtl wall\ng x0/' "$cube" \
    >"$DIR/paint.obj"
ok "dim" exits 0 solve "$DIR/dim.obj" "${some[@]}" -o "$DIR/dim.ply"
ok "painted" exits 0 solve "$DIR/paint.obj" "${some[@]}" -o "$DIR/paint.ply"

ok "a lamp dimmed" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" --json "$DIR/a.json" \
    --set ceiling.emission='*0.2,0.1,0.4'
ok "solved again" grep -q '"way": "solved"' "$DIR/a.json"
ok "as the dim scene" near "$DIR/dim.ply" "$DIR/a.ply"
ok "a lamp of its own light" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" \
    --set ceiling.emission=2,1,4
ok "as the dim scene" near "$DIR/dim.ply" "$DIR/a.ply"
ok "a material" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" --set lamp.emission=2,1,4
ok "as the dim scene" near "$DIR/dim.ply" "$DIR/a.ply"
ok "light groups" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" --json "$DIR/a.json" \
    --light-groups --set ceiling.emission='*0.2,0.1,0.4'
ok "mixed" grep -q '"way": "mixed"' "$DIR/a.json"
ok "as the dim scene" near "$DIR/dim.ply" "$DIR/a.ply"
for solver in two-level gmres cg gauss-seidel progressive; do
    ok "a floor painted, $solver" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" \
        --solver "$solver" --set floor.reflectance=0.1,0.8,0.2
    ok "as the painted scene, $solver" near "$DIR/paint.ply" "$DIR/a.ply"
done
ok "painted, with light groups" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" --light-groups \
    --set floor.reflectance=0.1,0.8,0.2
ok "as the painted scene" near "$DIR/paint.ply" "$DIR/a.ply"

# A mesh per light group: with a second lamp, each is what a scene with that lamp alone gives.
sed 's/^g floor/usemtl glow\ng floor/; s/^g x0/usemtl wall\ng x0/; s/cube.mtl/glow.mtl/' "$cube" \
    >"$DIR/glow.obj"
{ cat "$DIR/cube.mtl"; printf 'newmtl glow\nKd 0.5 0.5 0.5\nKe 1 2 3\n'; } >"$DIR/glow.mtl"
ok "a mesh per group" exits 0 solve "$DIR/glow.obj" "${some[@]}" --light-groups \
    -o "$DIR/g-{group}.ply"
ok "ceiling, floor and all" test -s "$DIR/g-ceiling.ply" -a -s "$DIR/g-floor.ply" -a \
    -s "$DIR/g-all.ply"
for off in ceiling floor; do
    on=floor
    [ "$off" = floor ] && on=ceiling
    ok "without the $off" exits 0 solve "$DIR/glow.obj" "${some[@]}" -o "$DIR/a.ply" \
        --set "$off.emission=*0"
    ok "is the $on alone" near "$DIR/a.ply" "$DIR/g-$on.ply"
done
ok "all together" exits 0 solve "$DIR/glow.obj" "${some[@]}" -o "$DIR/a.ply"
ok "is all" near "$DIR/a.ply" "$DIR/g-all.ply"
ok "not without groups" fails 2 'needs --light-groups' solve "$cube" "${some[@]}" \
    -o "$DIR/g-{group}.ply"

echo '{ "floor": { "reflectance": [0.1, 0.8, 0.2] }, "ceiling": { "emission": "*1" } }' \
    >"$DIR/changes.json"
ok "a file of changes" exits 0 solve "$cube" "${some[@]}" -o "$DIR/a.ply" \
    --changes "$DIR/changes.json"
ok "as the painted scene" near "$DIR/paint.ply" "$DIR/a.ply"
ok "a picture of it" exits 0 render "$cube" "${some[@]}" -o "$DIR/a.exr" --size 24x16 --spp 4 \
    --eye 0.5,0.05,0.4 --target 0.5,1,0.5 --up 0,0,1 --set ceiling.emission=0
ok "all is dark" fails 3 'the reference is black' compare "$DIR/a.exr" "$DIR/a.exr"

ok "no such group" fails 2 "'nowhere' is no group" solve "$cube" "${some[@]}" \
    --set nowhere.emission=1
ok "no such value" fails 2 "NAME.emission=VALUE" solve "$cube" "${some[@]}" --set floor.colour=1
ok "too bright a wall" fails 2 "below 1" solve "$cube" "${some[@]}" --set floor.reflectance=1
ok "made too bright" fails 2 "more than arrives" solve "$cube" "${some[@]}" \
    --set 'floor.reflectance=*3'
ok "not a number" fails 2 "needs a number" solve "$cube" "${some[@]}" --set floor.emission=red
echo '{ "floor": 3 }' >"$DIR/bad.json"
ok "a file of another form" fails 3 "bad.json: 'floor' is not" solve "$cube" "${some[@]}" \
    --changes "$DIR/bad.json"
printf '{\n "floor": {\n' >"$DIR/cut.json"
ok "a file that is cut" fails 3 "cut.json:" solve "$cube" "${some[@]}" --changes "$DIR/cut.json"
ok "no file" fails 3 "none.json" solve "$cube" "${some[@]}" --changes "$DIR/none.json"
finish

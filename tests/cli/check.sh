#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# check: defects of known scenes, an account of all faces, the marked mesh.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
quiet=(--progress none)

# says PATTERN: the report does.
says() { grep -qE -- "$1" "$DIR/out"; }
# value FILE KEY: the first value of that key.
value() { sed -nE "s/.*\"$2\": ([-0-9.e+a-z]+).*/\\1/p" "$1" | head -n 1; }
# kind NAME: found, repaired and left of a defect in the last JSON.
kind() {
    grep -A 3 "^ *\"$1\": {" "$DIR/c.json" | grep -oE '": [0-9]+' | cut -c 4- | paste -s -d ' '
}
# adds_up FILE: all faces are accounted for, none is lost.
adds_up() {
    sed -n '/"faces": {/,/"without_material"/p' "$1" | grep -oE '"[a-z_-]+": [0-9]+' | tr -d '":' |
        awk '$1 == "input" { n = $2 } $1 == "lost" && $2 > 0 { bad = 1 }
             $1 != "input" && $1 != "without_material" { sum += $2 }
             END { exit !(n > 0 && sum == n && !bad) }'
}

ok "a clean room" exits 0 check "$cube" --json "$DIR/c.json" "${quiet[@]}"
ok "closed but for the plate's border" says '^  open: 1 rim of 4 open edges'
ok "all faces have patches" says '^  faces +7 = 7 with patches \+ 0 out of reach \+ 0 left out$'
ok "no crossing" test "$(kind intersection)" = "0 0 0"
ok "the plate's border is open" test "$(kind open-edge)" = "4 0 4"
ok "JSON adds up" adds_up "$DIR/c.json"

# One of everything: the ceiling is gone, the floor twice, a needle, a box through a wall, a poster
# on a wall, a material that nobody knows.
grep -v '^f 5 8 7 6' "$cube" >"$DIR/bad.obj"
cat >>"$DIR/bad.obj" <<'END_OF_SCENE'
g twice
f 1 2 3 4
g needle
v 0.2 0.2 0.2
v 0.3 0.2 0.2
v 0.4 0.2 0.2
f -3 -2 -1
g through
v 0.8 0.2 0.2
v 1.2 0.2 0.2
v 1.2 0.4 0.2
v 0.8 0.4 0.2
v 0.8 0.2 0.4
v 1.2 0.2 0.4
v 1.2 0.4 0.4
v 0.8 0.4 0.4
f -8 -5 -6 -7
f -4 -3 -2 -1
f -8 -7 -3 -4
f -7 -6 -2 -3
f -6 -5 -1 -2
f -5 -8 -4 -1
g poster
usemtl nowhere
v 0 0.3 0.3
v 0 0.7 0.3
v 0 0.7 0.7
v 0 0.3 0.7
f -4 -3 -2 -1
END_OF_SCENE
ok "one of everything" exits 0 check "$DIR/bad.obj" --json "$DIR/c.json" -o "$DIR/bad.ply" \
    "${quiet[@]}"
ok "open" says '^  open: 3 rims of 12 open edges'
ok "the largest rim is the ceiling's" says '^    4 edges, 4 long, flat, 0,0,1 to 1,1,1, at group'
ok "duplicate" test "$(kind duplicate)" = "1 1 0"
ok "degenerate" test "$(kind degenerate)" = "1 1 0"
ok "the box crosses the wall with four faces" test "$(kind intersection)" = "4 0 4"
ok "where" says "^    group 'x1', face 3 and group 'through', face [0-9]+, at 1,0\.[0-9]+,0\.[0-9]+ \("
ok "the poster lies on the wall" test "$(kind overlap)" = "1 0 1"
ok "material" says 'material "nowhere" is in no material library'
ok "nothing is lost" adds_up "$DIR/c.json"
ok "sum" says '^  faces +15 = 13 with patches \+ 0 out of reach \+ 2 left out \(1 degenerate, 1 dup'

ok "marked mesh begins as one" test "$(head -c 4 "$DIR/bad.ply")" = "$(printf 'ply\n')"
ok "marked mesh has all faces" grep -aqx 'element face 15' "$DIR/bad.ply"
ok "marked mesh has the open edges" grep -aqx 'element edge 12' "$DIR/bad.ply"
ok "marked mesh has a legend" grep -aq 'red: intersection, defect 12, found 4' "$DIR/bad.ply"
ok "marked mesh is read back" exits 0 check "$DIR/bad.ply" --json "$DIR/back.json" "${quiet[@]}"
ok "with all faces" test "$(value "$DIR/back.json" polygons)" = 15
ok "marked mesh on standard output" exits 0 check "$DIR/bad.obj" -o - "${quiet[@]}"
ok "the same bytes" cmp -s "$DIR/out" "$DIR/bad.ply"
ok "another name is refused" fails 2 'ends in' check "$cube" -o "$DIR/x.obj"

# A lamp that welding takes away is told of.
sed 's/^usemtl lamp//; s/^g plate/g plate\nusemtl lamp/' "$cube" >"$DIR/small.obj"
ok "a small lamp" exits 0 check "$DIR/small.obj"
ok "is there" test "$(grep -c lamp-lost "$DIR/err")" = 0
ok "welded too far" exits 0 check "$DIR/small.obj" --weld 0.6
ok "it is said" grep -q "give light were left out.*--weld.*\[lamp-lost\]" "$DIR/err"

# What gives way to others is told of, and that of two materials one goes.
grep -v '^mtllib\|^usemtl' "$cube" >"$DIR/two.obj"
cat >"$DIR/two.mtl" <<'END_OF_SCENE'
newmtl oak
Kd 0.5 0.5 0.5
newmtl carpet
Kd 0.2 0.2 0.2
END_OF_SCENE
sed -i '1i mtllib two.mtl\nusemtl oak' "$DIR/two.obj"
printf 'g again\nusemtl carpet\nf 1 2 3 4\n' >>"$DIR/two.obj"
ok "two materials" exits 0 check "$DIR/two.obj" --json "$DIR/c.json"
ok "one goes" test "$(kind other-material)" = "1 1 0"
ok "it is said which" grep -q '"carpet" goes and "oak" stays.*\[material-dropped\]' "$DIR/err"
ok "solving says the same" exits 0 solve "$DIR/two.obj" --quality draft --patches 50 --light ceiling \
    -o "$DIR/two.ply" --progress none
ok "in the same words" grep -q '"carpet" goes and "oak" stays.*\[material-dropped\]' "$DIR/err"
# A rug in the floor's plane has patches whichever way it is wound, and takes the same light.
cat >"$DIR/rug.mtl" <<'END_OF_SCENE'
newmtl wool
Kd 0.05 0.05 0.05
END_OF_SCENE
for way in "101 102 103 104" "104 103 102 101"; do
    sed '1i mtllib rug.mtl' "$cube" >"$DIR/rug.obj"
    base=$(grep -c '^v ' "$cube")
    printf 'v %s 0\n' '0.25 0.25' '0.75 0.25' '0.75 0.75' '0.25 0.75' >>"$DIR/rug.obj"
    echo "g rug
usemtl wool
f $(for k in $way; do echo -n "$((base + k - 100)) "; done)" >>"$DIR/rug.obj"
    ok "a rug wound $way" exits 0 solve "$DIR/rug.obj" --quality draft --patches 200 \
        --light ceiling -o "$DIR/rug.ply" --progress none
    ok "the floor under it is told of" grep -q 'under "wool".*\[covered\]' "$DIR/err"
done

ok "cuts are listed" exits 0 check "$DIR/bad.obj" --json "$DIR/c.json" "${quiet[@]}"
ok "the wall below the poster gives way" test "$(kind covered-part)" = "1 1 0"
ok "what the box passes is cut" test "$(kind cut)" = "5 5 0"
ok "all but that" exits 0 check "$DIR/bad.obj" --repair all,-cuts,-covered --json "$DIR/c.json" \
    "${quiet[@]}"
ok "left as it is" test "$(kind covered-part) $(kind cut)" = "1 0 1 5 0 5"
ok "the duplicate is mended" test "$(kind duplicate)" = "1 1 0"

ok "repairs switched off" exits 0 check "$DIR/bad.obj" --repair none --json "$DIR/c.json" "${quiet[@]}"
ok "the duplicate stays" test "$(kind duplicate)" = "1 0 1"
ok "and has patches" adds_up "$DIR/c.json"

# Units: a room 4000 wide is none in metres.
sed 's/^v \([0-9.]*\) \([0-9.]*\) \([0-9.]*\)/v \10e3 \20e3 \30e3/; s/^v 00e3/v 0e3/' "$cube" >"$DIR/mm.obj"
ok "millimetres" exits 0 check "$DIR/mm.obj" "${quiet[@]}"
ok "are suspicious" says '^  units +suspicious'
ok "a guess" says 'looks like .*: --unit-m 0\.0'
ok "and said to be" exits 0 check "$DIR/mm.obj" --unit-m 0.001 "${quiet[@]}"
ok "no more suspicion" test "$(grep -c suspicious "$DIR/out")" = 0

# Every scene of the project: no face is lost.
lost=
for scene in scenes/files/*.msd scenes/files/*.obj scenes/third-party/*/*.obj \
    scenes/third-party/*/*.glb; do
    case $scene in *veach-ajar.glb | *staircase*) continue ;; esac
    [ -e "$scene" ] || continue
    run check "$scene" --json "$DIR/c.json" "${quiet[@]}"
    { [ "$CODE" = 0 ] && adds_up "$DIR/c.json"; } || lost="$lost $scene"
done
ok "every face of every scene is told of" test -z "$lost"
[ -z "$lost" ] || echo "# $lost"
finish

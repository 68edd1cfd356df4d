#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Bad input, limits and signals.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
fast=(--patches 200 --rays 32 --progress none)

ok "no such file" fails 3 'nothere.obj' check "$DIR/nothere.obj"
ok "a folder" fails 3 '' check "$DIR"
: >"$DIR/empty.obj"
ok "empty file" fails 3 'empty.obj' check "$DIR/empty.obj"
head -c 3000 /dev/urandom >"$DIR/noise.glb"
ok "noise" fails 3 'noise.glb' check "$DIR/noise.glb"
printf 'v 0 0 0\nf 1 1 1\n' >"$DIR/flat.obj"
ok "nothing with area" fails 3 'flat.obj' check "$DIR/flat.obj"
printf 'nonsense {\n' >"$DIR/bad.msd"
ok "bad MSD names file and line" fails 3 'bad.msd:1' check "$DIR/bad.msd"
ok "bad input fails before the result" fails 3 'bad.msd' render "$DIR/bad.msd" -o "$DIR/x.exr"
ok "no result from bad input" test ! -e "$DIR/x.exr"
ok "summary of a failure" exits 3 check "$DIR/bad.msd" --json "$DIR/bad.json"
ok "summary holds the code" grep -q '"exit": 3' "$DIR/bad.json"

printf '1,2,3,0,0,1\n1,2,3,0,0\n' >"$DIR/short.csv"
ok "points: five values" fails 3 'short.csv:2' measure "$cube" --points "$DIR/short.csv"
printf 'x,y,z\nup,2,3,0,0,1\n' >"$DIR/word.csv"
ok "points: a word" fails 3 "word.csv:2: 'up'" measure "$cube" --points "$DIR/word.csv"
printf '1,2,3,0,0,0\n' >"$DIR/zero.csv"
ok "points: no normal" fails 3 'zero.csv:1' measure "$cube" --points "$DIR/zero.csv"
printf '# nothing\n' >"$DIR/none.csv"
ok "points: none" fails 3 'no points' measure "$cube" --points "$DIR/none.csv"

sed 's/^Ke.*//' "$DIR/cube.mtl" >"$DIR/dark.mtl"
sed 's/cube.mtl/dark.mtl/' "$cube" >"$DIR/dark.obj"
ok "no lamp" exits 0 solve "$DIR/dark.obj" "${fast[@]}"
ok "no lamp is warned of" grep -q 'no-emitter' "$DIR/err"
ok "--light ceiling" exits 0 solve "$DIR/dark.obj" "${fast[@]}" --light ceiling \
    --json "$DIR/dark.json"
ok "the lamp shines" test -z "$(grep '"emitted": \[0,' "$DIR/dark.json")"

ok "memory limit" exits 6 solve "$cube" --patches 20000 --rays 4096 --max-memory 40MB \
    --solver jacobi --progress none
ok "memory limit is told in one line" test "$(wc -l <"$DIR/err")" = 1
ok "a picture that is too large" exits 6 render "$cube" -o "$DIR/x.exr" --size 20000x20000 \
    --max-memory 500MB --progress none

ok "time limit" exits 5 render "$cube" -o "$DIR/late.exr" --size 400x400 --spp 4096 \
    --time-limit 1s --patches 500 --rays 64 --progress none --json "$DIR/late.json"
ok "time limit leaves a picture" test -s "$DIR/late.png"
ok "time limit in the summary" grep -q '"exit": 5' "$DIR/late.json"
ok "time limit before anything" exits 5 solve "$cube" -o "$DIR/late.ply" --time-limit 0 \
    "${fast[@]}"
ok "still a mesh" test -s "$DIR/late.ply"
for name in INT TERM; do
    interrupted "$name" "grep -q gather '$DIR/err'" render "$cube" -o "$DIR/$name.exr" \
        --size "$(sized 400x400 200x150)" --spp 4096 --patches 500 --rays 64 --progress plain
    ok "SIG$name: exit code" test "$CODE" = 5
    ok "SIG$name: a picture" test -s "$DIR/$name.exr"
done
ok "validate with a filter" exits 0 validate --filter cie-5.2
ok "validate tells its count" grep -q '^20 passed, 0 failed' "$DIR/out"
ok "validate by every solver" exits 0 validate --filter solvers-lamp
ok "validate by each: its count" grep -q '^12 passed, 0 failed' "$DIR/out"
ok "validate: no such case" exits 2 validate --filter nosuchcase
finish

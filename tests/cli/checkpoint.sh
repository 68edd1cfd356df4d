#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs that are broken off and resumed.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
some=(--patches "$(sized 2000 800)" --rays 64 --progress none --threads 2)
view=(--eye 0.5,0.05,0.4 --target 0.5,1,0.5 --up 0,0,1 --size 40x30 --spp 64)
mark=$DIR/b.ply.checkpoint
# Long enough to be broken off.
many=$(sized 1024 256)

broken() { # SIGNAL FILE ARGUMENTS...: ends it at its first checkpoint; CODE
    local name=$1 file=$2
    shift 2
    rm -f "$file.checkpoint"
    interrupted "$name" "[ -e '$file.checkpoint' ]" "$@" -o "$file" --checkpoint 0
}

ok "unbroken" exits 0 solve "$cube" -o "$DIR/a.ply" "${some[@]}"
ok "the same with checkpoints" exits 0 solve "$cube" -o "$DIR/c.ply" "${some[@]}" --checkpoint 0
ok "same bytes with checkpoints" cmp "$DIR/a.ply" "$DIR/c.ply"
ok "no checkpoint is left behind" test ! -e "$DIR/c.ply.checkpoint"
for name in INT TERM KILL; do
    broken "$name" "$DIR/b.ply" solve "$cube" "${some[@]}" --rays $many
    ok "$name: exit code" test "$CODE" = "$([ "$name" = KILL ] && echo 137 || echo 5)"
    ok "$name: a checkpoint is there" test -s "$mark"
done
ok "unbroken, more rays" exits 0 solve "$cube" -o "$DIR/a.ply" "${some[@]}" --rays $many
cp "$mark" "$DIR/kept"
ok "resumed" exits 0 solve "$cube" -o "$DIR/b.ply" "${some[@]}" --rays $many --resume "$mark" \
    --json "$DIR/b.json"
ok "resumed: same bytes" cmp "$DIR/a.ply" "$DIR/b.ply"
ok "what is resumed from stays" cmp "$mark" "$DIR/kept"
ok "another number of threads" exits 0 solve "$cube" -o "$DIR/b.ply" "${some[@]}" --rays $many \
    --resume "$mark" --threads 1
ok "another number of threads: same bytes" cmp "$DIR/a.ply" "$DIR/b.ply"
ok "other options" fails 3 'b.ply.checkpoint: was made from another scene' solve "$cube" \
    "${some[@]}" --rays 512 --resume "$mark"
ok "no file" fails 3 'none: cannot be read' solve "$cube" "${some[@]}" --resume "$DIR/none"
ok "no checkpoint" fails 3 'cube.obj: is no checkpoint' solve "$cube" "${some[@]}" --resume "$cube"
head -c 5000 "$mark" >"$DIR/cut"
ok "a cut checkpoint" fails 3 'cut: is a damaged checkpoint' solve "$cube" "${some[@]}" \
    --rays $many --resume "$DIR/cut"
ok "a full disk" bash -c "ulimit -f 16; '$ISOLUX' solve '$cube' -o '$DIR/b.ply' ${some[*]} \
    --rays $many --resume '$mark' --checkpoint 0 2>'$DIR/err'; [ \$? = 1 ]"
ok "a full disk is told in one line" test "$(wc -l <"$DIR/err")" = 1
ok "a full disk: the old checkpoint stays" cmp "$mark" "$DIR/kept"
ok "resumed and saved on" exits 0 solve "$cube" -o "$DIR/b.ply" "${some[@]}" --rays $many \
    --resume "$mark" --checkpoint 0.1s
ok "saved on: same bytes" cmp "$DIR/a.ply" "$DIR/b.ply"
ok "then it is taken away" test ! -e "$mark"

# Rounds of the stochastic solver; a tolerance that is not reached.
rounds=(--patches "$(sized 2000 800)" --rays "$(sized 2048 512)" --solver stochastic
    --tolerance 1e-6 --progress none)
ok "rounds, unbroken" exits 4 solve "$cube" -o "$DIR/a.ply" "${rounds[@]}"
for name in INT KILL; do
    broken "$name" "$DIR/b.ply" solve "$cube" "${rounds[@]}"
    ok "rounds, $name: exit code" test "$CODE" = "$([ "$name" = KILL ] && echo 137 || echo 5)"
    ok "rounds, $name: resumed" exits 4 solve "$cube" -o "$DIR/b.ply" "${rounds[@]}" \
        --threads 1 --resume "$mark"
    ok "rounds, $name: same bytes" cmp "$DIR/a.ply" "$DIR/b.ply"
done
ok "rounds, saved on" exits 4 solve "$cube" -o "$DIR/b.ply" "${rounds[@]}" --resume "$mark" \
    --checkpoint 0
ok "rounds, saved on: same bytes" cmp "$DIR/a.ply" "$DIR/b.ply"
ok "rounds, time limit: a checkpoint" stopped_late "$DIR/b.ply" solve "$cube" "${rounds[@]}" \
    --rays 1000000
ok "rounds, time limit: a solution" test -s "$DIR/b.ply"
ok "rounds, other rays" fails 3 'other options' solve "$cube" "${rounds[@]}" --resume "$mark"

ok "a picture, unbroken" exits 0 render "$cube" -o "$DIR/a.exr" "${some[@]}" "${view[@]}"
ok "time limit in the picture: a checkpoint" stopped_late "$DIR/b.exr" render "$cube" \
    "${some[@]}" "${view[@]}" --spp 65536 --error 0.01%
ok "time limit in the picture: rough" test -s "$DIR/b.exr"
broken TERM "$DIR/b.exr" render "$cube" "${some[@]}" "${view[@]}"
ok "a picture, broken" test "$CODE" = 5
ok "a picture, resumed" exits 0 render "$cube" -o "$DIR/b.exr" "${some[@]}" "${view[@]}" \
    --resume "$DIR/b.exr.checkpoint"
ok "a picture, same bytes" cmp "$DIR/a.exr" "$DIR/b.exr"
ok "a picture, another size" fails 3 'another scene or with other options' render "$cube" \
    -o "$DIR/b.exr" "${some[@]}" "${view[@]}" --size 32x32 --resume "$DIR/b.exr.checkpoint"
finish

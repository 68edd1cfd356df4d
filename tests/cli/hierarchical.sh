#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Light over links between clusters: figures, importance, what does not go together.
. "$(dirname "$0")/tap.inc"
scene=$(dirname "$0")/../../scenes/files/cornell.msd
fast=(--solver hierarchical --patches 600 --rays 256 --tolerance 0.2 --progress none)
value() {
    tr -d ' \n' <"$2" | sed -nE "s/.*\"$1\":\[?([0-9.e+-]+).*/\1/p"
}
near() {
    awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { exit !(a > 0 && (a - b) ^ 2 <= (t * b) ^ 2) }'
}

ok "solved" exits 0 solve "$scene" "${fast[@]}" -o "$DIR/a.ply" --json "$DIR/a.json" \
    --trace "$DIR/a.csv"
ok "by that solver" grep -q '"solver": "hierarchical"' "$DIR/a.json"
ok "links are told" test "$(value links "$DIR/a.json")" -gt 600
ok "a step for each round" test "$(wc -l <"$DIR/a.csv")" -gt 1
ok "rays of rounds are counted" awk -F, 'NR == 1 { next } NF != 6 || $3 <= last { bad = 1 }
    { last = $3 } END { exit bad }' "$DIR/a.csv"
ok "power balances" near 1 "$(awk -v e="$(value balance_error "$DIR/a.json")" \
    'BEGIN { print 1 + e }')" 1e-6

# Against links that are stored, of the same patches: the estimates of both, and more.
ok "flat" exits 0 solve "$scene" --patches 600 --no-adapt --rays 512 --progress none \
    -o "$DIR/flat.ply"
ok "compared" exits 0 compare "$DIR/flat.ply" "$DIR/a.ply"
ok "much the same light" near 1 "$(awk '/bias/ { print 1 + $2 / 100 }' "$DIR/out" "$DIR/err")" 0.02

ok "three threads" exits 0 solve "$scene" "${fast[@]}" --threads 3 -o "$DIR/b.ply"
ok "one thread" exits 0 solve "$scene" "${fast[@]}" --threads 1 -o "$DIR/c.ply"
ok "the same bytes" cmp -s "$DIR/b.ply" "$DIR/c.ply"

ok "links alone" exits 0 solve "$scene" "${fast[@]}" --rays 1000 --no-last-gather \
    --json "$DIR/l.json"
ok "nothing was gathered" test -z "$(value gather_rays "$DIR/l.json")"
ok "importance" exits 0 solve "$scene" "${fast[@]}" --importance --tolerance 0.05 --rays 8000 \
    --no-last-gather --json "$DIR/i.json"
ok "what is seen, both ways" near "$(value camera_by_light "$DIR/i.json")" \
    "$(value camera_by_importance "$DIR/i.json")" 1e-3
ok "a picture" exits 0 render "$scene" "${fast[@]}" --importance --size 40x40 --spp 4 \
    -o "$DIR/i.png"

ok "no camera without" fails 2 'belongs to --importance' solve "$scene" "${fast[@]}" --eye 1,1,1
ok "no other solver" fails 2 'belongs to --solver hierarchical' solve "$scene" --importance
ok "nor for the last gather" fails 2 'belongs to --solver hierarchical' solve "$scene" \
    --no-last-gather
ok "no stored factors" fails 2 'not with --solver hierarchical' solve "$scene" "${fast[@]}" \
    --factors "$DIR/f"
# Broken off where a round has ended: the same bytes. A tolerance that is not reached.
kept=("${fast[@]}" --rays 512 --tolerance 1e-4)
ok "unbroken" exits 4 solve "$scene" "${kept[@]}" -o "$DIR/a.ply"
ok "saved on" exits 4 solve "$scene" "${kept[@]}" -o "$DIR/b.ply" --checkpoint 0
ok "saved on: the same bytes" cmp -s "$DIR/a.ply" "$DIR/b.ply"
interrupted KILL "[ -e '$DIR/b.ply.checkpoint' ]" solve "$scene" "${kept[@]}" -o "$DIR/b.ply" \
    --checkpoint 0 --threads 1
ok "killed: a checkpoint" test -s "$DIR/b.ply.checkpoint"
ok "resumed" exits 4 solve "$scene" "${kept[@]}" -o "$DIR/b.ply" --resume "$DIR/b.ply.checkpoint"
ok "resumed: the same bytes" cmp -s "$DIR/a.ply" "$DIR/b.ply"
ok "not by another solver" fails 3 'with other options' solve "$scene" --patches 600 \
    --solver stochastic --resume "$DIR/b.ply.checkpoint"
ok "a time limit" exits 5 solve "$scene" "${kept[@]}" --rays 100000 --patches 20000 \
    --tolerance 1e-9 --time-limit 1s -o "$DIR/c.ply"
ok "leaves a solution" exits 0 compare "$DIR/c.ply" "$DIR/a.ply"

ok "rays that do not do are told" exits 4 solve "$scene" "${fast[@]}" --tolerance 1e-5
finish

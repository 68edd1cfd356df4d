#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Factors between groups, pair by pair: known values, kinds of estimates, standard errors.
. "$(dirname "$0")/tap.inc"
room=$(dirname "$0")/../../scenes/files/l-room.vs3
quiet=(--progress none)

# A unit cube seen from inside: faces at right angles 0.200043776, opposite ones 0.199824896.
cat >"$DIR/cube.obj" <<'END'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
g floor
f 1 2 3 4
g ceiling
f 5 8 7 6
g south
f 1 5 6 2
g north
f 3 7 8 4
g west
f 1 4 8 5
g east
f 2 6 7 3
END
ok "a cube" exits 0 factors "$DIR/cube.obj" "${quiet[@]}" -o "$DIR/c.csv" --json "$DIR/c.json"
ok "its factors, to 1e-7" awk -F, 'NR == 2 { for (i = 3; i <= 8; i++) {
    e = i == 3 ? 0 : i == 4 ? 0.199824895698387 : 0.200043776075403
    if ($i - e > 1e-7 || e - $i > 1e-7) exit 1 } }' "$DIR/c.csv"
ok "all pairs exact" grep -q '"exact": 15' "$DIR/c.json"

ok "an L-shaped room" exits 0 factors "$room" "${quiet[@]}" --closure none --accuracy 2e-5 \
    -o "$DIR/l.csv" --json "$DIR/l.json"
ok "some pairs are clipped" grep -qE '"clipped": [1-9]' "$DIR/l.json"
ok "no rays were needed between them" grep -q '"rays": 0' "$DIR/l.json"
ok "raw rows sum to 1 within four errors of all columns" awk -F, 'NR > 1 { s = 0
    for (i = 3; i <= NF; i++) s += $i; if (s > 1.00023 || s < 0.99977) exit 1 }' "$DIR/l.csv"
ok "standard errors" grep -q '"standard_errors"' "$DIR/l.json"
ok "one thread" exits 0 factors "$room" "${quiet[@]}" --closure none --accuracy 2e-5 --threads 1 \
    -o "$DIR/m.csv"
ok "the same bytes" cmp "$DIR/l.csv" "$DIR/m.csv"
ok "too much is asked" exits 4 factors "$room" "${quiet[@]}" --accuracy 1e-9 --rays 1 \
    -o "$DIR/x.csv"
ok "of an option that is wrong" fails 2 'accuracy' factors "$room" --accuracy 0
finish

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Forms that form factors are written in, and the exchange of heat in the L-shaped room.
. "$(dirname "$0")/tap.inc"
room=$(dirname "$0")/../../scenes/files/l-room.vs3
fast=(--patches 400 --rays 256 --progress none)

# FILE NAME...: the names stand in the archive's directory.
unzip_lists() {
    local file=$1 name
    shift
    for name in "$@"; do
        grep -qaF "$name" "$file" || return 1
    done
}

for form in csv npz vf; do
    ok "factors as $form" exits 0 factors "$room" -o "$DIR/f.$form" "${fast[@]}"
    ok "$form with one thread" exits 0 factors "$room" -o "$DIR/g.$form" "${fast[@]}" --threads 1
    ok "$form: same bytes" cmp "$DIR/f.$form" "$DIR/g.$form"
done
ok "View3D's heading" grep -qE '^View3D isolux-[0-9.]+ 0 1 0 8 *$' "$DIR/f.vf"
ok "View3D's rows" awk 'NR == 2 { if (NF != 8 || $1 != 9) exit 1 }
    NR > 2 && NR < 11 { s = 0; for (i = 1; i <= NF; i++) s += $i
        if (NF != 8 || s < 0.99999 || s > 1.00001) exit 1 }
    END { if (NR != 11) exit 1 }' "$DIR/f.vf"
ok "by patch as npz" exits 0 factors "$room" --by patch -o "$DIR/p.npz" "${fast[@]}"
ok "npz is an archive of arrays" unzip_lists "$DIR/p.npz" data.npy indices.npy indptr.npy

ok "by group as mtx" exits 0 factors "$room" -o "$DIR/f.mtx" "${fast[@]}"
ok "mtx: the numbers of the CSV" awk 'FNR == 1 { file++ }
    file == 1 && FNR > 1 { split($0, v, ","); for (j = 1; j <= 8; j++) f[FNR - 1, j] = v[j + 2] }
    file == 2 && !/^%/ && NF == 3 && seen++ { n++; if (f[$1, $2] != $3) exit 1 }
    END { if (n < 30) exit 1 }' "$DIR/f.csv" "$DIR/f.mtx"

# --- rows and errors -----------------------------------------------------------------------------

ok "rows" exits 0 factors "$room" -o "$DIR/f.csv" --rows "$DIR/rows.csv" --errors "$DIR/e.csv" \
    --quality draft --progress none
ok "eight rows that sum to 1" awk -F, 'NR == 1 && $0 != \
    "group,area,row_sum,escaped,raw_row_sum,raw_escaped,standard_error" { exit 1 }
    NR > 1 && ($3 < 0.999999 || $3 > 1.000001 || $4 != 0 || $5 < 0.99 || $5 > 1.01) { exit 1 }
    END { if (NR != 9) exit 1 }' "$DIR/rows.csv"
ok "errors as a matrix" awk -F, 'NR > 1 { for (i = 3; i <= 10; i++) if ($i < 0 || $i > 1e-2) exit 1 }
    END { if (NR != 9) exit 1 }' "$DIR/e.csv"
# Summed over patches: 256 rays from each of 400 patches, in three standard errors of the exact.
ok "errors of summed patches" exits 0 factors "$room" -o "$DIR/f.csv" --errors "$DIR/s.csv" \
    "${fast[@]}" --closure none
ok "are what the factors are off by" awk -F, 'FNR == 1 { file++ } FNR > 1 { for (i = 3; i <= 10; i++)
    if (file == 1) e[FNR, i] = $i; else if (file == 2) f[FNR, i] = $i
    else if (e[FNR, i] > 0) { d = ($i - f[FNR, i]) / e[FNR, i]; n++; far += d > 3 || d < -3
        big += e[FNR, i] > 5e-3 } } END { if (n < 40 || far > 0.05 * n || big > 0) exit 1 }' \
    "$DIR/s.csv" "$DIR/f.csv" <("$ISOLUX" factors "$room" --accuracy 1e-5 --progress none 2>/dev/null)
ok "errors by patch" exits 0 factors "$room" --by patch -o "$DIR/q.mtx" --errors "$DIR/e1.mtx" \
    "${fast[@]}" --patches 50 --threads 1
ok "errors by patch, two threads" exits 0 factors "$room" --by patch -o "$DIR/q.npz" \
    --errors "$DIR/e2.mtx" "${fast[@]}" --patches 50 --threads 2
ok "the same errors" cmp "$DIR/e1.mtx" "$DIR/e2.mtx"
# Of three digits: to half a hundredth.
ok "largest errors of rows" awk 'FNR == NR && !/^%/ && n++ { if ($3 > e[$1]) e[$1] = $3 }
    FNR != NR && FNR > 1 { split($0, v, ","); d = v[20] - e[FNR - 1]
        if (d > 5e-3 * v[20] || d < -5e-3 * v[20] || v[18] > 1e-6) exit 1; rows++ }
    END { if (rows < 40) exit 1 }' "$DIR/e1.mtx" "$DIR/q.csv"
ok "errors in the archive" unzip_lists "$DIR/q.npz" standard_error.npy row_sum_error.npy
ok "rows of patches" fails 2 'beside the matrix' factors "$room" --by patch --rows "$DIR/r.csv" \
    -o "$DIR/x" "${fast[@]}"
ok "by patch" exits 0 factors "$room" --by patch -o "$DIR/p.mtx" "${fast[@]}"
ok "row sums of patches" awk -F, 'NR > 1 && ($(NF - 2) < 0.999999 || $(NF - 2) > 1.000001) { exit 1 }
    END { if (NR < 100) exit 1 }' "$DIR/p.csv"

# --- points --------------------------------------------------------------------------------------

# From the middle of a wall of the unit cube to the wall opposite: 4 times the corner formula.
cat >"$DIR/cube.vs3" <<'CUBE'
T unit cube
F 3
V 1 0 0 0
V 2 1 0 0
V 3 1 1 0
V 4 0 1 0
V 5 0 0 1
V 6 1 0 1
V 7 1 1 1
V 8 0 1 1 / and what follows a slash or an exclamation mark is for readers only
S 1 1 2 3 4 0 0 0.9 floor
S 2 8 7 6 5 0 0 0.9 ceiling
S 3 1 5 6 2 0 0 0.9 wall1
S 4 2 6 7 3 0 3 0.9 wall2
S 5 3 7 8 4 0 3 0.9 wall3
S 6 4 8 5 1 0 3 0.9 wall4
E
CUBE
printf '0.5,0.5,0,0,0,2\n0.25 0.5 0.5 1 0 0\n' >"$DIR/points.csv"
ok "factors of points" exits 0 factors "$DIR/cube.vs3" --points "$DIR/points.csv" \
    --gather-rays 65536 -o "$DIR/q.csv" --progress none
ok "their columns" grep -qx 'x,y,z,nx,ny,nz,floor,ceiling,wall1,escaped,unused,standard_error' \
    "$DIR/q.csv"
ok "floor to ceiling by the corner formula" awk -F, 'NR == 2 { pi = atan2(0, -1); x = 0.5
    f = 4 / pi * x / sqrt(1 + x * x) * atan2(x, sqrt(1 + x * x)); d = $8 - f
    if ($7 != 0 || d > 4 * $12 || d < -4 * $12 || $12 > 1e-3) exit 1
    s = $7 + $8 + $9 + $10 + $11; if (s < 0.999999 || s > 1.000001) exit 1 }
    END { if (NR != 3) exit 1 }' "$DIR/q.csv"
ok "the same with one thread" exits 0 factors "$DIR/cube.vs3" --points "$DIR/points.csv" \
    --gather-rays 65536 -o "$DIR/r.csv" --progress none --threads 1
ok "byte for byte" cmp "$DIR/q.csv" "$DIR/r.csv"
ok "points and a matrix" fails 2 'no other matrix' factors "$room" --points "$DIR/points.csv" \
    --by patch -o "$DIR/x"

# --- heat ----------------------------------------------------------------------------------------

# Groups that are called like columns of the table.
make_cube "$DIR"
sed 's/^g floor/g area/; s/^g plate/g escaped/; /^g ceiling/,$d' "$DIR/cube.obj" >"$DIR/names.obj"
ok "odd names" exits 0 factors "$DIR/names.obj" -o "$DIR/n.csv" "${fast[@]}"
ok "each column has a name of its own" test "$(head -n 1 "$DIR/n.csv" | tr ',' '\n' | sort | uniq -d)" = ""
ok "in rows as in columns" grep -q '^escaped (group),' "$DIR/n.csv"
ok "the table's own stay" grep -q '^group,area,.*,escaped$' "$DIR/n.csv"

# All walls at 293.15 K but the third, 10 K colder: the listed net fluxes, to what 256 rays leave.
ok "net flux" exits 0 factors "$room" --exchange flux --temperature srf-3=283.15 -o "$DIR/q.csv" \
    "${fast[@]}" --rays 4096
ok "the listed fluxes" awk -F, -v listed="-17.06 -14.83 47.48 -0.3343 -0.4038 -1.769 -6.776 -6.776" '
    BEGIN { split(listed, q, " ") }
    NR > 1 { d = $5 - q[NR - 1]; sum += $6; if (d > 0.05 || d < -0.05) exit 1 }
    END { if (NR != 9 || sum > 0.05 || sum < -0.05) exit 1 }' "$DIR/q.csv"
ok "script-F" exits 0 factors "$room" --exchange hottel -o "$DIR/s.csv" "${fast[@]}"
# The listing of the same room by View3D, six digits: its first three rows.
ok "script-F as View3D writes it" exits 0 factors "$room" --exchange hottel -o "$DIR/s.vf" \
    --accuracy 1e-4 --progress none
ok "as listed" awk -v a="0.030130 0.099217 0.314246 0.032590 0.030812 0.159007 0.116999 0.116999" \
    -v b="0.297651 0.009602 0.273190 0.007440 0.003718 0.092437 0.107981 0.107981" \
    -v c="0.471369 0.136595 0.025211 0.006160 0.003720 0.048885 0.104030 0.104030" '
    BEGIN { split(a, f1, " "); split(b, f2, " "); split(c, f3, " ") }
    NR == 1 { if ($5 != 1 || length($0) != 30) exit 1 }
    NR >= 3 && NR <= 5 { for (i = 1; i <= 8; i++) {
        f = NR == 3 ? f1[i] : NR == 4 ? f2[i] : f3[i]
        if ($i - f > 3e-4 || f - $i > 3e-4) exit 1 } }
    END { if (NR != 11) exit 1 }' "$DIR/s.vf"
ok "script-F rows sum to the emissivity" awk -F, 'NR > 1 { s = 0
    for (i = 3; i <= NF; i++) s += $i; if (s < 0.89999 || s > 0.90001) exit 1 }' "$DIR/s.csv"
ok "Gebhart" exits 0 factors "$room" --exchange gebhart --emissivity 0.5 -o "$DIR/b.csv" "${fast[@]}"
ok "Gebhart rows sum to 1" awk -F, 'NR > 1 { s = 0
    for (i = 3; i <= NF; i++) s += $i; if (s < 0.99999 || s > 1.00001) exit 1 }' "$DIR/b.csv"
printf 'group,T\r\nsrf-3,283.15\r\n' >"$DIR/t.csv"
ok "temperatures from a file" exits 0 factors "$room" --exchange flux --temperature "$DIR/t.csv" \
    -o "$DIR/r.csv" "${fast[@]}" --rays 4096
ok "the same as from the command line" cmp "$DIR/q.csv" "$DIR/r.csv"
printf 'srf-3,283.15\nsrf-9,1\n' >"$DIR/t.csv"
ok "a wrong name in the file" fails 3 't.csv:2: .*srf-9' factors "$room" --exchange flux \
    --temperature "$DIR/t.csv" "${fast[@]}"
ok "a wrong name" fails 2 "no group 'x'" factors "$room" --exchange flux --temperature x=3 \
    "${fast[@]}"
ok "an impossible emissivity" fails 3 'emissivity' factors "$room" --exchange hottel \
    --emissivity 1.5 "${fast[@]}"
ok "temperatures without flux" fails 2 'exchange flux' factors "$room" --temperature 300 "${fast[@]}"
ok "exchange by patch" fails 2 'between groups' factors "$room" --by patch --exchange hottel \
    -o "$DIR/x" "${fast[@]}"
finish

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
ok "View3D's heading" grep -qE '^View3D isolux-[0-9.]+ 1 1 0 8$' "$DIR/f.vf"
ok "View3D's rows" awk 'NR == 2 { if (NF != 8 || $1 != 9) exit 1 }
    NR > 2 && NR < 11 { s = 0; for (i = 1; i <= NF; i++) s += $i
        if (NF != 8 || s < 0.99999 || s > 1.00001) exit 1 }
    END { if (NR != 11) exit 1 }' "$DIR/f.vf"
ok "by patch as npz" exits 0 factors "$room" --by patch -o "$DIR/p.npz" "${fast[@]}"
ok "npz is an archive of arrays" unzip_lists "$DIR/p.npz" data.npy indices.npy indptr.npy

# All walls at 293.15 K but the third, 10 K colder: the listed net fluxes, to what 256 rays leave.
ok "net flux" exits 0 factors "$room" --exchange flux --temperature srf-3=283.15 -o "$DIR/q.csv" \
    "${fast[@]}" --rays 4096
ok "the listed fluxes" awk -F, -v listed="-17.06 -14.83 47.48 -0.3343 -0.4038 -1.769 -6.776 -6.776" '
    BEGIN { split(listed, q, " ") }
    NR > 1 { d = $5 - q[NR - 1]; sum += $6; if (d > 0.05 || d < -0.05) exit 1 }
    END { if (NR != 9 || sum > 0.05 || sum < -0.05) exit 1 }' "$DIR/q.csv"
ok "script-F" exits 0 factors "$room" --exchange hottel -o "$DIR/s.csv" "${fast[@]}"
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

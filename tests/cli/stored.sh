#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Form factors in a file, in 16 bits, and on disk where memory is short.
. "$(dirname "$0")/tap.inc"
files=$(dirname "$0")/../../scenes/files
scene=$files/cornell.msd
fast=(--quality draft --progress none)

# What of the JSON stands behind a key, the first time.
value() { sed -nE "s/.*\"$2\": ([^,}]*).*/\1/p" "$1" | head -n 1; }

# --- saved and read again ------------------------------------------------------------------------

kept=(--factors "$DIR/f.ilf" "${fast[@]}")
ok "factors are written" exits 0 solve "$scene" "${kept[@]}" -o "$DIR/a.ply" --json "$DIR/a.json"
ok "written, not read" grep -q '"read": false' "$DIR/a.json"
ok "factors are read" exits 0 solve "$scene" "${kept[@]}" -o "$DIR/b.ply" --json "$DIR/b.json"
ok "read, not cast" grep -q '"read": true' "$DIR/b.json"
ok "the same light" cmp "$DIR/a.ply" "$DIR/b.ply"
ok "without the file" exits 0 solve "$scene" "${fast[@]}" -o "$DIR/c.ply"
ok "the same light again" cmp "$DIR/a.ply" "$DIR/c.ply"
ok "as cast: another closure" exits 0 solve "$scene" "${kept[@]}" --closure none -o "$DIR/n.ply"
ok "the same as cast anew" exits 0 solve "$scene" "${fast[@]}" --closure none -o "$DIR/m.ply"
ok "bit for bit" cmp "$DIR/n.ply" "$DIR/m.ply"
ok "other options" fails 3 'f.ilf: .*other options' solve "$scene" "${kept[@]}" --rays 50
ok "another scene" fails 3 'f.ilf: .*another scene' solve "$files/furnace.msd" "${kept[@]}"
ok "render and factors share it" exits 3 factors "$scene" "${kept[@]}" --patches 100 -o "$DIR/x.csv"
ok "divided without a file" exits 0 solve "$scene" "${fast[@]}" --adapt -o "$DIR/d.ply"
for kind in written read; do
    ok "--adapt, the first factors $kind" exits 0 solve "$scene" "${fast[@]}" --adapt \
        --factors "$DIR/d.ilf" -o "$DIR/e.ply"
    ok "divided the same" cmp "$DIR/d.ply" "$DIR/e.ply"
done
ok "its patches are others" fails 3 'd.ilf: ' solve "$scene" "${fast[@]}" --factors "$DIR/d.ilf"
size=$(wc -c <"$DIR/f.ilf")
head -c $((size - 1)) "$DIR/f.ilf" >"$DIR/cut.ilf"
ok "a file that is cut" fails 3 'cut.ilf: .*cut or damaged' solve "$scene" "${fast[@]}" \
    --factors "$DIR/cut.ilf"
cp "$DIR/f.ilf" "$DIR/bad.ilf"
printf 'x' | dd of="$DIR/bad.ilf" bs=1 seek=$((size / 2)) conv=notrunc 2>"$DIR/null"
ok "a file that is damaged" fails 3 'bad.ilf: .*damaged' solve "$scene" "${fast[@]}" \
    --factors "$DIR/bad.ilf"
ok "what is no such file" fails 3 'is no file of form factors' solve "$scene" "${fast[@]}" \
    --factors "$scene"

# --- 16 bits -------------------------------------------------------------------------------------

ok "16 bits" exits 0 solve "$scene" "${kept[@]}" --storage 16 --json "$DIR/s.json"
ok "half the bytes" test "$(value "$DIR/s.json" bytes | cut -d . -f 1)" -lt 1000000000
ok "rounded by less than 2^-11" awk -v r="$(value "$DIR/s.json" rounding)" \
    'BEGIN { exit !(r > 0 && r <= 2^-11) }'
for solver in gauss-seidel jacobi progressive cg gmres two-level; do
    ok "$solver on 32 bits" exits 0 solve "$scene" "${kept[@]}" --solver $solver \
        --json "$DIR/w.json"
    ok "$solver on 16 bits" exits 0 solve "$scene" "${kept[@]}" --solver $solver --storage 16 \
        --json "$DIR/h.json"
    ok "$solver: the same light absorbed" awk \
        -v a="$(tr -d '\n' <"$DIR/w.json" | sed -E 's/.*"absorbed": \[ *([0-9.e+-]*).*/\1/')" \
        -v b="$(tr -d '\n' <"$DIR/h.json" | sed -E 's/.*"absorbed": \[ *([0-9.e+-]*).*/\1/')" \
        'BEGIN { d = a / b - 1; exit !(a > 0 && d < 5e-4 && d > -5e-4) }'
done

# --- on disk -------------------------------------------------------------------------------------

big=(factors "$files/furnace.msd" --patches 20000 --rays 512 --by patch --progress none)
ok "all in memory" exits 0 "${big[@]}" -o "$DIR/p.npz" --json "$DIR/p.json"
# The memory that a sanitizer takes for itself is many times the program's own.
if ! grep -q __asan_init "$ISOLUX"; then
    ok "rows on disk" env TMPDIR="$DIR" "$ISOLUX" "${big[@]}" -o "$DIR/q.npz" \
        --json "$DIR/q.json" --max-memory 130MB
    ok "the same bytes" cmp "$DIR/p.npz" "$DIR/q.npz"
    ok "within the limit" test "$(value "$DIR/q.json" peak_bytes)" -le 130000000
fi
ok "beyond it otherwise" test "$(value "$DIR/p.json" peak_bytes)" -gt 130000000
ok "nothing is left behind" test -z "$(find "$DIR" -name '.isolux*')"
ok "too little even so" fails 6 'form factors' "${big[@]}" --max-memory 60MB -o "$DIR/x.npz"
ok "no folder to write to" env TMPDIR="$DIR/none" ISOLUX="$ISOLUX" bash -c \
    '"$0" "$@" 2>"'"$DIR"'/err"; test $? = 1' "$ISOLUX" "${big[@]}" --max-memory 130MB \
    -o "$DIR/x.npz"
finish

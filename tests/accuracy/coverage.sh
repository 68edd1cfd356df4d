#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Whether printed standard errors are honest: of many values known in closed form, how many lie
# within one and within three of them. Honest errors of 16 scramblings: 67 % and 99.1 %.
#
#   tests/accuracy/coverage.sh PROGRAM [SEEDS]     8 seeds; about a minute of processor time each
#
# factors  the curved pairs of `validate --filter factors`: closed forms, no strips, no blockers
# points   irradiance of 2000 points below a square lamp, a square plate half way up; exact by the
#          closed form of the lamp less the part of it that the plate hides
set -u
ISOLUX=${1:?names the program}
SEEDS=${2:-8}
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT

# Lines of deviations in standard errors, of a kind each.
tell() {
    awk '{ t = $2 < 0 ? -$2 : $2; k[$1] = 1; n[$1]++; a[$1] += t <= 1; c[$1] += t <= 3 }
        END { for (i in k) printf "%-14s %6d values  %5.1f %% within one  %6.2f %% within three\n",
              i, n[i], 100 * a[i] / n[i], 100 * c[i] / n[i] }' "$@"
}

for ((seed = 1; seed <= SEEDS; seed++)); do
    "$ISOLUX" validate --filter factors --seed "$seed" --json "$DIR/v.json" >/dev/null ||
        [ $? -eq 4 ] || exit 1
    # Pairs that are exact have no error to speak of; both ways of a pair say the same.
    tr -d '\n' <"$DIR/v.json" | sed 's/{ *"case"/\n"case"/g' | awk -F'[:,] *' '
        /"case": "factors",/ && !/strip|wedge|duct|string|plate|between|2 to 1|base to coat/ {
            match($0, /"deviation": [^,]*/); d = substr($0, RSTART + 13, RLENGTH - 13) + 0
            match($0, /"standard_error": [^,]*/); e = substr($0, RSTART + 18, RLENGTH - 18) + 0
            if (e > 1e-7 && (d > 1e-9 || d < -1e-9)) print "factors", d / e }' >>"$DIR/deviations"
done
tell "$DIR/deviations"

printf 'newmtl lamp\nKd 0 0 0\nKe 1 1 1\nnewmtl black\nKd 0 0 0\n' >"$DIR/lamp.mtl"
cat >"$DIR/lamp.obj" <<'END2'
mtllib lamp.mtl
v 0 0 2
v 0 1 2
v 1 1 2
v 1 0 2
v 0.25 0.25 1
v 0.75 0.25 1
v 0.75 0.75 1
v 0.25 0.75 1
v -1 -1 0
v 2 -1 0
v 2 2 0
v -1 2 0
usemtl lamp
f 1 2 3 4
usemtl black
f 5 6 7 8
f 9 10 11 12
END2
awk 'BEGIN { srand(1); for (i = 0; i < 2000; i++)
    printf "%.6f,%.6f,0,0,0,1\n", 3 * rand() - 1, 3 * rand() - 1 }' >"$DIR/points.csv"
for rays in 256 1024 4096 16384; do
    "$ISOLUX" measure "$DIR/lamp.obj" --points "$DIR/points.csv" --gather-rays $rays --patches 100 \
        --rays 16 --progress none -o "$DIR/lux.csv" 2>/dev/null || exit 1
    awk -F, -v rays=$rays '
        function corner(a, b,   p, q) { a /= 2; b /= 2; p = sqrt(1 + a * a); q = sqrt(1 + b * b)
            return (a / p * atan2(b / p, 1) + b / q * atan2(a / q, 1)) / 2 }
        function lit(a, b, c, d) {
            return corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c) }
        function max(a, b) { return a > b ? a : b }
        function min(a, b) { return a < b ? a : b }
        NR > 1 { x = $1; y = $2; e = lit(-x, 1 - x, -y, 1 - y) # pi times the factor of radiance 1
            a = max(-x, 2 * (0.25 - x)); b = min(1 - x, 2 * (0.75 - x))
            c = max(-y, 2 * (0.25 - y)); d = min(1 - y, 2 * (0.75 - y))
            if (b > a && d > c) e -= lit(a, b, c, d)
            # Fully lit points are exact.
            if ($12 > 1e-5 * e + 1e-9) print "points," rays, ($10 - e) / $12 }' "$DIR/lux.csv"
done >"$DIR/points"
tell "$DIR/points" | sort -t, -k2n

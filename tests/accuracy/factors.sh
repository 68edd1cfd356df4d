#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# How the error of factors between groups falls with the work, and whether standard errors are honest.
#
#   tests/accuracy/factors.sh [PICTURE.svg]      ISOLUX: the program (build/isolux); SEEDS: how many (8)
#
# rays    a cube from inside by hemisphere rays from 24 patches: rms over all pairs and seeds against
#         the closed forms
# points  a cube with a plate in it, pair by pair: rms of raw row sums less 1, over all seeds
# errors  the same cube with a plate: shares of row sums within one and three of their standard errors
set -eu
isolux=${ISOLUX:-build/isolux}
seeds=${SEEDS:-8}
picture=${1:-}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

cat >"$dir/cube.obj" <<'END'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
g x0
f 1 4 8 5
g x1
f 2 6 7 3
g y0
f 1 5 6 2
g y1
f 3 7 8 4
g z0
f 1 2 3 4
g z1
f 5 8 7 6
END
{
    cat "$dir/cube.obj"
    printf 'v 0.25 0.75 0.25\nv 0.75 0.75 0.25\nv 0.75 0.75 0.75\nv 0.25 0.75 0.75\n'
    printf 'g front\nf 9 10 11 12\ng back\nf 12 11 10 9\n'
} >"$dir/plate.obj"

# SCENE OPTIONS...: F.csv and F.json of raw factors.
factors() {
    "$isolux" factors "$@" --closure none --progress none -o "$dir/F.csv" --json "$dir/F.json" \
        2>/dev/null || [ $? -eq 4 ]
}
value() { awk -F'[:,]' -v key="\"$1\"" '$1 ~ key { print $2 + 0; exit }' "$dir/F.json"; }

for rays in 16 64 256 1024 4096 16384; do
    for ((seed = 0; seed < seeds; seed++)); do
        factors "$dir/cube.obj" --patches 24 --rays $rays --seed $seed
        awk -F, -v rays="$(value rays)" 'NR > 1 { for (i = 3; i <= 8; i++) { a = NR - 2; b = i - 3
            e = a == b ? 0 : int(a / 2) == int(b / 2) ? 0.199824895698387 : 0.200043776075403
            s += ($i - e) ^ 2 } } END { print "rays", rays, sqrt(s / 30) }' "$dir/F.csv"
    done
done >"$dir/table"
for accuracy in 1e-3 3e-4 1e-4 3e-5 1e-5 3e-6; do
    for ((seed = 0; seed < seeds; seed++)); do
        factors "$dir/plate.obj" --accuracy $accuracy --quality final --seed $seed
        awk -F, -v points="$(value points)" 'NR > 1 { t = 0; for (i = 3; i <= 10; i++) t += $i
            s += (t - 1) ^ 2 } END { print "points", points, sqrt(s / 8) }' "$dir/F.csv"
        tr -d ' \n' <"$dir/F.json" | sed 's/.*"standard_errors":\[\[//; s/\]\].*//; s/\],\[/\n/g' \
            >"$dir/errors"
        echo >>"$dir/errors"
        awk -F, 'NR == FNR { for (i = 1; i <= NF; i++) e[FNR] += $i ^ 2; next }
            FNR > 1 && e[FNR - 1] > 0 { t = 0; for (i = 3; i <= 10; i++) t += $i
            d = (t - 1) / sqrt(e[FNR - 1]); print "error", d < 0 ? -d : d }' \
            "$dir/errors" "$dir/F.csv" >>"$dir/shares"
    done
done >>"$dir/table"

# Rows of one kind and like work become one; the slope is that of all in logarithms.
awk -v seeds="$seeds" '{ k[NR] = $1; w[NR] = $2; e[NR] = $3 }
    END { for (i = 1; i <= NR; i += seeds) { x = y = 0
        for (j = i; j < i + seeds; j++) { x += w[j] / seeds; y += e[j] ^ 2 / seeds }
        print k[i], x, sqrt(y) } }' "$dir/table" >"$dir/means"
awk '{ printf "%-7s %12.0f  %.3g\n", $1, $2, $3
       x = log($2); y = log($3); n[$1]++; sx[$1] += x; sy[$1] += y; sxx[$1] += x * x
       sxy[$1] += x * y }
    END { for (k in n) printf "slope of %s: %.2f\n", k,
          (n[k] * sxy[k] - sx[k] * sy[k]) / (n[k] * sxx[k] - sx[k] ^ 2) }' "$dir/means"
awk '{ n++; a += $2 <= 1; c += $2 <= 3 }
    END { printf "of %d row sums %.1f %% within one, %.2f %% within three standard errors\n", n,
          100 * a / n, 100 * c / n }' "$dir/shares"

[ -n "$picture" ] || exit 0
awk 'function px(w) { return 60 + 80 * (log(w) / log(10) - 2) }
    function py(e) { return 20 + 70 * (-1 - log(e) / log(10)) }
    BEGIN { print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"520\" height=\"430\" " \
                  "font-family=\"sans-serif\" font-size=\"12\">"
        print "<rect width=\"520\" height=\"430\" fill=\"white\"/>"
        for (d = 2; d <= 7; d++) printf "<path d=\"M%g 20V370\" stroke=\"#ddd\"/>" \
            "<text x=\"%g\" y=\"388\">1e%d</text>\n", px(10 ^ d), px(10 ^ d) - 10, d
        for (d = -1; d >= -6; d--) printf "<path d=\"M60 %gH460\" stroke=\"#ddd\"/>" \
            "<text x=\"22\" y=\"%g\">1e%d</text>\n", py(10 ^ d), py(10 ^ d) + 4, d
        print "<text x=\"200\" y=\"410\">rays, points</text>"
        colour["rays"] = "#c33"; colour["points"] = "#36c" }
    { p[$1] = p[$1] (p[$1] == "" ? "M" : "L") px($2) " " py($3)
      printf "<circle cx=\"%g\" cy=\"%g\" r=\"3\" fill=\"%s\"/>\n", px($2), py($3), colour[$1] }
    END { for (k in p) printf "<path d=\"%s\" fill=\"none\" stroke=\"%s\"/>\n", p[k], colour[k]
        print "<text x=\"300\" y=\"40\" fill=\"#c33\">cube, hemisphere rays</text>"
        print "<text x=\"300\" y=\"58\" fill=\"#36c\">cube with plate, pairs</text></svg>" }' \
    "$dir/means" >"$picture"

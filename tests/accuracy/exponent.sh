#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Cost against patches: CPU seconds of solvers with links (flat), between nodes of a tree
# (hierarchical) and without links (stochastic) over numbers of patches, each with as many rays per
# patch throughout.
#   exponent.sh PROGRAM [SCENE [PICTURE.svg]]
#       FLAT, HIERARCHICAL, STOCHASTIC: numbers of patches, "" for none; RAYS: per patch (64)
# Writes CSV (solver, patches, CPU seconds, net_cpu: those less the seconds of a run with one ray
# per patch, rays, estimated error where there is one), then for each solver the exponent, the slope
# of a line fitted to the logarithms: of all CPU seconds, and of net ones. CPU seconds are user time
# of all threads. The picture shows all CPU seconds.
set -eu
isolux=$1
scene=${2:-$(dirname "$0")/../../scenes/files/cornell.msd}
picture=${3:-}
rays=${RAYS:-64}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

# cpu OPTION...: user seconds of solve, on standard output.
cpu() {
    { TIMEFORMAT=%U; time "$isolux" solve "$scene" --no-adapt --progress none --json "$dir/a.json" \
        -o "$dir/a.ply" "$@" 2>"$dir/err" || true; } 2>&1 | tail -n 1
}
value() {
    sed -nE "s/.*\"$1\": ([0-9.e+-]+).*/\1/p" "$dir/a.json" | head -n 1
}
# measure SOLVER NAME PATCHES...
measure() {
    local solver=$1 name=$2 patches all few
    shift 2
    for patches in "$@"; do
        few=$(cpu --patches "$patches" --rays 1 --solver stochastic)
        rm -f "$dir/a.json"
        all=$(cpu --patches "$patches" --rays "$rays" --solver "$solver")
        [ -s "$dir/a.json" ] || { cat "$dir/err" >&2; exit 1; }
        echo "$name,$(value patches),$all,$(awk -v a="$all" -v b="$few" 'BEGIN { print a - b }')" \
            "$(value rays) $(value estimated_error)" | tr ' ' ,
    done
}
{
    echo "solver,patches,cpu,net_cpu,rays,estimated_error"
    # shellcheck disable=SC2086
    measure gauss-seidel flat ${FLAT-10000 18000 32000 56000 100000}
    # shellcheck disable=SC2086
    measure hierarchical hierarchical ${HIERARCHICAL-10000 18000 32000 56000 100000}
    # shellcheck disable=SC2086
    measure stochastic stochastic ${STOCHASTIC-10000 32000 100000}
} | tee "$dir/cost.csv"
awk -F, 'NR > 1 { n[$1]++; x[$1] += log($2); xx[$1] += log($2) ^ 2
        for (c = 3; c <= 4; c++) { y[$1, c] += log($c); xy[$1, c] += log($2) * log($c) } }
    function slope(k, c) { return (n[k] * xy[k, c] - x[k] * y[k, c]) / (n[k] * xx[k] - x[k] ^ 2) }
    END { for (k in n) if (n[k] > 1)
        printf "exponent of %s: %.2f (net %.2f)\n", k, slope(k, 3), slope(k, 4) }' \
    "$dir/cost.csv" | sort | tee "$dir/exponents"

[ -n "$picture" ] || exit 0
# From 10^4 to 10^6 patches and 10^-1 to 10^4 seconds; dashed: as the patches.
awk -F'[,:]' 'function px(n) { return 60 + 190 * (log(n) / log(10) - 4) }
    function py(s) { return 350 - 66 * (log(s) / log(10) + 1) }
    BEGIN { print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"520\" height=\"400\" " \
                  "font-family=\"sans-serif\" font-size=\"12\">"
        print "<rect width=\"520\" height=\"400\" fill=\"white\"/>"
        for (d = 4; d <= 6; d++) printf "<path d=\"M%g 20V350\" stroke=\"#ddd\"/>" \
            "<text x=\"%g\" y=\"366\">1e%d</text>\n", px(10 ^ d), px(10 ^ d) - 10, d
        for (d = -1; d <= 4; d++) printf "<path d=\"M60 %gH460\" stroke=\"#ddd\"/>" \
            "<text x=\"22\" y=\"%g\">1e%d</text>\n", py(10 ^ d), py(10 ^ d) + 4, d
        printf "<path d=\"M%g %gL%g %g\" stroke=\"#999\" stroke-dasharray=\"4 4\"/>\n",
               px(1e4), py(0.3), px(1e6), py(30)
        print "<text x=\"220\" y=\"388\">patches</text><text x=\"8\" y=\"14\">CPU s</text>"
        split("flat hierarchical stochastic", name, " "); split("#c33 #383 #36c", ink, " ") }
    NR == FNR { slope[substr($1, 13)] = $2; next }
    FNR > 1 { p[$1] = p[$1] (p[$1] == "" ? "M" : "L") px($2) " " py($3)
        dot[$1] = dot[$1] "<circle cx=\"" px($2) "\" cy=\"" py($3) "\" r=\"3\"/>" }
    END { for (k = 1; k <= 3; k++) if (p[name[k]] != "")
            printf "<g fill=\"%s\">%s<path d=\"%s\" fill=\"none\" stroke=\"%s\"/>" \
                   "<text x=\"80\" y=\"%d\">%s%s</text></g>\n", ink[k], dot[name[k]], p[name[k]],
                   ink[k], 24 + 18 * k, name[k],
                   slope[name[k]] == "" ? "" : ", exponent" slope[name[k]]
        print "</svg>" }' "$dir/exponents" "$dir/cost.csv" >"$picture"

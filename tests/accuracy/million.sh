#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Light without links (--solver stochastic): what a number of patches costs in CPU seconds, its
# estimated error, and how far it is from a second run of other rays.
#   million.sh SCENE [PATCHES...]    ISOLUX: the program; RAYS: per patch, most (64); OPTIONS: more
# Writes a table; the last line is the exponent of CPU seconds of the solver over patches.
set -u
: "${ISOLUX:=build/isolux}"
scene=$1
shift
[ $# -gt 0 ] || set -- 10000 30000 100000 300000 1000000
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# solved PATCHES SEED RAYS NAME: CPU seconds of it, on standard output.
solved() {
    # shellcheck disable=SC2086
    { TIMEFORMAT=%U; time "$ISOLUX" solve "$scene" ${OPTIONS:-} --patches "$1" --seed "$2" \
        --rays "$3" --solver stochastic --progress none --json "$dir/$4.json" \
        -o "$dir/$4.ply" 2>"$dir/err"; } 2>&1 | tail -n 1
}
value() {
    sed -nE "s/.*\"$2\": ([0-9.e+-]+).*/\1/p" "$dir/$1.json" | head -n 1
}
printf '| patches | CPU s | CPU s of one ray a patch | estimated error | against another seed |\n'
printf '|---|---|---|---|---|\n'
for patches in "$@"; do
    few=$(solved "$patches" 1 1 few)
    cpu=$(solved "$patches" 1 "${RAYS:-64}" a)
    solved "$patches" 2 "${RAYS:-64}" b >/dev/null
    # Two runs of the same error are apart by the root of 2 times it.
    off=$("$ISOLUX" compare "$dir/a.ply" "$dir/b.ply" 2>&1 |
        awk '/error/ { printf "%.2f", $2 / sqrt(2) }')
    printf '| %s | %s | %s | %.2f %% | %s %% |\n' "$(value a patches)" "$cpu" "$few" \
        "$(awk -v e="$(value a estimated_error)" 'BEGIN { print 100 * e }')" "$off"
    echo "$(value a patches) $cpu $few" >>"$dir/cost"
done
awk '{ x = log($1); y = log($2 - $3); n++; a += x; b += y; c += x * x; d += x * y }
    END { if (n > 1) printf "exponent %.2f\n", (n * d - a * b) / (n * c - a * a) }' "$dir/cost"

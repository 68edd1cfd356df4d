#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Light without links (--solver stochastic): what a number of patches costs in CPU seconds, its
# estimated error, and how far it is from a reference: the same patches (they depend on the seed, so
# it is the same too) with many times the rays. The run's own rays are among the reference's, so the
# difference hides one in TIMES of the error's square, and has the reference's own error in it.
#   million.sh SCENE [PATCHES...]    ISOLUX: the program; RAYS: per patch, most (64); OPTIONS: more;
#                                    TIMES: rays of the reference over those (8; 0: no reference)
# Writes a table; the last line is the exponent of CPU seconds of the solver over patches.
set -u
: "${ISOLUX:=build/isolux}"
scene=$1
shift
[ $# -gt 0 ] || set -- 10000 30000 100000 300000 1000000
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# solved PATCHES RAYS NAME [OPTION...]: CPU seconds of it, on standard output.
solved() {
    local patches=$1 rays=$2 name=$3
    shift 3
    # shellcheck disable=SC2086
    { TIMEFORMAT=%U; time "$ISOLUX" solve "$scene" ${OPTIONS:-} --patches "$patches" --seed 1 \
        --rays "$rays" --solver stochastic --progress none --json "$dir/$name.json" \
        -o "$dir/$name.ply" "$@" 2>"$dir/err"; } 2>&1 | tail -n 1
}
value() {
    sed -nE "s/.*\"$2\": ([0-9.e+-]+).*/\1/p" "$dir/$1.json" | head -n 1
}
percent() { awk -v e="$(value "$1" estimated_error)" 'BEGIN { printf "%.2f %%", 100 * e }'; }
rays=${RAYS:-64}
times=${TIMES:-8}
printf '| patches | CPU s | CPU s of one ray a patch | estimated error | against the reference'
printf ' | its estimated error |\n|---|---|---|---|---|---|\n'
for patches in "$@"; do
    few=$(solved "$patches" 1 few)
    cpu=$(solved "$patches" "$rays" a)
    off=- own=-
    if [ "$times" -gt 0 ]; then
        # A tolerance that is not reached: all of the rays are cast.
        solved "$patches" $((rays * times)) b --tolerance 1e-6 >/dev/null
        off=$("$ISOLUX" compare "$dir/b.ply" "$dir/a.ply" 2>&1 | awk '/error/ { print $2 " %" }')
        own=$(percent b)
    fi
    printf '| %s | %s | %s | %s | %s | %s |\n' "$(value a patches)" "$cpu" "$few" \
        "$(percent a)" "$off" "$own"
    echo "$(value a patches) $cpu $few" >>"$dir/cost"
done
awk '{ x = log($1); y = log($2 - $3); n++; a += x; b += y; c += x * x; d += x * y }
    END { if (n > 1) printf "exponent %.2f\n", (n * d - a * b) / (n * c - a * a) }' "$dir/cost"

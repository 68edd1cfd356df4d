#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# How many patches --adapt saves: its error and that of uniform division, both against a finer
# solution, and the number of uniform patches that have the same error (between measured ones along
# a line of logarithms). Run by hand; takes minutes.
#
#   tests/accuracy/adapt.sh [RAYS [REFERENCE]]     rays per patch (2048), its patches (40000)
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux}
rays=${1:-2048} reference=${2:-40000}
uniform=(500 1000 2000 4000 8000 16000) adaptive=(500 1000 2000 4000)
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# SCENE NAME OPTIONS: solves, prints how many patches it took
solve() {
    "$isolux" solve "$1" -o "$dir/$2.ply" --json "$dir/$2.json" --rays "$rays" --progress none \
        "${@:3}" 2>>"$dir/log" || { cat "$dir/log" >&2; exit 1; }
    sed -n '/"mesh"/,/}/s/.*"patches": *\([0-9]*\).*/\1/p' "$dir/$2.json" | head -n 1
}
# NAME: prints its error against the reference, in per cent
error() {
    "$isolux" compare "$dir/reference.ply" "$dir/$1.ply" 2>&1 |
        sed -n 's/^ *error *\([0-9.]*\) %.*/\1/p'
}

for scene in scenes/third-party/cornell-bitterli/cornell-box.obj scenes/files/cornell.msd \
             scenes/third-party/modern-hall/staircase2.obj; do
    count=$(solve "$scene" reference --no-adapt --patches "$reference") || exit 1
    echo "$scene: against $count patches with $rays rays each"
    for n in "${uniform[@]}"; do
        count=$(solve "$scene" u --no-adapt --patches "$n") || exit 1
        echo "uniform $count $(error u)"
    done >"$dir/table"
    for n in "${adaptive[@]}"; do
        count=$(solve "$scene" a --adapt --patches "$n") || exit 1
        echo "adapt $count $(error a)"
    done >>"$dir/table"
    awk '$1 == "uniform" { n[++k] = $2; e[k] = $3; printf "  uniform %6d  %7.3f %%\n", $2, $3 }
         $1 == "adapt" {
             for (i = 1; i < k - 1 && e[i + 1] > $3; i++)
                 continue
             same = exp(log(n[i]) + log($3 / e[i]) * log(n[i + 1] / n[i]) / log(e[i + 1] / e[i]))
             printf "  adapt   %6d  %7.3f %%   as uniform %6.0f: %.1f times as many\n", $2, $3,
                    same, same / $2
         }' "$dir/table"
done

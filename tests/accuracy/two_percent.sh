#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What light on all surfaces of the Cornell box to 2 % takes, flat and by nodes of a tree: relative
# RMSE of irradiance against a converged solution, and processor time of factors and solve.
# tests/accuracy/two_percent.sh PROGRAM [RUNS]
set -u
ISOLUX=${1:?names the program} RUNS=${2:-5}
SCENE=$(cd "$(dirname "$0")/../../scenes/files" && pwd)/cornell.msd
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT
TIMEFORMAT=%U

"$ISOLUX" solve "$SCENE" --patches 20000 --no-adapt --rays 2048 -o "$DIR/reference.ply" \
    2>"$DIR/err" || { cat "$DIR/err"; exit 1; }

# Processor seconds of the whole program, the least of some runs: what else the machine does only
# adds. All but factors and solve is in a run with a single ray and a single step as well.
least() {
    for ((k = 0; k < RUNS; k++)); do
        { time "$ISOLUX" "$@" --threads 1 >/dev/null 2>&1; } 2>&1
    done | sort -n | head -1
}

printf '%-14s %8s %5s %10s %8s %8s %10s\n' solver patches rays lamp-rays 'CPU s' error balance
for row in "gauss-seidel 1000 128 32" "gauss-seidel 2000 64 32" "gauss-seidel 2000 128 32" \
           "gauss-seidel 2000 128 48" "two-level 2000 128 48" "hierarchical 2000 128 32 0.03" \
           "hierarchical 2000 128 64 0.02" "hierarchical 2000 256 64 0.02"; do
    set -- $row
    options=(solve "$SCENE" --solver "$1" --patches "$2" --no-adapt --rays "$3" --lamp-rays "$4"
             --tolerance "${5:-1e-3}")
    # Exit 4: the noise that is told is above the tolerance.
    "$ISOLUX" "${options[@]}" -o "$DIR/a.ply" --json "$DIR/a.json" 2>"$DIR/err" || [ $? = 4 ] ||
        { cat "$DIR/err"; exit 1; }
    error=$("$ISOLUX" compare "$DIR/reference.ply" "$DIR/a.ply" 2>&1 |
            awk '$1 == "error" { print $2 }')
    balance=$(tr -d ' \n' <"$DIR/a.json" | sed 's/.*"balance_error":\[\([^]]*\)\].*/\1/' |
              tr ',' '\n' | sort -g | tail -1)
    all=$(least "${options[@]}")
    rest=$(least solve "$SCENE" --patches "$2" --no-adapt --rays 1 --lamp-rays 1 --closure none \
           --max-iterations 1)
    printf '%-14s %8s %5s %10s %8.3f %6s %% %10.1e\n' "$1" "$2" "$3" "$4" \
        "$(awk "BEGIN { print $all - $rest }")" "$error" "$balance"
done

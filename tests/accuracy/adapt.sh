#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# How many patches --adapt saves: its error, with at most a quarter of the patches, and that of
# uniform division, both against a uniform solution ten times as fine as the latter. Rays are many,
# so that what the patches leave out decides, not chance. Ends with 1 where --adapt is worse. Run by
# hand; takes minutes and, by the finest solution, some GB.
#
#   tests/accuracy/adapt.sh [RAYS [FINER]]     rays per patch (1024; half of it for the reference),
#                                              how many times as fine the reference is (10: one
#                                              only 3 times as fine shares the uniform one's errors)
# KEEP=DIR keeps the references there and takes them from there.
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux}
rays=${1:-1024} finer=${2:-10}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
keep=${KEEP:-$dir}
worse=0

# SCENE FILE OPTIONS: solves, prints how many patches it took
solve() {
    "$isolux" solve "$1" -o "$2" --json "$dir/summary.json" --progress none \
        "${@:3}" 2>>"$dir/log" || { cat "$dir/log" >&2; exit 1; }
    sed -n '/"mesh"/,/}/s/.*"patches": *\([0-9]*\).*/\1/p' "$dir/summary.json" | head -n 1
}
# REFERENCE FILE: prints its error, in per cent
error() {
    "$isolux" compare "$1" "$2" 2>&1 | sed -n 's/^ *error *\([0-9.]*\) %.*/\1/p'
}
# NAME SCENE UNIFORM ADAPTIVE: patches aimed at; somewhat less than a quarter, as --adapt may end a
# few per cent above
measure() {
    local reference=$keep/$1-$3-$rays-$finer.ply few fine count e small
    [ -s "$reference" ] ||
        solve "$2" "$reference" --no-adapt --rays $((rays / 2)) --patches $((finer * $3)) \
            >/dev/null || exit 1
    count=$(solve "$2" "$dir/u.ply" --no-adapt --rays "$rays" --patches "$3") || exit 1
    few=$(solve "$2" "$dir/q.ply" --no-adapt --rays "$rays" --patches "$4") || exit 1
    small=$(solve "$2" "$dir/a.ply" --adapt --rays "$rays" --patches "$4") || exit 1
    fine=$(error "$reference" "$dir/u.ply")
    e=$(error "$reference" "$dir/a.ply")
    few="$few $(error "$reference" "$dir/q.ply")"
    awk -v name="$1" -v u="$count $fine" -v q="$few" -v a="$small $e" 'BEGIN {
        split(u, U); split(q, Q); split(a, A)
        printf "%-16s uniform %6d %7.3f %%   uniform %6d %7.3f %%   adapt %6d %7.3f %%\n", name,
               Q[1], Q[2], U[1], U[2], A[1], A[2]
        good = A[2] <= U[2] && A[1] <= U[1] / 4
        printf "%-16s %s: %.2f times the error with %.2f of the patches\n", name,
               good ? "ok" : "WORSE", A[2] / U[2], A[1] / U[1]
        exit !good
    }' || worse=1
}

measure cornell-bitterli scenes/third-party/cornell-bitterli/cornell-box.obj 8000 1900
measure modern-hall scenes/third-party/modern-hall/staircase2.obj 32000 7600
[ $worse = 0 ] && echo "adapt: a quarter of the patches is enough on both"
exit $worse

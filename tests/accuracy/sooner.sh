#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How much sooner the gather reaches an error of 2 % than this program's own path tracer.
# tests/accuracy/sooner.sh PROGRAM [SIZE [SAMPLES [SCENE...]]]      NICE, GATHER: see below
#   SIZE     of the pictures (default 320x180); what paths and gather cost per pixel does not depend
#            on it, what comes before the gather does not either: at larger sizes it counts for less
#   SAMPLES  paths per pixel of each of two path pictures (default 64)
#   GATHER   options of the gather (default: --quality medium)
# Errors are relative RMSE of luminance, `all` of `isolux compare`, lamps left out. With two path
# pictures P, Q that share no ray, d2 being mean squared differences:
#   the paths'  d2(P, Q) / 2                          from it the time to 2 %, as 1 / error^2
#   the gather's  (d2(G, P) + d2(G, Q) - d2(P, Q)) / 2      without the paths' noise, bias included
# Times are processor seconds of the whole program; of paths what the first sample takes (reading
# too) is not multiplied. The gather's time to 2 % is the time it took, where its error is below
# 2 %; else that times (error / 2 %)^2, which is marked with a star: noise would go away so, bias
# would not. A gather's error of 0.00 % means that the paths' noise drowns it.
set -u
ISOLUX=${1:?names the program}
SIZE=${2:-320x180} SAMPLES=${3:-64} GATHER=${GATHER:---quality medium}
shift $(($# < 3 ? $# : 3))
ROOT=$(cd "$(dirname "$0")/../.." && pwd)
HALL=$ROOT/scenes/third-party/modern-hall/staircase2.obj
[ $# -gt 0 ] || set -- "$HALL" "$ROOT/scenes/third-party/veach-ajar/veach-ajar.obj"
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT
TIMEFORMAT=%U

picture() { # NAME OPTION...: its processor seconds
    local name=$1
    shift
    { time nice "$ISOLUX" render "$scene" --size "$SIZE" "$@" --progress none \
        -o "$DIR/$name.exr" >/dev/null 2>"$DIR/err"; } 2>&1
}
square() { # REFERENCE PICTURE: mean squared difference over the reference's mean
    "$ISOLUX" compare "$DIR/$1.exr" "$DIR/$2.exr" 2>&1 | awk '$1 == "all" { print $2 * $2 }'
}

printf '%-16s %9s %9s %10s %9s %9s %8s\n' \
    scene path-err path-s 'path-2%-s' gather-err gather-s sooner
for scene; do
    one=$(picture o --renderer path --spp 1)
    p=$(picture p --renderer path --spp "$SAMPLES" --seed 11)
    q=$(picture q --renderer path --spp "$SAMPLES" --seed 12)
    g=$(picture g $GATHER)
    pq=$(square p q) gp=$(square p g) gq=$(square q g)
    awk -v s="$(basename "$(dirname "$scene")")" -v one="$one" -v p="$p" -v q="$q" -v g="$g" \
        -v pq="$pq" -v gp="$gp" -v gq="$gq" 'BEGIN {
        path = sqrt(pq / 2); mine = (gp + gq - pq) / 2; mine = mine > 0 ? sqrt(mine) : 0
        t = (p + q) / 2; to2 = one + (t - one) * pq / 2 / 4
        mark = ""; need = g
        if (mine > 2) { need = g * mine * mine / 4; mark = "*" }
        printf "%-16s %8.2f%% %9.1f %10.1f %8.2f%% %9.1f %7.1f%s\n", s, path, t, to2, mine, g,
            to2 / need, mark }'
done

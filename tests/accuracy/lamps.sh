#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# What many lamps cost: a room with boxes under 10 and under 10,000 small square lamps of the same
# power in all. Each is rendered with more and more samples; errors are those of luminance against
# paths, costs are seconds of all processors. Cost times error squared does not depend on how many
# samples are taken, so its ratio is the ratio of costs at equal error. Ends with 1 above 3. Run by
# hand; takes minutes.
#
#   tests/accuracy/lamps.sh [PATHS [SIZE]]
#     PATHS  samples per pixel of the references (4096)
#     SIZE   pixels (128x80)
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux}
paths=${1:-4096}
size=${2:-128x80} over=0
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# COLUMNS ROWS FILE: an OBJ of a room 8 x 5 x 3 with that many lamps 2 cm below its ceiling, of
# 0.4 m2 in all
scene() {
    printf 'newmtl wall\nKd 0.6 0.6 0.6\nnewmtl lamp\nKd 0 0 0\nKe 20 20 20\n' >"$dir/lamps.mtl"
    awk -v columns="$1" -v rows="$2" '
    function quad(a, b, c, d) { print "v " a "\nv " b "\nv " c "\nv " d "\nf -4 -3 -2 -1" }
    function box(x0, y0, z0, x1, y1, z1) {
        quad(x0 " " y0 " " z1, x1 " " y0 " " z1, x1 " " y1 " " z1, x0 " " y1 " " z1)
        quad(x0 " " y0 " " z0, x1 " " y0 " " z0, x1 " " y0 " " z1, x0 " " y0 " " z1)
        quad(x1 " " y0 " " z0, x1 " " y1 " " z0, x1 " " y1 " " z1, x1 " " y0 " " z1)
        quad(x1 " " y1 " " z0, x0 " " y1 " " z0, x0 " " y1 " " z1, x1 " " y1 " " z1)
        quad(x0 " " y1 " " z0, x0 " " y0 " " z0, x0 " " y0 " " z1, x0 " " y1 " " z1)
    }
    BEGIN {
        print "mtllib lamps.mtl\nusemtl wall"
        quad("0 0 0", "8 0 0", "8 5 0", "0 5 0")
        quad("0 0 3", "0 5 3", "8 5 3", "8 0 3")
        quad("0 0 0", "0 0 3", "8 0 3", "8 0 0")
        quad("0 5 0", "8 5 0", "8 5 3", "0 5 3")
        quad("0 0 0", "0 5 0", "0 5 3", "0 0 3")
        quad("8 0 0", "8 0 3", "8 5 3", "8 5 0")
        box(2, 1.5, 0, 3, 2.5, 1)
        box(4.5, 3, 0, 5.5, 4, 2)
        box(5.5, 1, 0, 6.5, 1.6, 0.6)
        print "usemtl lamp"
        half = sqrt(0.4 / (rows * columns)) / 2
        for (i = 0; i < columns; i++)
            for (k = 0; k < rows; k++) {
                x = 8 * (i + 0.5) / columns
                y = 5 * (k + 0.5) / rows
                quad(x - half " " y - half " 2.98", x - half " " y + half " 2.98",
                     x + half " " y + half " 2.98", x + half " " y - half " 2.98")
            }
    }' >"$3"
}
# SCENE OUT OPTIONS: prints the seconds of all processors
render() {
    local TIMEFORMAT='%U' log=$dir/log
    { time "$isolux" render "$1" --eye 0.3,0.3,2.7 --target 5,3.5,0 --up 0,0,1 --fov 45 \
        --size "$size" -o "$2" --progress none "${@:3}" >"$log" 2>&1; } 2>&1
}
# REFERENCE PICTURE: relative RMSE of luminance, per cent
error() { "$isolux" compare "$1" "$2" 2>&1 | awk '$1 == "all" { print $2 + 0 }'; }

scene 5 2 "$dir/10.obj"
scene 125 80 "$dir/10000.obj"
for n in 10 10000; do
    seconds=$(render "$dir/$n.obj" "$dir/ref$n.exr" --renderer path --diffuse --spp "$paths")
    echo "$n lamps: reference of $paths paths per pixel, $seconds CPU s"
done
declare -A cost
for way in "path 64" "path 256" "gather 16" "gather 64"; do
    read -r renderer spp <<<"$way"
    for n in 10 10000; do
        # What one more sample costs: reading, meshing and solving are not of a pixel.
        few=$(render "$dir/$n.obj" "$dir/a.exr" --renderer "$renderer" --diffuse --spp 1)
        all=$(render "$dir/$n.obj" "$dir/a.exr" --renderer "$renderer" --diffuse --spp "$spp")
        e=$(error "$dir/ref$n.exr" "$dir/a.exr")
        cost[$n]=$(awk -v a="$all" -v b="$few" -v e="$e" 'BEGIN { print (a - b) * e * e }')
        echo "$renderer, $spp samples, $n lamps: $few s for 1, $all s; error $e %"
    done
    awk -v a="${cost[10]}" -v b="${cost[10000]}" -v name="$renderer, $spp samples" 'BEGIN {
        printf "%s: 10,000 lamps cost %.2f times as much at equal error: %s\n", name, b / a,
               b <= 3 * a ? "ok" : "OVER 3"
        exit b > 3 * a }' || over=1
done
exit $over

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A room lit by way of a mirror and one lit through a window, against path tracing: relative RMSE of
# luminance without the paths' own noise, and how far the means are apart.
#
#   mirrors.sh [PROGRAM [SIZE [SPP]]]
#
# Paths seldom find a lamp by way of a mirror. A room before a flat mirror looks just like that room
# and its image behind a filter of the mirror's colour, and there paths aim at all lamps: these are
# the reference of mirror-room.msd. With two independent path pictures p and q, a picture g of error
# e has (|g-p|^2 + |g-q|^2 - |p-q|^2) / 2 = e^2 in the mean, whatever the noise of p and q.
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${1:-build/isolux} size=${2:-160x120} spp=${3:-1024}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

unfold() { # the mirror room's image, x negated and faces turned round; the mirror as a filter
    awk '{ if ($0 ~ /^SURFACE 3 /)
               $0 = "SURFACE 3 0 ; (0, 0, 0) 0 ; (0, 0, 0) 0, 1 ; (0.9, 0.9, 0.9) 1"
           print }
        /QUADRANGLE 3/ { next }
        /QUADRANGLE/ {
            match($0, /QUADRANGLE [0-9]+/)
            face = substr($0, RSTART, RLENGTH); rest = substr($0, RSTART + RLENGTH); n = 0
            while (match(rest, /\([^)]*\)/)) {
                corner[++n] = substr(rest, RSTART + 1, RLENGTH - 2)
                rest = substr(rest, RSTART + RLENGTH)
            }
            for (i = n; i > 0; i--) {
                split(corner[i], x, ",")
                face = face " (" (-x[1]) "," x[2] "," x[3] ")"
            }
            images = images face "\n"
        }
        /BOX/ { images = images "BOX 5 (-2.23, 1.2, 0.8) <0.03, 0.8, 0.8>\n" }
        END { printf "BEGIN GROUP \"image\"\n%sEND\n", images }' "$1"
}
number() { # WORD REFERENCE PICTURE
    "$isolux" compare "$2" "$3" 2>&1 | awk -v word="$1" '$1 == word { print $2 + 0 }'
}

printf '%-18s %8s %8s\n' scene error mean
for name in mirror-room window-room; do
    scene=scenes/files/$name.msd paths=$scene
    if [ $name = mirror-room ]; then
        paths=$dir/unfolded.msd
        unfold "$scene" >"$paths"
    fi
    for seed in 1 2; do
        "$isolux" render "$paths" --renderer path --spp "$spp" --size "$size" --seed $seed \
            --progress none -o "$dir/$seed.exr" || exit 1
    done
    "$isolux" render "$scene" --size "$size" --progress none -o "$dir/g.exr" || exit 1
    awk -v n=$name -v p="$(number all "$dir/1.exr" "$dir/g.exr")" \
        -v q="$(number all "$dir/2.exr" "$dir/g.exr")" \
        -v d="$(number all "$dir/1.exr" "$dir/2.exr")" \
        -v b="$(number bias "$dir/1.exr" "$dir/g.exr")" \
        -v c="$(number bias "$dir/2.exr" "$dir/g.exr")" 'BEGIN {
            e = (p * p + q * q - d * d) / 2
            printf "%-18s %7.2f%% %+7.2f%%\n", n, (e > 0 ? sqrt(e) : 0), (b + c) / 2 }'
done

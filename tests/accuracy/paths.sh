#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The gather against the path tracer: mean luminance of both and how far they are apart, per scene.
#
#   paths.sh [SCENE...]     ISOLUX: the program; SIZE, SPP: of the paths' picture
#
# The last column is the paths' own standard error of the mean, if pixels err independently.
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux} size=${SIZE:-48x36} spp=${SPP:-1024}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
[ $# -gt 0 ] || set -- scenes/files/{cornell,two-rooms,table,two-lights,mirror-room,window-room}.msd
pixels=$((${size%x*} * ${size#*x}))
mean() { # REFERENCE OTHER: mean luminance of the reference, lamps and all
    "$isolux" compare "$1" "$2" --lamp 1e9 2>&1 | sed -n 's/.*mean luminance //p'
}
printf '%-24s %12s %12s %10s %10s\n' scene paths gather apart error
for scene; do
    "$isolux" render "$scene" --renderer path --spp "$spp" --size "$size" -o "$dir/p.exr" \
        --progress none --json "$dir/p.json" || exit 1
    "$isolux" render "$scene" --size "$size" -o "$dir/g.exr" --progress none || exit 1
    error=$(sed -n 's/.*"standard_error": \([0-9.e+-]*\).*/\1/p' "$dir/p.json")
    awk -v s="$(basename "$scene")" -v p="$(mean "$dir/p.exr" "$dir/g.exr")" \
        -v g="$(mean "$dir/g.exr" "$dir/p.exr")" -v e="$error" -v n="$pixels" 'BEGIN {
        printf "%-24s %12.6g %12.6g %9.2f%% %9.2f%%\n", s, p, g, 100 * (g - p) / p, 100 * e / sqrt(n) }'
done

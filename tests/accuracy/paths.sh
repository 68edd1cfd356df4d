#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The gather against the path tracer: how far the mean luminance of its pictures is from that of
# paths.
#
#   paths.sh [SCENE...]
#     SCENE    a file, and behind it the options for it in one word: 'room.glb --light ceiling';
#              default: the project's own scenes, and those of FOLDER
#     ISOLUX   the program;  FOLDER: more scenes (wooden-staircase/staircase.obj ...), if there
#     SIZE, SPP, PICTURES   of the paths: pixels, paths per pixel, pictures of other seeds (>= 2)
#     GATHER   options of the gather (default: --quality medium)
#
# apart: mean of the gather over that of all paths, less 1; error: the standard error of that, from
# what the paths' pictures differ by among each other. The same pixels count in all: those that the
# gather does not show black. Lamps count: they are the same in both.
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux} size=${SIZE:-96x72} spp=${SPP:-256} pictures=${PICTURES:-4}
folder=${FOLDER:-}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

own=(scenes/files/{cornell,two-rooms,table,two-lights,moving,shapes,mirror-room}.msd
    scenes/files/window-room.msd
    scenes/third-party/cornell-bitterli/cornell-box.obj
    scenes/third-party/cornell-mcguire/CornellBox-{Original,Empty-CO,Sphere,Water}.obj
    scenes/third-party/cornell-mitsuba/cornell-mitsuba.msd
    'scenes/third-party/godot-living-room/living_room.glb --light ceiling'
    'scenes/third-party/ignis-room/Room.obj --light ceiling'
    'scenes/third-party/modern-hall/staircase2.obj --diffuse'
    'scenes/third-party/veach-ajar/veach-ajar.obj --diffuse')
more=('wooden-staircase/staircase.obj --diffuse' 'cornell-tinyobj/cornell_box.obj --light ceiling'
    'kitchen-lux/kitchen.obj --light ceiling --diffuse'
    'japanese-classroom/japanese-classroom.glb --light ceiling --diffuse'
    'librequake-e3m4/e3m4.obj --light ceiling --diffuse')
if [ $# -eq 0 ]; then
    set -- "${own[@]}"
    for scene in "${more[@]}"; do
        [ -e "$folder/${scene%% *}" ] && set -- "$@" "$folder/$scene"
    done
fi

picture() { # NAME OPTION...: of the scene; one that is more than a stated tolerance off is one too
    "$isolux" render "$file" "${options[@]}" --size "$size" --progress none -o "$dir/$1.exr" \
        "${@:2}" >"$dir/log" 2>&1
    [ $? = 0 ] || [ $? = 4 ] || { tail -n 1 "$dir/log" >&2; return 1; }
}
bias() { # PICTURE: per cent by which its mean is over the gather's
    "$isolux" compare "$dir/g.exr" "$dir/$1.exr" --lamp 1e9 2>&1 |
        awk '$1 == "bias" { print $2 + 0 }'
}

printf '%-44s %9s %9s\n' scene apart error
for scene; do
    read -r file rest <<<"$scene"
    read -ra options <<<"$rest"
    picture g ${GATHER:---quality medium} || continue
    for ((k = 1; k <= pictures; k++)); do
        picture p --renderer path --spp "$spp" --seed $((100 + k)) || continue 2
        bias p
    done | awk -v s="$(basename "$file") $rest" '
        { x = -100 * $1 / (100 + $1); sum += x; squares += x * x }
        END {
            mean = sum / NR; v = (squares - NR * mean * mean) / (NR - 1)
            printf "%-44s %+8.2f%% %8.2f%%\n", s, mean, sqrt((v > 0 ? v : 0) / NR) }'
done

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Another lamp, another paint: seconds and processor seconds from the change to the new solution, in
# the Cornell box with that many patches, and how far the result is from one solved to 1e-9 by
# another solver. The links are cast once.
#
#   tests/accuracy/relight.sh PROGRAM [PATCHES [RUNS]]     100,000 patches; takes some minutes
set -u
ISOLUX=${1:?names the program} PATCHES=${2:-100000} RUNS=${3:-5}
SCENE=$(cd "$(dirname "$0")/../../scenes/files" && pwd)/cornell.msd
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT
some=(solve "$SCENE" --no-adapt --patches "$PATCHES" --rays 256 --factors "$DIR/links"
      --progress none)

number() {
    sed -nE "s/^ *\"$1\": ([-+.0-9e]+).*/\1/p" "$2" | tail -n "${3:-1}" | head -n 1
}

"$ISOLUX" "${some[@]}" --tolerance 1e-4 --json "$DIR/a.json" || exit 1
printf '%s patches, %s links\n' "$(number patches "$DIR/a.json")" \
    "$(number nonzeros "$DIR/a.json" 2)"
printf '%-42s %8s %8s %8s %10s %10s %9s\n' change passes seconds CPU-s residual bound error
change() {
    local name=$1 best=9999 cpu=9999 groups=()
    shift
    [ "$1" = --light-groups ] && groups=("$1") && shift
    for ((k = 0; k < RUNS; k++)); do
        "$ISOLUX" "${some[@]}" --tolerance 1e-4 "${groups[@]}" "$@" --json "$DIR/a.json" \
            -o "$DIR/a.ply" || exit 1
        awk '/"relight"/ { on = 1 } on && /seconds"/ { gsub(/[",:]/, " "); print $1, $2 }
             on && /}/ { exit }' "$DIR/a.json" >"$DIR/times"
        best=$(awk -v b="$best" '$1 == "seconds" { print ($2 < b ? $2 : b) }' "$DIR/times")
        cpu=$(awk -v b="$cpu" '$1 == "cpu_seconds" { print ($2 < b ? $2 : b) }' "$DIR/times")
    done
    "$ISOLUX" "${some[@]}" --tolerance 1e-9 --solver gmres "$@" -o "$DIR/b.ply" || exit 1
    printf '%-42s %8s %8.4f %8.4f %10.2e %10.2e %9s\n' "$name" \
        "$(awk '/"relight"/ { on = 1 } on && /iterations/ { gsub(/[",:]/, " "); print $2; exit }' \
           "$DIR/a.json")" "$best" "$cpu" "$(number residual "$DIR/a.json")" \
        "$(number error_bound "$DIR/a.json")" \
        "$("$ISOLUX" compare "$DIR/b.ply" "$DIR/a.ply" 2>&1 | awk '$1 == "error" { print $2 "%" }')"
}
change 'a lamp dimmed, from light groups' --light-groups --set 'lamp.emission=*0.5'
change 'the floor painted' --set floor.reflectance=0.3
change 'the back wall painted red' --set back.reflectance=0.7,0.1,0.1
change 'all white walls darker' --set 'floor.reflectance=*0.8' --set 'ceiling.reflectance=*0.8' \
    --set 'back.reflectance=*0.8'

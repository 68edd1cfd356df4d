#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the pictures of docs/viewer.md anew: scripted windows on a screen of their own (Xvfb).
#   ISOLUX=build/isolux tools/viewer_pictures.sh [FOLDER]      (default: docs/images)
set -eu
isolux=$(realpath "${ISOLUX:-build/isolux}")
root=$(realpath "$(dirname "$0")/..")
out=$(realpath "${1:-$root/docs/images}")
scenes=$root/scenes/files
work=$(mktemp -d)
Xvfb -displayfd 3 -screen 0 1100x800x24 -nolisten tcp 3>"$work/display" 2>/dev/null &
screen=$!
trap 'kill "$screen" 2>/dev/null; rm -rf "$work"' EXIT
for ((i = 0; i < 300; i++)); do
    [ -s "$work/display" ] && break
    sleep 0.1
done
DISPLAY=:$(cat "$work/display")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1
cd "$work"

# window SCENE OPTIONS... <SCRIPT, whose screenshots are called NAME.png
window() {
    cat >script.txt
    "$isolux" view "$@" --progress none --script script.txt
    mv -- viewer-*.png "$out/"
}

window "$scenes/cornell.msd" --patches 12000 --size 720x480 <<END
wait seconds 0.5
screenshot viewer-light-1.png
wait seconds 2
screenshot viewer-light-2.png
wait seconds 10
screenshot viewer-light-3.png
END
window "$scenes/cornell.msd" --patches 3000 --no-adapt <<END
key Space
key .
wait lit
key .
wait frames 5
key .
wait frames 5
key .
wait frames 5
screenshot viewer-shot.png
END
window "$scenes/cornell.msd" --patches 600 --size 600x600 --no-panels <<END
wait solved
key M
wait frames 2
screenshot viewer-mesh.png
END
window "$scenes/cornell.msd" --patches 3000 --no-adapt <<END
wait solved
wait settled
click left 560 650
key C
key Shift-C
key G
wait frames 2
screenshot viewer-false.png
click left 640 306
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key P
wait frames 2
screenshot viewer-factors.png
END
window "$scenes/cornell.msd" --patches 3000 --no-adapt --gather-rays 4 --spp 16 <<END
wait solved
key R
wait tiles 0.5
screenshot viewer-gather.png
END
window "$scenes/two-lights.msd" --patches 3000 --no-adapt <<END
wait solved
key U
wait frames 3
drag left 801 68 790 68
click left 746 68
wait frames 3
click left 860 220
wait settled
wait frames 2
screenshot viewer-change.png
END
window "$scenes/table.msd" --patches 4000 --no-adapt <<END
wait solved
click Shift-left 420 420
click Shift-left 620 500
key C
key Shift-C
key K
wait frames 60
key X
drag left 540 200 700 300
wait frames 20
screenshot viewer-plane.png
END
ls -l "$out"/viewer-*.png

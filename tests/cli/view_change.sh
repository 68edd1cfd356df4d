#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Lamps and paint changed in the window, by its sliders: light, pictures and files against scenes
# that are changed by --changes.
. "$(dirname "$0")/tap.inc"
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
. "$(dirname "$0")/screen.inc"
cd "$DIR" || exit 1

# A room with a lamp, a spot, and two paints.
cat >room.msd <<FILE
SCREEN <400, 300> EYEP (2, 0.1, 1.4) LOOKP (2, 4, 1.2) UP (0, 0, 1) FOV <70>
ATT_POS_LIGHT (20, 18, 12) (1.2, 1.4, 2.2)
SURFACE 1 0 ; (0.7, 0.7, 0.6) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.3, 0.5, 0.2) 1 ; (0, 0, 0) 0, 1
SURFACE 3 0 ; (0.5, 0.5, 0.5) 1 ; (0, 0, 0) 0, 1 EMISSIVE (9, 8, 7)
BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (4,0,0) (4,4,0) (0,4,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,3) (0,4,3) (4,4,3) (4,0,3) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,4,0) (0,4,3) (0,0,3)
    QUADRANGLE 1 (4,0,0) (4,0,3) (4,4,3) (4,4,0)
    QUADRANGLE 1 (0,0,0) (0,0,3) (4,0,3) (4,0,0)
    QUADRANGLE 1 (0,4,0) (4,4,0) (4,4,3) (0,4,3)
END
BEGIN GROUP "lamp"    QUADRANGLE 3 (1.5,1.5,2.9) (1.5,2.5,2.9) (2.5,2.5,2.9) (2.5,1.5,2.9) END
BEGIN GROUP "stripe"  QUADRANGLE 3 (0.2,0.4,2.5) (0.2,0.8,2.5) (3.8,0.8,2.5) (3.8,0.4,2.5) END
FILE

solving=(--patches 800 --rays 64 --no-adapt --tolerance 1e-6 --threads 2 --progress none)
gathering=(--spp 1 --gather-rays 8)
size=(--size 640x300)

# The panel's rows: two lamps, a light, then three paints; one lamp is dimmed, the other off, the
# light is brighter, the floor darker and what is on the screen as well.
cat >change.txt <<FILE
wait solved
key U
wait frames 5
drag left 417 68 400 68
drag left 417 92 340 92
drag left 417 116 460 116
drag left 455 187 420 187
wait settled
screenshot panel.png
key Shift-S
wait said saved room-view
click left 498 235
wait said which --changes reads
key R
wait picture
wait frames 2
key Shift-S
wait frames 4
FILE
ok "lamps and paint are changed" exits 0 view room.msd "${solving[@]}" "${gathering[@]}" \
    "${size[@]}" --script change.txt
ok "and saved" test -s room-changes.json
saved_all() {
    grep -q '"stripe"' room-changes.json && grep -q '"lamp"' room-changes.json &&
        grep -q '"light-1"' room-changes.json && grep -q '"surface-2"' room-changes.json &&
        [ "$(grep -c '"emission": "\*' room-changes.json)" = 3 ]
}
ok "all of it" saved_all

# below WORD VALUE REFERENCE PICTURE: what compare calls so, in per cent.
below() {
    run compare "$3" "$4"
    awk -v word="$1" -v most="$2" '
        $1 == word { v = $2 + 0; n = 1 }
        END { print "# " word " " v; exit !(n && v <= most && v >= -most) }' "$DIR/err"
}
ok "solved with the file" exits 0 solve room.msd "${solving[@]}" --changes room-changes.json \
    -o changed.ply
printf 'wait solved\nwait frames 2\nkey Shift-S\nwait frames 2\n' >look.txt
ok "and looked at" exits 0 view changed.ply --progress none "${size[@]}" --script look.txt
ok "it is what the window showed" below all 0.1 changed-view.exr room-view.exr
ok "rendered with the file" exits 0 render room.msd "${solving[@]}" "${gathering[@]}" "${size[@]}" \
    --changes room-changes.json -o changed.exr
ok "it is what was gathered" below all 0.1 changed.exr room-view-2.exr

# --- refused, and by another solver ---------------------------------------------------------------

cat >refuse.txt <<FILE
wait lit
key U
wait frames 2
click left 498 255
wait said not solved for yet
wait solved
click left 498 235
wait said nothing was changed
FILE
ok "too early, and nothing to save" exits 0 view room.msd "${solving[@]}" "${size[@]}" \
    --script refuse.txt
# On a full disk, where no file can grow.
no_room() {
    sed -n '1,4p' change.txt >full.txt
    printf 'wait settled\nclick left 498 235\nwait said cannot be written\n' >>full.txt
    mkdir full && cd full && (trap '' XFSZ && ulimit -f 0 && exec "$ISOLUX" view ../room.msd \
        --patches 60 --rays 32 --no-adapt --threads 2 --progress none "${size[@]}" \
        --script ../full.txt 2>/dev/null)
    local code=$?
    cd "$DIR" && [ "$code" = 0 ] && [ -z "$(ls -A full)" ]
}
ok "a file that has no room is not left behind" no_room
# The same by a solver without links, which solves anew: rays give noise.
sed '/^click/,$d' change.txt >rays.txt
ok "solved for by rays again" exits 0 view room.msd --patches 800 --solver stochastic \
    --tolerance 0.002 --threads 2 --progress none "${size[@]}" --script rays.txt
ok "it is the same light" below bias 1 changed-view.exr room-view-3.exr

# --- the tolerance --------------------------------------------------------------------------------

# finer KEY MOST PATCHES SOLVER WORDS...: begins at 0.1; what the slider asks for then is reached.
printf 'wait solved\nwait settled\nwait frames 3\ndrag left 168 225 96 225\nwait settled\n' >finer.txt
finer() {
    local key=$1 most=$2
    run view room.msd --patches "$3" --threads 2 --progress none "${size[@]}" --script finer.txt \
        --tolerance 0.1 --json finer.json --solver "${@:4}" &&
        awk -v key="\"$key\":" -v most="$most" '
            $1 == key { v = $2 + 0; n = 1 }
            END { print "# " key " " v; exit !(n && v <= most) }' finer.json
}
ok "a finer tolerance, with links" finer residual 1e-4 60 gauss-seidel --rays 32 --no-adapt
ok "by rays alone" finer estimated_error 0.03 300 stochastic
ok "between clusters" finer estimated_error 0.03 60 hierarchical
finish

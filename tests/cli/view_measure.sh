#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measuring in the window: probes and the work plane as files, false colours as pictures.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
. "$(dirname "$0")/screen.inc"
cd "$DIR" || exit 1

# Ten metres wide, so that the standard's grid has about one point a metre.
cube=(cube.obj --unit-m 10 --patches 400 --rays 64 --no-adapt --threads 2 --progress none)

cat >all.txt <<END
wait solved
wait settled
key Tab
wait frames 2
screenshot plain.png
click left 160 60
click Shift-left 160 200
click Shift-left 60 120
key C
wait frames 2
screenshot false.png
key G
wait frames 2
screenshot log.png
key I
wait frames 2
screenshot bare.png
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key Shift-C
key P
wait frames 2
key C
key K
key X
drag left 100 60 200 180
drag left 160 120 170 125
wait frames 60
screenshot plane.png
key Ctrl-S
wait frames 2
END
ok "a script that measures" exits 0 view "${cube[@]}" --size 320x240 --script all.txt
for name in plain false log bare plane; do
    ok "picture $name" test -s "$name.png"
done
ok "false colours are others" eval '! cmp -s plain.png false.png'
ok "so are logarithmic ones" eval '! cmp -s false.png log.png'
ok "and those without isolines" eval '! cmp -s log.png bare.png'

# --- probes ---------------------------------------------------------------------------------------

# A closed room: rows of form factors sum to 1; luminance is radiosity over pi. The error of what
# is solved for is estimated, less than the light itself.
probes_are_right() {
    awk -F, '
        NR == 1 { if ($11 != "lux" || $16 != "row_sum" || NF != 16) exit 1; next }
        { n++
          if ($8 !~ /^"/ || $9 !~ /^"/) exit 1
          if ($12 == "" || $12 < 0 || $12 >= $11) exit 1
          if ($16 < 0.999 || $16 > 1.001 || $11 <= 0) exit 1
          d = $15 * 3.14159265 - $13
          if (d * d > 1e-10 * $13 * $13) exit 1 }
        END { exit n != 2 }' cube-probes.csv
}
ok "two probes" probes_are_right || cat cube-probes.csv

# --- the work plane -------------------------------------------------------------------------------

# 0.2 * 5^(log10 9) = 0.93 m between points over 9 m: 10 x 10, less those in the plate.
plane_has_points() {
    local n
    n=$(($(wc -l <cube-plane.csv) - 1))
    [ "$n" -gt 80 ] && [ "$n" -le 100 ] && head -n 1 cube-plane.csv | grep -qx 'x,y,z,lux'
}
ok "points of the standard's grid" plane_has_points

# The same places by the program's own measuring, which knows neither the window nor its patches'
# triangles: the means agree within what the coarse patches are worth.
up=$(awk -F, 'NR == 2 { x = $1; y = $2; z = $3; next } NR > 2 { if ($1 != x) a = 1; if ($2 != y)
    b = 1; if ($3 != z) c = 1 } END { print !a ? "1,0,0" : !b ? "0,1,0" : "0,0,1" }' cube-plane.csv)
awk -F, -v up="$up" 'NR > 1 { print $1 "," $2 "," $3 "," up }' cube-plane.csv >points.txt
ok "measured" exits 0 measure "${cube[@]}" --points points.txt --gather-rays 1024 -o measured.csv
means_agree() {
    awk -F, -v OFS=, 'FNR == 1 { next } FILENAME == "cube-plane.csv" { a += $4; n++; next }
        { b += $10; m++ } END { print "# means " a / n " " b / m
        exit !(n == m && a > 0.95 * b && a < 1.05 * b) }' cube-plane.csv measured.csv
}
ok "means of both agree" means_agree

# --- a full disk ----------------------------------------------------------------------------------

# no_room: as on one, no file can grow; what is not whole is not left behind.
no_room() {
    mkdir -p full && cp cube.obj full && cd full &&
        (trap '' XFSZ && ulimit -f 0 && exec "$ISOLUX" view "${cube[@]}" --size 320x240 \
            --script ../full.txt 2>/dev/null)
    local code=$?
    cd "$DIR" && [ "$code" = 0 ] && [ "$(ls -A full)" = cube.obj ]
}
printf 'wait solved\nclick Shift-left 160 200\n%s\nkey Ctrl-S\nwait said cannot be written\n' \
    'key K' >full.txt
ok "points and probes need room" no_room
printf 'wait solved\nkey Shift-S\nwait said cannot be written\n' >full.txt
ok "and pictures" no_room

# --- nothing to measure ---------------------------------------------------------------------------

printf 'wait solved\nkey Ctrl-S\nkey K\nwait frames 3\nkey X\ndrag left 5 5 5 5\nkey Esc\n' >none.txt
ok "a margin wider than the room" exits 0 view "${cube[@]:0:1}" "${cube[@]:3}" --size 320x240 \
    --script none.txt
ok "no file of it" test ! -e cube-plane-2.csv
finish

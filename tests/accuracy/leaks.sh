#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How much light gets out of a closed box with a lamp in it, and into a dark room beside a bright
# one, with flat walls and with curved ones: none, whatever the thickness of the walls and the size
# of the patches.
# tests/accuracy/leaks.sh PROGRAM [quick]
set -u
ISOLUX=${1:?names the program}
THICK="0.001 0.005 0.02 0.1" SIZES="1 0.5 0.25 0.1 0.05"
[ "${2:-}" = quick ] && { THICK="0.001 0.1" SIZES="1 0.25"; }
FILES=$(cd "$(dirname "$0")/../../scenes/files" && pwd)
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT
LEAKS=0

# Points on the floor outside the box (1.1 m x 0.9 m about it are left out) and on the walls.
awk 'BEGIN { c = cos(17.3 * atan2(0, -1) / 180); s = sin(17.3 * atan2(0, -1) / 180)
    for (x = 0.05; x < 4; x += 0.1) for (y = 0.05; y < 3; y += 0.1) {
        a = c * (x - 2.03) + s * (y - 1.57); b = c * (y - 1.57) - s * (x - 2.03)
        if (a * a > 0.5025 * 0.5025 || b * b > 0.4025 * 0.4025) print x "," y ",0,0,0,1"
        print x "," y ",2.5,0,0,-1" }
    for (k = 0; k < 100; k++) { a = 0.5025; b = -0.4 + 0.008 * k
        print 2.03 + c * a - s * b "," 1.57 + s * a + c * b ",0,0,0,1" } }' >"$DIR/box.csv"
# Points in the dark room: floor, ceiling, its side of the wall, the board.
awk 'BEGIN { for (x = 2.02; x < 4; x += 0.06) for (y = 0.05; y < 3; y += 0.1) {
        print x "," y ",0,0,0,1"; print x "," y ",2.5,0,0,-1" }
    for (y = 0.05; y < 3; y += 0.1) for (z = 0.05; z < 2.5; z += 0.1) print "2," y "," z ",1,0,0"
    for (x = 2.02; x < 2.6; x += 0.06) print x ",1.5,0.74,0,0,1" }' >"$DIR/rooms.csv"

# Points in the dark room of curved things: floor and ceiling, walls, and close to all of these.
awk 'function ring(x, y, r, z, n,  k, t) { for (k = 0; k < n; k++) { t = 2 * PI * k / n
        printf "%.9g,%.9g,%.9g,0,0,1\n", x + r * cos(t), y + r * sin(t), z } }
    function coat(x, y, r, z, n,  k, t) { for (k = 0; k < n; k++) { t = 2 * PI * k / n
        printf "%.9g,%.9g,%.9g,%.9g,%.9g,0\n", x + r * cos(t), y + r * sin(t), z, cos(t), sin(t) } }
    function off(x, y, a, b, r) { return (x - a) ^ 2 + (y - b) ^ 2 > r * r }
    BEGIN { PI = atan2(0, -1)
    for (x = 0.07; x < 4; x += 0.13) for (y = 0.05; y < 3; y += 0.13) {
        if (off(x, y, 2.73, 2.17, 0.44) && off(x, y, 1.1, 0.7, 0.66)) print x "," y ",0,0,0,1"
        print x "," y ",2.5,0,0,-1" }
    for (y = 0.05; y < 3; y += 0.1) for (z = 0.05; z < 2.5; z += 0.1)
        if (off(y, z, 1.4, 1.2, 0.51) && off(y, z, 2.44, 0.52, 0.21)) print "0," y "," z ",1,0,0"
    for (k = 0; k < 60; k++) { t = PI * k / 30
        print "0," 1.4 + 0.5 * cos(t) "," 1.2 + 0.5 * sin(t) ",1,0,0" }
    ring(2.73, 2.17, 0.433, 0, 100); ring(1.1, 0.7, 0.645, 0, 100)
    ring(2.73, 2.17, 0.4, 0.9001, 20)
    for (z = 0.01; z < 0.9; z += 0.2) coat(2.73, 2.17, 0.4301, z, 30)
    coat(3.1, 0.8, 0.2001, 1.4, 20); coat(3.1, 0.8, 0.2001, 2.35, 20) }' >"$DIR/curved.csv"

for scene in box rooms curved; do
    printf '%s: most lux where there should be none\n%10s' "leak-$scene.msd" "wall \\ size"
    for size in $SIZES; do printf '%10s' "$size"; done
    echo
    # What is curved has no thickness.
    for t in $([ $scene = curved ] && echo 0 || echo "$THICK"); do
        printf '%10s ' "$t"
        sed "s/^FLOAT t = [0-9.]*/FLOAT t = $t/" "$FILES/leak-$scene.msd" >"$DIR/$scene.msd"
        for size in $SIZES; do
            "$ISOLUX" measure "$DIR/$scene.msd" --points "$DIR/$scene.csv" -o "$DIR/out.csv" \
                --quality draft --no-adapt --patch-size "$size" 2>"$DIR/err"
            code=$?
            if [ $code != 0 ] && [ $code != 4 ]; then
                head -n 3 "$DIR/err"
                exit 1
            fi
            most=$(awk -F, 'NR > 1 { for (i = 7; i <= 10; i++) if ($i > most) most = $i; n++ }
                END { print (n > 100 ? most + 0 : "none") }' "$DIR/out.csv")
            printf '%10s' "$most"
            [ "$most" = 0 ] || LEAKS=$((LEAKS + 1))
        done
        echo
    done
done
[ "$LEAKS" = 0 ] && echo "no leak" || { echo "$LEAKS leaks"; exit 1; }

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# How much light gets out of a closed box with a lamp in it, and into a dark room beside a bright
# one: none, whatever the thickness of the walls and the size of the patches.
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

for scene in box rooms; do
    printf '%s: most lux where there should be none\n%10s' "leak-$scene.msd" "wall \\ size"
    for size in $SIZES; do printf '%10s' "$size"; done
    echo
    for t in $THICK; do
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

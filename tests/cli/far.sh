#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A scene where a map has it, hundreds of kilometres from the origin, is as good as one there.
# Prints TAP.
source "$(dirname "$0")/tap.inc"
quiet=(--progress none)
draft=(--quality draft --patch-size 0.25 --no-adapt "${quiet[@]}")
X=500000 Y=5000000

# The box with a lamp in it, and the same a long way off.
cp scenes/files/leak-box.msd "$DIR/near.msd"
awk -v x=$X -v y=$Y '
    /^SCREEN/ { printf "SCREEN <32, 24> EYEP (%.1f, %.1f, 1.5) LOOKP (%.1f, %.1f, 0.3) ", \
                    x + 0.3, y + 0.3, x + 2, y + 1.6
                print "UP (0, 0, 1) FOV <70>"; next }
    /^BEGIN GROUP "room"/ { print "TRANS(" x ", " y ", 0)"; print "BEGIN"; inside = 1 }
    { print }
    END { print "END" }' scenes/files/leak-box.msd >"$DIR/far.msd"

# Places on the floor outside the box, which are dark, and on the lid's underside, which are not.
awk -v x=0 -v y=0 'BEGIN { for (i = 0.1; i < 1.2; i += 0.2) for (j = 0.1; j < 3; j += 0.3)
        print x + i "," y + j ",0,0,0,1"
    print x + 2.03 "," y + 1.57 ",0,0,0,1" }' >"$DIR/near.csv"
awk -F, -v x=$X -v y=$Y '{ printf "%.2f,%.2f,%s,%s,%s,%s\n", x + $1, y + $2, $3, $4, $5, $6 }' \
    "$DIR/near.csv" >"$DIR/far.csv"
for where in near far; do
    ok "$where: measured" exits 0 measure "$DIR/$where.msd" --points "$DIR/$where.csv" \
        -o "$DIR/$where.out" "${draft[@]}"
done
dark() { awk -F, 'NR > 1 && NR <= 61 && $10 != 0 { bad = 1 } END { exit bad || NR != 62 }' "$1"; }
ok "it is dark outside the box, exactly" dark "$DIR/near.out"
ok "far away too" dark "$DIR/far.out"
# Rays differ in their last bits, so values do by noise; both are of the same light.
lit() { awk -F, 'NR == 62 { print $10 }' "$1"; }
ok "under the lamp the light is the same" awk -v a="$(lit "$DIR/near.out")" \
    -v b="$(lit "$DIR/far.out")" 'BEGIN { exit !(a > 100 && b / a > 0.98 && b / a < 1.02) }'
ok "points come out as they went in" test "$(sed 1d "$DIR/far.out" | cut -d, -f1-6 |
    awk -F, '{ printf "%.2f,%.2f,%s,%s,%s,%s\n", $1, $2, $3, $4, $5, $6 }')" = \
    "$(cat "$DIR/far.csv")"

# Results stand where the scene does.
ok "solved" exits 0 solve "$DIR/far.msd" -o "$DIR/far.ply" --json "$DIR/far.json" "${draft[@]}"
ok "solved near" exits 0 solve "$DIR/near.msd" -o "$DIR/near.ply" "${draft[@]}"
ok "the mesh has doubles" grep -aq '^property double x' "$DIR/far.ply"
ok "and floats where these will do" grep -aq '^property float x' "$DIR/near.ply"
bounds() {
    tr -d ' \n' <"$1" | grep -o '"bounds":\[\[[^]]*\],\[[^]]*\]\]' | head -n 1
}
ok "bounds are the file's" test "$(bounds "$DIR/far.json")" = \
    '"bounds":[[500000.0,5000000.0,0.0],[500004.0,5000003.0,2.5]]'
ok "the mesh is read again" exits 0 check "$DIR/far.ply" --json "$DIR/again.json" "${quiet[@]}"
ok "and stands in the same place" test "$(bounds "$DIR/again.json")" = "$(bounds "$DIR/far.json")"
ok "people are told where" grep -q 'bounds  *500000,5000000,0 to 500004,5000003,2.5' "$DIR/out"
ok "a mesh is compared with itself" exits 0 compare "$DIR/far.ply" "$DIR/far.ply" \
    --json "$DIR/same.json"
ok "all of it is found" grep -q '"matched": *1.0' "$DIR/same.json"
ok "marked" exits 0 check "$DIR/far.msd" -o "$DIR/marked.ply" "${quiet[@]}"
ok "with doubles" grep -aq '^property double x' "$DIR/marked.ply"

# One's own view.
view=(--quality draft --size 16x12 --spp 4 "${quiet[@]}")
ok "seen" exits 0 render "$DIR/near.msd" --eye 0.3,0.3,1.5 --target 2,1.6,0.3 --light ceiling \
    -o "$DIR/near.exr" "${view[@]}"
ok "seen far away" exits 0 render "$DIR/far.msd" --eye 500000.3,5000000.3,1.5 \
    --target 500002,5000001.6,0.3 -o "$DIR/far.exr" "${view[@]}"

# Floats are too coarse out there.
awk -v x=$X -v y=$Y 'BEGIN { print "solid s"
    for (k = 0; k < 3; k++) { print "facet normal 0 0 1\nouter loop"
        printf "vertex %.4f %.4f %.4f\n", x + 0.123, y + 0.377, k + 0.13
        printf "vertex %.4f %.4f %.4f\n", x + 4.123, y + 0.377, k + 0.23
        printf "vertex %.4f %.4f %.4f\n", x + 4.123, y + 3.678, k + 0.33
        print "endloop\nendfacet" }
    print "endsolid s" }' >"$DIR/coarse.stl"
ok "coarse floats" exits 0 check "$DIR/coarse.stl"
ok "are warned of" test "$(grep -c 'coordinates-coarse' "$DIR/err")" = 1
finish

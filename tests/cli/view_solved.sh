#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Solutions out of files in the window: they show and measure what the window shows while it solves.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
. "$(dirname "$0")/screen.inc"
cd "$DIR" || exit 1

solving=(--patches 900 --rays 64 --no-adapt --tolerance 1e-6 --threads 2 --progress none)
window=(--size 120x90 --no-panels --progress none)
eye=(--eye 0.2,0.2,0.6 --target 0.9,0.8,0.3 --fov 70)

cat >look.txt <<END
wait solved
wait frames 2
click Shift-left 60 70
key Shift-S
key K
wait frames 40
key Ctrl-S
key F5
wait frames 3
wait solved
key [
key R
wait frames 3
END
ok "the cube as it is solved" exits 0 view cube.obj "${solving[@]}" "${window[@]:0:3}" \
    "${eye[@]}" --unit-m 10 --script look.txt
ok "its solution" exits 0 solve cube.obj "${solving[@]}" --unit-m 10 -o other.ply
ok "the same from the file" exits 0 view other.ply "${window[@]}" "${eye[@]}" --script look.txt
ok "compared" exits 0 compare cube-view.exr other-view.exr
same_light() {
    awk '$1 == "all" { v = $2; n = 1 } END { print "# " v; exit !(n && v + 0 < 0.01) }' "$DIR/err" \
        "$DIR/out"
}
ok "the views are the same" same_light
# Columns of the probe: place, patch's group and material, lux, what leaves.
same_probe() {
    awk -F, 'FNR == 1 { next }
        { if (n++ == 0) { for (k = 1; k <= 16; k++) a[k] = $k; next }
          for (k = 1; k <= 15; k++) if (k != 7 && k != 12) {
              if (k == 8 || k == 9) { if ($k != a[k]) exit 1; continue }
              d = $k - a[k]; if (d < 0) d = -d
              if (d > 1e-4 * (($k < 0 ? -$k : $k) + 0.01)) exit 1 } }
        END { exit n != 2 }' cube-probes.csv other-probes.csv
}
ok "so are probes" same_probe || cat cube-probes.csv other-probes.csv
same_plane() {
    awk -F, 'FNR == 1 { next } FILENAME ~ /cube/ { a[FNR] = $4; n++; next }
        { m++; s += a[FNR]; t += $4 } END { print "# " s / n " " t / m
          exit !(n == m && n > 20 && s > 0.99 * t && s < 1.01 * t) }' cube-plane.csv other-plane.csv
}
ok "so is the work plane" same_plane

# --- what cannot be -------------------------------------------------------------------------------

ok "nothing is solved for" fails 2 '--patches: other.ply is solved already' view other.ply \
    --patches 100
ok "no such camera" fails 2 "no camera 'door'" view other.ply --camera door
ok "one point twice" fails 2 'same point' view other.ply --eye 1,1,1 --target 1,1,1
head -c 3000 other.ply >cut.ply
ok "a file that ends early" fails 3 'cut.ply.*ends within' view cut.ply
finish

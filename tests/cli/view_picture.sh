#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Pictures out of the window: gathered ones against those of render, the view as EXR.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
. "$(dirname "$0")/screen.inc"
cd "$DIR" || exit 1

cube=(cube.obj --patches 900 --rays 64 --no-adapt --tolerance 1e-5 --threads 2 --progress none)
gathering=(--spp 16 --gather-rays 4 --size 96x64)

# below VALUE WORDS...: the number in the line of compare's report that begins so.
below() {
    awk -v most="$1" -v word="$2" '$1 == word { v = $2 + 0; if (v < 0) v = -v; n = 1 }
        END { print "# " word " " v; exit !(n && v <= most) }' "$DIR/err" "$DIR/out"
}

# --- R, S, Shift-S --------------------------------------------------------------------------------

cat >all.txt <<END
wait solved
key Shift-S
wait frames 2
key R
wait picture
wait frames 2
screenshot window.png
key S
key Shift-S
wait frames 2
END
ok "a picture is gathered" exits 0 view "${cube[@]}" "${gathering[@]}" --no-panels --script all.txt
for name in cube-view.exr cube-view.png cube-view-2.exr window.png; do
    ok "$name" test -s "$name"
done

# render makes the same picture: the same rays, but light that was solved for by itself.
ok "render" exits 0 render "${cube[@]}" "${gathering[@]}" -o ref.exr
ok "compared" exits 0 compare ref.exr cube-view-2.exr
ok "it is that of render" below 0.1 all
ok "compared with the window's patches" exits 0 compare ref.exr cube-view.exr
ok "which are as bright" below 3 bias

# --- before the end, and not at all ---------------------------------------------------------------

cat >early.txt <<END
wait lit
key R
wait picture
key Space
key R
wait picture
key Space
wait solved
END
ok "at first light, and while it is paused" exits 0 view "${cube[@]}" "${gathering[@]}" \
    --script early.txt
# Rows of links with so many rays take seconds: the picture does not wait for them.
printf 'wait shot\nkey R\nwait picture\nkey Ctrl-Q\nwait frames 2\n' >links.txt
ok "while links are cast" exits 0 view "${cube[@]:0:3}" --rays 8000 --threads 2 --no-adapt \
    --progress none "${gathering[@]}" --script links.txt --json links.json
ok "of which there are none yet" eval '! grep -q nonzeros links.json'
# gone WHAT: after that nothing is painted any more.
gone() {
    printf 'wait solved\nkey R\n%s\nwait frames 3\nwait picture\n' "$1" >gone.txt
    fails 1 'gone.txt:.*does not come' view "${cube[@]}" --size 96x64 --no-panels \
        --script gone.txt
}
ok "Esc drops it" gone 'key Esc'
ok "moving drops it" gone 'drag left 60 30 70 34'
ok "resizing drops it" gone 'resize 80 60'
ok "beginning anew drops it" gone 'key Ctrl-R'
finish

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Whatever hands may do to the window, at random: VIEW_STEPS of them (40), from VIEW_SEED (1) on.
# Ten minutes of it: VIEW_STEPS=4000 ISOLUX=build/sanitize/isolux tests/cli/view_random.sh
# With the thread sanitizer: make config=sanitize SANITIZE=thread BUILD=build/threads all, and
# TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp ignore_noninstrumented_modules=1" \
#     VIEW_STEPS=2000 ISOLUX=build/threads/isolux tests/cli/view_random.sh
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
. "$(dirname "$0")/screen.inc"
cd "$DIR" || exit 1

# steps SEED COUNT: a script.
steps() {
    awk -v seed="$1" -v count="$2" '
        function at(most) { return int(rand() * most) }
        function place() { return at(320) " " at(240) }
        BEGIN {
            srand(seed)
            n = split("Space . Ctrl-R F5 E Shift-E A T L P M N C Shift-C G I X K Ctrl-S R S " \
                      "Shift-S U Tab F1 Esc V Home F 1 Shift-1 9 Shift-9 [ ] - = W D Q", key, " ")
            m = split("left left left right middle Shift-left", button, " ")
            for (i = 0; i < count; i++) {
                what = at(24)
                if (what < 9) print "key " key[1 + at(n)]
                else if (what < 13) print "click " button[1 + at(m)] " " place()
                else if (what < 17) print "drag " button[1 + at(m)] " " place() " " place()
                else if (what == 17) print "wheel " at(9) - 4
                else if (what == 18) print "double left " place()
                else if (what == 19) print "hold " (at(2) ? "W" : "E") " " 1 + at(4)
                else if (what == 20) print "resize " at(400) " " at(300)
                else if (what == 21) print at(3) ? "scale " 1 + at(2) : "lose-context"
                else if (what == 22) print at(2) ? "minimise" : "restore"
                else print "wait frames " 1 + at(20)
            }
        }'
}

seed=${VIEW_SEED:-1}
count=${VIEW_STEPS:-40}
options=(--size 320x240 --progress none --threads 2 --spp 1 --gather-rays 4)
steps "$seed" "$count" >a.txt
ok "a scene, $count steps" exits 0 view cube.obj --patches 300 --rays 32 "${options[@]}" \
    --script a.txt
steps $((seed + 1)) "$count" >b.txt
ok "another, by rays alone" exits 0 view cube.obj --patches 300 --solver stochastic \
    --tolerance 0.05 "${options[@]}" --script b.txt
ok "a solution" exits 0 solve cube.obj --patches 300 --rays 32 --no-adapt --progress none \
    -o cube.ply
steps $((seed + 2)) "$count" >c.txt
ok "a solution looked at" exits 0 view cube.ply "${options[@]:0:6}" --script c.txt
finish

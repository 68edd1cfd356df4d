#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The window, driven by scripts on a screen of its own: the same program, frames and pictures.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
fast=(--patches 150 --rays 32 --no-adapt --threads 2)

ok "the table of keys" exits 0 view --list-bindings
ok "drags are in it" grep -q 'left drag  *orbit' "$DIR/out"
unset DISPLAY WAYLAND_DISPLAY
ok "no screen" fails 1 'no window' view "$cube" --progress none --frames 2 "${fast[@]}"

. "$(dirname "$0")/screen.inc"
small=(--size 240x180 --progress none "${fast[@]}")

ok "a missing scene is told before a window is" fails 3 'cannot' view "$DIR/none.obj" "${small[@]}"
ok "some frames" exits 0 view "$cube" --frames 3 --screenshot "$DIR/frames.png" "${small[@]}"
ok "and their picture" test -s "$DIR/frames.png"

cat >"$DIR/all.txt" <<END
# keys, mouse, panels
wait seconds 0
wait lit
screenshot $DIR/lit.png
wait solved
wait frames 2
key Tab
wait frames 2
screenshot $DIR/solved.png
click left 120 90
double left 60 90
drag left 120 90 140 80
drag right 120 90 100 95
drag middle 120 90 100 95
wheel 2
key Shift-1
key Home
key 1
key F
hold V 2
hold W 3
key Esc
key M
key P
key P
key P
key N
key L
key T
key E
key Shift-E
key A
key ]
key F1
key Tab
resize 300 200
wait frames 3
screenshot $DIR/panels.png
key Ctrl-Q
wait frames 5
END
ok "a script" exits 0 view "$cube" --script "$DIR/all.txt" "${small[@]}"
for name in lit solved panels; do
    ok "picture $name" test -s "$DIR/$name.png"
done

cat >"$DIR/steps.txt" <<END
key Space
key .
wait lit
key .
key Space
wait frames 2
key .
key .
key Ctrl-R
wait solved
END
ok "paused at once, steps, from the beginning" exits 0 view "$cube" --script "$DIR/steps.txt" "${small[@]}"

# --- a large scene is lit before its patches are known --------------------------------------------

awk 'BEGIN {
    n = 161
    print "newmtl ground\nKd 0.5 0.5 0.5\nnewmtl lamp\nKe 9 9 9" > "'"$DIR"'/hills.mtl"
    print "mtllib hills.mtl\nusemtl ground"
    for (j = 0; j < n; j++)
        for (i = 0; i < n; i++)
            printf "v %g %g %g\n", i / n, j / n, 0.03 * sin(i / 4) * cos(j / 5)
    for (j = 1; j < n; j++)
        for (i = 1; i < n; i++) {
            k = (j - 1) * n + i
            printf "f %d %d %d\nf %d %d %d\n", k, k + 1, k + n + 1, k, k + n + 1, k + n
        }
    print "usemtl lamp\nv 0.3 0.3 1\nv 0.3 0.7 1\nv 0.7 0.7 1\nv 0.7 0.3 1\nf -4 -3 -2 -1"
}' >"$DIR/hills.obj"
cat >"$DIR/hills.txt" <<END
screenshot $DIR/dark.png
wait lit
wait frames 2
screenshot $DIR/glance.png
key Ctrl-Q
wait frames 2
END
ok "51,000 triangles at a glance" exits 0 view "$DIR/hills.obj" --script "$DIR/hills.txt" \
    --no-panels "${small[@]}"
ok "there is light" test "$(stat -c %s "$DIR/glance.png")" -gt "$(stat -c %s "$DIR/dark.png")"

# --- what happens to windows ----------------------------------------------------------------------

cat >"$DIR/lost.txt" <<END
wait solved
wait frames 2
screenshot $DIR/plain.png
lose-context
screenshot $DIR/plain-2.png
key C
wait frames 2
screenshot $DIR/false.png
lose-context
lose-context
screenshot $DIR/false-2.png
key C
key R
wait picture
wait frames 2
screenshot $DIR/gathered.png
lose-context
screenshot $DIR/gathered-2.png
END
ok "a lost context" exits 0 view "$cube" --script "$DIR/lost.txt" --spp 1 --no-panels "${small[@]}"
for name in plain false gathered; do
    ok "nothing is lost with it: $name" cmp "$DIR/$name.png" "$DIR/$name-2.png"
done
ok "they are three" eval '! cmp -s "$DIR/plain.png" "$DIR/false.png" &&
    ! cmp -s "$DIR/plain.png" "$DIR/gathered.png"'
cat >"$DIR/sizes.txt" <<END
wait lit
resize 0 0
wait frames 3
scale 2
wait frames 2
resize 1 500
wait frames 2
minimise
key M
wait frames 3
resize 400 300
restore
wait solved
scale 1
wait frames 2
lose-context
wait frames 2
END
ok "sizes, scales, minimised" exits 0 view "$cube" --script "$DIR/sizes.txt" "${small[@]}"

# --- read again -----------------------------------------------------------------------------------

mkdir "$DIR/again"
make_cube "$DIR/again"
"$ISOLUX" solve "$DIR/again/cube.obj" "${fast[@]}" --progress none -o "$DIR/again/cube.ply"
# The window has come to this picture: none comes from one that has ended.
passed() { timeout 120 cat "$DIR/$1" >"$DIR/null"; }
# gone FILE: it is taken away while the window is open; later it is back.
gone() {
    local window file=$1
    shift
    cat >"$DIR/again.txt" <<END
wait solved
screenshot $DIR/solved
screenshot $DIR/gone
key F5
wait said cannot
screenshot $DIR/told
screenshot $DIR/back
key F5
wait frames 20
wait solved
END
    # Pictures into pipes: the window waits for who reads them, so that neither is too early.
    rm -f "$DIR/solved" "$DIR/gone" "$DIR/told" "$DIR/back"
    mkfifo "$DIR/solved" "$DIR/gone" "$DIR/told" "$DIR/back"
    "$ISOLUX" view "$file" --script "$DIR/again.txt" "$@" >"$DIR/out" 2>"$DIR/err" &
    window=$!
    if passed solved && mv "$file" "$DIR/away" && passed gone &&
        passed told && mv "$DIR/away" "$file" && passed back; then
        wait "$window"
        return
    fi
    kill -9 "$window" # it may wait for us
    wait "$window"
    return 1
}
ok "a scene that cannot be read again is told" gone "$DIR/again/cube.obj" "${small[@]}"
ok "and a solution" gone "$DIR/again/cube.ply" --size 240x180 --progress none

printf 'wait lit\ndance\n' >"$DIR/wrong.txt"
ok "a wrong line" fails 3 "wrong.txt:2: what is 'dance'" view "$cube" --script "$DIR/wrong.txt" \
    "${small[@]}"
# A screen that has no OpenGL.
no_opengl() {
    local code
    rm -f "$DIR/display"
    Xvfb -displayfd 3 -screen 0 200x200x24 -extension GLX -nolisten tcp 3>"$DIR/display" \
        2>/dev/null &
    local other=$!
    for ((i = 0; i < 300; i++)); do
        [ -s "$DIR/display" ] && break
        sleep 0.1
    done
    DISPLAY=:$(cat "$DIR/display") fails 1 'no window with OpenGL 3.3' view "$cube" --frames 2 \
        "${small[@]}"
    code=$?
    kill "$other"
    wait "$other" 2>/dev/null
    return "$code"
}
ok "no OpenGL" no_opengl
ok "no script" fails 3 'cannot be read' view "$cube" --script "$DIR/no.txt" "${small[@]}"
finish

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# How quick the window is, at 1024 x 768 on a screen of its own that the processor draws: first light,
# frames a second and what they take from the solver, how soon input shows, relighting while a dimmer
# moves, and its picture against that of render. On a machine that does nothing else.
#
#   tests/accuracy/window.sh PROGRAM [SCENE ...]       first light of these scenes too; minutes
set -u
ISOLUX=${1:?names the program}
case $ISOLUX in /*) ;; *) ISOLUX=$PWD/$ISOLUX ;; esac
shift
here=$(cd "$(dirname "$0")/../.." && pwd)
box=$here/scenes/files/cornell.msd
DIR=$(mktemp -d) || exit 1
finish() { rm -rf "$DIR"; }
. "$here/tests/cli/screen.inc"
cd "$DIR" || exit 1

number() { # FILE KEY [WITHIN]: the first value of that key, after the line that names the other
    awk -v key="\"$2\":" -v within="\"${3:-view}\":" '
        $1 == within && $2 == "{" { on = 1 } on && $1 == key { gsub(/,/, "", $2); print $2; exit }' "$1"
}
view() { "$ISOLUX" view "$@" --progress none --threads 2 --json a.json 2>/dev/null || exit 1; }
row() { printf '%-58s %10s  %s\n' "$@"; }
times() { awk -v x="$1" 'BEGIN { print "wait lit"; for (i = 0; i < x; i++) {
    print "drag left 512 500 560 520"; print "drag left 560 520 512 500" } }'; }

# --- first light ----------------------------------------------------------------------------------

printf 'wait lit\nwait frames 2\n' >lit.txt
for scene in "$here/scenes/third-party/cornell-bitterli/cornell-box.obj" "$@"; do
    [ -e "$scene" ] || continue
    view "$scene" --script lit.txt
    row "first light: $(basename "$scene")" "$(number a.json first_lit_s)" s
done
printf 'wait solved\nwait frames 2\n' >solved.txt
view "$box" --script solved.txt
row '90 % of the light in the Cornell box' "$(number a.json light_90_s)" s

# --- frames ---------------------------------------------------------------------------------------

many=("$box" --patches 50000 --no-adapt --rays 512 --quality medium)
times 40 >move.txt
view "${many[@]}" --script move.txt
row '50,000 patches solved for and turned round: frames a second' \
    "$(number a.json working_frames_per_s)"
row 'milliseconds of such a frame, median' "$(number a.json median working_frame_ms)" ms
row 'input to the frame that shows it, median' "$(number a.json median latency_ms)" ms
row 'the same, 95 of 100' "$(number a.json p95 latency_ms)" ms

# --- what it takes from the solver ----------------------------------------------------------------

for k in 1 2 3; do
    "$ISOLUX" solve "${many[@]}" --tolerance 1e-6 --progress none --threads 2 --json b.json || exit 1
    view "${many[@]}" --tolerance 1e-6 --rate 10 --script solved.txt
    paste -d ' ' <(number b.json factors seconds) <(number a.json factors seconds) \
        <(number b.json solve seconds) <(number a.json solve seconds)
done >pairs
row 'factors and solver beside the window, times alone (3 pairs)' \
    "$(awk '{ print ($2 + $4) / ($1 + $3) }' pairs | sort -g | tr '\n' ' ')"

# --- relighting -----------------------------------------------------------------------------------

{
    printf 'wait solved\nkey U\nwait frames 5\n'
    for k in 1 2 3 4 5; do
        printf 'drag left 803 68 780 68\ndrag left 780 68 803 68\n'
    done
    printf 'wait frames 20\n'
} >dim.txt
view "${many[@]}" --script dim.txt
row 'updates of the light while a dimmer moves, a second' \
    "$(awk -v ms="$(number a.json median update_ms)" 'BEGIN { print 1000 / ms }')"

# --- its picture ----------------------------------------------------------------------------------

printf 'wait solved\nwait frames 2\nkey Shift-S\nwait said saved\nwait frames 2\n' >picture.txt
view "$box" --quality medium --size 512x512 --script picture.txt
"$ISOLUX" render "$box" --quality medium --size 512x512 --progress none -o r.exr || exit 1
"$ISOLUX" compare r.exr cornell-view.exr 2>&1 | sed 's/^/    /'
finish

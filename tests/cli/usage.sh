#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The command line: help, wrong usage, results that cannot be written.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
fast=(--patches 50 --rays 16 --progress none)

ok "no arguments" exits 2
ok "--help" exits 0 --help
ok "--version" exits 0 --version
for command in render solve factors measure check validate bench; do
    ok "$command --help" exits 0 "$command" --help
    ok "$command --help shows an example" grep -q "^  isolux $command" "$DIR/out"
done
ok "unknown command" fails 2 "unknown command 'rendr'" rendr "$cube"
ok "unknown option with a guess" fails 2 'did you mean --quality' render "$cube" --qualty high
ok "unknown option without a guess" fails 2 "unknown option '--nosuchthing'" \
    render "$cube" --nosuchthing 5
ok "option of another command" fails 2 'not an option of check' check "$cube" --spp 4
ok "compare with one picture" fails 2 "two pictures" compare a.exr
ok "light groups that nothing dims" fails 2 'give one of them' bench "$cube" --light-groups
ok "no scene" fails 2 'which scene' render
ok "two scenes" fails 2 'one scene' render a.obj b.obj
ok "not a number" fails 2 "'12x' is not a number" solve "$cube" --rays 12x
ok "a fraction for a count" fails 2 'without a fraction' solve "$cube" --rays 1.5
ok "a negative count" fails 2 'not a number' solve "$cube" --rays -5
ok "out of range" fails 2 'from 1 to' solve "$cube" --rays 0
ok "nan" fails 2 'not a number' solve "$cube" --patch-size nan
ok "bad size" fails 2 'size like' render "$cube" --size 640
ok "bad bytes" fails 2 '512MB' solve "$cube" --max-memory 12XB
ok "bad time" fails 2 '5min' solve "$cube" --time-limit soon
ok "bad vector" fails 2 'three numbers' render "$cube" --eye 1,2
ok "bad word" fails 2 'not one of draft,medium' render "$cube" --quality best
ok "missing value" fails 2 'needs a' render "$cube" --quality
ok "flag with value" fails 2 'takes no value' render "$cube" --diffuse=1
ok "both on standard output" fails 2 'standard output' factors "$cube" -o - --json -
ok "target without eye" fails 2 'belongs to --eye' render "$cube" --target 0,0,0
ok "paths keep no tiles" fails 2 'renderer path makes none' render "$cube" --renderer path \
    --checkpoint 5s
ok "depth of another renderer" fails 2 'belongs to --renderer whitted' render "$cube" --depth 3
ok "a solver for paths" fails 2 'path makes none' render "$cube" --renderer path --solver cg
ok "illuminance of plain rays" fails 2 'whitted makes none' render "$cube" --renderer whitted \
    --false-colour illuminance
ok "stops without end" fails 2 'from -300 to 300' render "$cube" --exposure 1e9
ok "patches for plain rays" fails 2 'whitted makes none' render "$cube" --renderer whitted --adapt
ok "two errors of paths" fails 2 'one error' render "$cube" --renderer path --error 1% --accuracy 1
ok "a share" fails 2 'not a share like 1%' render "$cube" --error 200%
ok "a factor of sor alone" fails 2 'to --solver sor' solve "$cube" --relaxation 1.2
ok "shots of progressive alone" fails 2 'solver progressive' solve "$cube" --solver cg --overshoot
ok "all solvers and one" fails 2 'runs them all' solve "$cube" --compare --solver cg
ok "a range of nothing" fails 2 'false-colour' render "$cube" --range 1,2
ok "a range without difference" fails 2 'that -o draws' compare a.exr b.exr --range 0,1
ok "tone of false colours" fails 2 'does not go' develop a.exr --false-colour luminance --tone filmic
ok "focus without a lens" fails 2 'belongs to a lens' render "$cube" --focus 3
ok "height of a perspective" fails 2 'orthographic' render "$cube" --view-height 3
ok "picture with a strange name" fails 2 'ends in .exr' render "$cube" -o "$DIR/x.jpg"
ok "picture to standard output" fails 2 'needs a name' render "$cube" -o -
ok "measure without points" fails 2 'needs --points' measure "$cube"
ok "unknown camera" fails 2 "no camera 'attic'" render "$cube" -o "$DIR/x.exr" --camera attic \
    "${fast[@]}"

ok "print-config" exits 0 render --print-config --quality high --spp 7 --gather-rays 4
ok "print-config expands" grep -qx 'rays 512' "$DIR/out"
ok "print-config overrides" grep -qx 'spp 7' "$DIR/out"
ok "high takes time for its tree" exits 0 solve --print-config --quality high
ok "it says so" grep -qx 'tree high' "$DIR/out"
ok "unless it shall not" exits 0 solve --print-config --quality final --tree medium
ok "and says that" grep -qx 'tree medium' "$DIR/out"
ok "a set of words" exits 0 render --print-config --repair all,-winding
ok "a word less" grep -qx 'repair weld,duplicates,junctions,nonmanifold,cuts,covered' "$DIR/out"
ok "a set's wrong word" exits 2 render --print-config --repair weld,glue
ok "no-adapt" exits 0 solve --print-config --no-adapt
ok "no-adapt is printed" grep -qx 'no-adapt' "$DIR/out"
ok "name=value" exits 0 render --print-config --quality=draft --rays=33
ok "name=value is taken" grep -qx 'rays 33' "$DIR/out"

ok "folder missing" fails 1 'no/such' solve "$cube" -o "$DIR/no/such/x.ply" "${fast[@]}"
ln -s cube.obj "$DIR/link.exr"
ok "a folder as result" fails 1 'folder' solve "$cube" -o "$DIR" "${fast[@]}"
ok "a mesh with a strange name" fails 2 "ends in .ply" solve "$cube" -o "$DIR/x.obj" "${fast[@]}"
ok "the scene as result" fails 2 "read by this command" render "$cube" -o "$DIR/link.exr" "${fast[@]}"
ok "JSON nowhere" fails 1 'no/such' solve "$cube" --json "$DIR/no/such/x.json" "${fast[@]}"
if [ "$(id -u)" != 0 ]; then
    mkdir "$DIR/locked" && chmod 555 "$DIR/locked"
    ok "folder locked" fails 1 'locked' solve "$cube" -o "$DIR/locked/x.ply" "${fast[@]}"
fi
if [ -e /dev/full ]; then
    "$ISOLUX" factors "$cube" "${fast[@]}" >/dev/full 2>"$DIR/err"
    ok "standard output full" test $? = 1
fi
# A quota stands in for a full disk: 8 blocks of 1 KiB are less than the mesh.
(ulimit -f 8 && "$ISOLUX" solve "$cube" -o "$DIR/full.ply" --patches 2000 --rays 16 \
    --progress none 2>"$DIR/err")
ok "disk full: exit code" test $? = 1
ok "disk full: one line" test "$(wc -l <"$DIR/err")" = 1
ok "disk full: no half file" test ! -e "$DIR/full.ply"
ok "nothing left beside it" test -z "$(find "$DIR" -name '*full.ply*')"
finish

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Solvers side by side, and their options.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
fast=(--patches 400 --rays 64 --progress none)

ok "all solvers" exits 0 solve "$cube" "${fast[@]}" --compare -o "$DIR/s.csv" --tolerance 1e-9 \
    --json "$DIR/s.json"
ok "heading" test "$(head -n 1 "$DIR/s.csv")" = \
    "solver,step,passes,seconds,rays,residual,unshot,error_bound,error"
ways() {
    sed '1d; s/,[0-9].*//' "$1" | sort -u | wc -l
}
ok "eleven ways" test "$(ways "$DIR/s.csv")" = 11
# Error at most the bound, at every step of every solver; rounding aside.
bounded() {
    sed 's/"progressive, /"progressive /' "$1" |
        awk -F, 'NR > 1 && $8 != "" && $9 > $8 + 1e-13 { bad = 1 } END { exit bad || NR < 50 }'
}
ok "errors are within their bounds" bounded "$DIR/s.csv"
converged() {
    awk '/"solver":/ { name = $2 } /"converged": true/ && name !~ /stochastic/ { n++ }
         END { exit n != 10 }' "$1"
}
ok "all converged" converged "$DIR/s.json"
# Both have noise, of rays of their own: some per cent, and less with more of them.
last_error() {
    awk -F, '$1 == "stochastic" { v = $9 } END { print v }' "$1"
}
ok "more rays" exits 0 solve "$cube" --patches 400 --rays 1024 --progress none --compare \
    -o "$DIR/more.csv"
without_links() {
    awk -v some="$(last_error "$DIR/s.csv")" -v more="$(last_error "$DIR/more.csv")" \
        'BEGIN { print "# " some " " more; exit !(some < 0.1 && more > 0 && more < some / 2) }'
}
ok "light without links comes near" without_links
ok "a plot" grep -q '</svg>' "$DIR/s.svg"
ok "with labelled axes" test "$(grep -c 'passes over all links\|>seconds<' "$DIR/s.svg")" = 4
ok "another ending is refused" fails 2 'FILE.csv and FILE.svg' solve "$cube" "${fast[@]}" \
    --compare -o "$DIR/s.ply"
ok "too few steps are told" exits 4 solve "$cube" "${fast[@]}" --compare -o "$DIR/few.csv" \
    --max-iterations 2

for options in "sor --relaxation 1.2" "progressive --overshoot" "progressive --no-ambient" cg \
    gmres two-level; do
    # shellcheck disable=SC2086
    ok "$options" exits 0 solve "$cube" "${fast[@]}" --solver $options --json "$DIR/one.json"
done
shots() {
    sed -nE 's/.*"iterations": ([0-9]+).*/\1/p' "$1"
}
ok "plain shots" exits 0 solve "$cube" "${fast[@]}" --solver progressive --json "$DIR/plain.json"
ok "overshooting" exits 0 solve "$cube" "${fast[@]}" --solver progressive --overshoot \
    --json "$DIR/over.json"
ok "overshooting takes fewer shots" test "$(shots "$DIR/over.json")" -lt \
    "$(shots "$DIR/plain.json")"

# Rays are added until light is known as well as was asked.
value() {
    sed -n '/"accuracy"/,/}/p' "$2" | sed -nE "s/.*\"$1\": ([0-9.e+-]+).*/\1/p"
}
within() {
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a <= b) }'
}
known=(--patches "$(sized 400 100)" --progress none)
ok "as accurate as asked" exits 0 solve "$cube" "${known[@]}" --accuracy 0.01 --json "$DIR/a.json"
ok "that is told" within "$(value reached "$DIR/a.json")" 0.01
ok "finer" exits 0 solve "$cube" "${known[@]}" --accuracy 0.002 --json "$DIR/b.json"
ok "by more rays" test "$(value rays "$DIR/b.json")" -gt "$(value rays "$DIR/a.json")"
ok "more than rays can" exits 4 solve "$cube" "${known[@]}" --accuracy 1e-6 --rays 64 \
    --json "$DIR/c.json"
ok "as many rays as were given" test "$(value rays "$DIR/c.json")" = 64
printf '0.5,0.5,0.5,0,0,1\n' >"$DIR/points.csv"
ok "points" exits 0 measure "$cube" "${known[@]}" --accuracy 0.01 --points "$DIR/points.csv" \
    -o "$DIR/lux.csv" --json "$DIR/d.json"
ok "as well" within "$(value points_reached "$DIR/d.json")" 0.01
ok "not with kept factors" fails 2 'does not go with it' solve "$cube" --accuracy 0.01 \
    --factors "$DIR/F.links"

# Without links.
few=(--patches 400 --progress none --solver stochastic)
ok "stochastic" exits 0 solve "$cube" "${few[@]}" --tolerance 0.1 --json "$DIR/few.json"
ok "its name and its error" test "$(grep -c '"solver": "stochastic"\|"estimated_error"' \
    "$DIR/few.json")" = 2
ok "more rays are needed" exits 4 solve "$cube" "${few[@]}" --rays 1 --tolerance 0.001
ok "not with options about links" fails 2 'closure: not with' solve "$cube" "${few[@]}" \
    --closure none
ok "chosen where links have no room" exits 0 solve "$cube" --patches 30000 --rays 1024 \
    --max-memory 400MB --tolerance 0.2 --json "$DIR/few.json"
ok "that is told" grep -q '"solver": "stochastic"' "$DIR/few.json"
# Checked by paths: links that are there, and a solution that few rays spoilt.
off() {
    tr -d ' \n' <"$1" | sed -nE 's/.*"check":.*"irradiance":\{"rms":([0-9.e+-]+).*/\1/p'
}
ok "checked" exits 0 solve "$cube" --patches 400 --no-adapt --rays 1024 --check 100:128 \
    --json "$DIR/right.json" --progress none
ok "spoilt" exits 4 solve "$cube" "${few[@]}" --rays 8 --tolerance 1e-3 --check 100:128 \
    --json "$DIR/spoilt.json"
ok "what was spoilt is found" awk -v a="$(off "$DIR/right.json")" -v b="$(off "$DIR/spoilt.json")" \
    'BEGIN { exit !(a < 0.02 && b > 0.03) }'
ok "direct and reflected apart" test "$(grep -c '"direct"\|"reflected"' "$DIR/right.json")" = 2
ok "no patches, no check" fails 2 'a number from 1 to' solve "$cube" --check 0
ok "no paths" fails 2 'a number from 1 to' solve "$cube" --check 5:
ok "of one solver" fails 2 'does not go with --compare' solve "$cube" --check 5 --compare
# Asked to stop before they have begun, solvers that cast their own rays cast few.
for solver in stochastic hierarchical; do
    ok "$solver: out of time at once" exits 5 solve scenes/files/cornell.msd --patches 2000 \
        --rays 1000000 --tolerance 1e-9 --solver $solver --time-limit 0 -o "$DIR/late.ply" \
        --progress none
done
finish

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# What the commands write: same bytes for any number of threads, and what must hold in the files.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
cube=$DIR/cube.obj
fast=(--patches 200 --rays 64 --progress none)
view=(--eye 0.5,0.05,0.4 --target 0.5,1,0.5 --up 0,0,1 --size 24x16 --spp 4)
printf 'x,y,z,nx,ny,nz\n0.5,0.5,0.2,0,0,1\n# edge\n0.1,0.9,0,0,0,2\n' >"$DIR/p.csv"

same() { # FILE: written with one thread and with two
    cmp "$DIR/1$1" "$DIR/2$1"
}
for n in 1 2; do
    ok "render, $n threads" exits 0 render "$cube" -o "$DIR/$n.exr" "${fast[@]}" "${view[@]}" \
        --threads "$n"
    ok "solve, $n threads" exits 0 solve "$cube" -o "$DIR/$n.ply" "${fast[@]}" --threads "$n" \
        --json "$DIR/$n.json"
    ok "factors, $n threads" exits 0 factors "$cube" -o "$DIR/$n.csv" "${fast[@]}" --threads "$n"
    ok "factors by patch, $n threads" exits 0 factors "$cube" --by patch -o "$DIR/$n-patch.mtx" \
        "${fast[@]}" --threads "$n"
    ok "measure, $n threads" exits 0 measure "$cube" --points "$DIR/p.csv" -o "$DIR/$n-lux.csv" \
        --gather-rays 256 "${fast[@]}" --threads "$n"
done
for file in .exr .png .ply .csv -patch.mtx -patch.csv -lux.csv; do
    ok "same bytes: $file" same "$file"
done
for n in 1 3; do
    ok "paths, $n threads" exits 0 render "$cube" -o "$DIR/p$n.exr" --renderer path \
        --light ceiling "${view[@]}" --threads "$n" --progress none --json "$DIR/p.json"
done
ok "same paths" cmp "$DIR/p1.exr" "$DIR/p3.exr"
ok "plain rays" exits 0 render "$cube" -o "$DIR/w.exr" --renderer whitted --depth 2 \
    --light ceiling "${view[@]}"
ok "their frame's time" grep -q 'frame .* ms' "$DIR/err"
ok "no light is told apart" fails 3 'no channel irradiance' develop "$DIR/w.exr" \
    --false-colour illuminance
ok "paths tell their error" grep -q '"standard_error": [0-9]' "$DIR/p.json"
# A cube with gloss, without it: light between patches has none either.
sed 's/cube.mtl/gloss.mtl/' "$cube" >"$DIR/gloss.obj"
sed 's/Kd 0.5 0.4 0.3/&\nKs 0.3 0.3 0.3\nNs 20\nillum 2/' "$DIR/cube.mtl" >"$DIR/gloss.mtl"
for of in cube gloss; do
    ok "$of, diffuse" exits 0 render "$DIR/$of.obj" -o "$DIR/$of.exr" "${fast[@]}" "${view[@]}" \
        --exposure 0 --diffuse
done
ok "both compared" exits 0 compare "$DIR/cube.exr" "$DIR/gloss.exr"
ok "no gloss is left" grep -qE '^ *rmse +0 ' "$DIR/err"
ok "with gloss" exits 0 render "$DIR/gloss.obj" -o "$DIR/gloss.exr" "${fast[@]}" "${view[@]}" \
    --exposure 0
ok "that compared" exits 0 compare "$DIR/cube.exr" "$DIR/gloss.exr"
ok "gloss is seen" grep -qE '^ *rmse +[0-9.]*[1-9]' "$DIR/err"
ok "another seed, another picture" exits 0 render "$cube" -o "$DIR/s.exr" "${fast[@]}" \
    "${view[@]}" --seed 7
ok "seed changes the bytes" test "$(cmp -s "$DIR/1.exr" "$DIR/s.exr"; echo $?)" = 1

# Rows of a closed room sum to 1; the plate's two sides are one row.
rows_sum() {
    awk -F, 'NR == 1 { n = NF; next }
             { s = 0; for (i = 3; i <= n; i++) s += $i; if (s < 1 - 1e-6 || s > 1 + 1e-6) bad = 1 }
             END { exit bad || NR != 8 }' "$1"
}
ok "rows sum to 1" rows_sum "$DIR/1.csv"
ok "names of the groups" grep -q '^group,area,.*ceiling' "$DIR/1.csv"
reciprocal() {
    awk -F, 'NR > 1 { a[NR] = $2; for (i = 3; i <= NF; i++) f[NR, i - 1] = $i; n = NR }
             END { for (i = 2; i <= n; i++) for (j = 2; j <= n; j++) {
                       d = a[i] * f[i, j] - a[j] * f[j, i]; if (d < -1e-6 || d > 1e-6) exit 1 } }' "$1"
}
ok "reciprocity" reciprocal "$DIR/1.csv"
ok "by material" exits 0 factors "$cube" --by material "${fast[@]}"
ok "by material names them" grep -q '^lamp,1' "$DIR/out"
ok "matrix size line" test "$(sed -n 3p "$DIR/1-patch.mtx" | awk '{ print ($1 == $2 && $3 > $1) }')" = 1
ok "a line per entry" test "$(sed -n 3p "$DIR/1-patch.mtx" | cut -d' ' -f3)" = \
    "$(tail -n +4 "$DIR/1-patch.mtx" | wc -l)"

ok "PLY begins as one" test "$(head -c 4 "$DIR/1.ply")" = "$(printf 'ply\n')"
ok "PLY read back" exits 0 check "$DIR/1.ply" --json "$DIR/back.json" --progress none
value() { # FILE KEY: the first value of that key
    sed -nE "s/.*\"$2\": (\[?-?[0-9.e+-]+).*/\\1/p" "$1" | head -n 1
}
ok "PLY has as many faces as patches" test "$(value "$DIR/back.json" polygons)" = \
    "$(value "$DIR/1.json" patches)"

lux=$(sed -n 2p "$DIR/1-lux.csv" | cut -d, -f10)
ok "measure keeps the columns" grep -q '^0.5,0.5,0.2,0,0,1,' "$DIR/1-lux.csv"
ok "measure keeps the normal as given" grep -q '^0.1,0.9,0,0,0,2,' "$DIR/1-lux.csv"
ok "light under the plate" awk "BEGIN { exit !($lux > 1 && $lux < 10 * 3.15) }"
ok "points on standard input" bash -c \
    "'$ISOLUX' measure '$cube' --points - ${fast[*]} --gather-rays 64 <'$DIR/p.csv' >'$DIR/out' 2>'$DIR/err'"

for key in schema program version command exit scene file triangles polygons groups materials \
    emitters cameras bounds mesh surfaces patches vertices area closed repaired welded duplicate \
    degenerate nonmanifold flipped refused bvh nodes bytes seconds factors rays nonzeros \
    rays_per_second row_sum_error_max row_sum_error_rms reciprocity_error_max \
    reciprocity_error_rms escaped solve solver iterations residual unshot energy emitted absorbed \
    balance_error total read gather write memory peak_bytes warnings; do
    grep -q "\"$key\":" "$DIR/1.json" || missing="${missing:-} $key"
done
ok "keys of the summary" test -z "${missing:-}"
balanced() {
    awk -v r="$(value "$1" row_sum_error_max)" 'BEGIN { exit !(r <= 1e-6) }' &&
        ! grep -A1 '"balance_error"' "$1" | grep -qE '[0-9]e-0[0-5]'
}
ok "closed to 1e-6" balanced "$DIR/1.json"
ok "summary on standard output" exits 0 check "$cube" --json - --progress none
ok "summary is all there is" test "$(head -c 1 "$DIR/out")" = "{"
ok "nothing on standard error with --progress none" test ! -s "$DIR/err"
for solver in jacobi gauss-seidel progressive; do
    ok "solver $solver" exits 0 solve "$cube" "${fast[@]}" --solver "$solver"
done
ok "a tolerance that is missed" exits 4 solve "$cube" "${fast[@]}" --max-iterations 1 \
    --tolerance 1e-9
ok "--by patch without a name" fails 2 'needs a name' factors "$cube" --by patch
ok "compare with itself" exits 0 compare "$DIR/1.exr" "$DIR/1.exr" --json "$DIR/same.json"
ok "no error" grep -q '"all": 0.0' "$DIR/same.json"
ok "compare with the reference" exits 0 compare tests/data/references/cornell-classic.exr \
    tests/data/references/cornell-classic.exr --json -
ok "mean luminance known" grep -q '"mean": 0.06701' "$DIR/out"
ok "compare pictures of two sizes" fails 3 'not the same picture' \
    compare tests/data/references/cornell-classic.exr "$DIR/1.exr"

ok "compare a solution with itself" exits 0 compare "$DIR/1.ply" "$DIR/2.ply" --json "$DIR/same.json"
ok "all points found, no error" awk -v m="$(value "$DIR/same.json" matched)" \
    -v e="$(value "$DIR/same.json" error)" 'BEGIN { exit !(m == 1 && e < 1e-12) }'
ok "solve on another division" exits 0 solve "$cube" -o "$DIR/fine.ply" --patches 2000 --rays 64 \
    --progress none
ok "compare divisions" exits 0 compare "$DIR/fine.ply" "$DIR/1.ply" --json "$DIR/far.json"
ok "found nearly everywhere, near" awk -v m="$(value "$DIR/far.json" matched)" \
    -v e="$(value "$DIR/far.json" error)" 'BEGIN { exit !(m > 0.999 && e > 0 && e < 0.2) }'
ok "patches' own values" exits 0 compare "$DIR/fine.ply" "$DIR/1.ply" --constant --samples 5000
ok "compare a picture with a solution" fails 2 'one of each' compare "$DIR/1.exr" "$DIR/1.ply"
head -c 3000 "$DIR/1.ply" >"$DIR/cut.ply"
ok "compare with half a file" fails 3 'cut.ply' compare "$DIR/1.ply" "$DIR/cut.ply"
printf 'ply\nformat ascii 1.0\n' >"$DIR/other.ply"
ok "compare with somebody's PLY" fails 3 'not a solved mesh' compare "$DIR/1.ply" "$DIR/other.ply"

# Two unit squares face to face, 1 apart, and a square of half their side over a corner, midway,
# that faces one of them: its back only hides. F(low, high) = 0.14987, F(high, plate) = 0.10381 by visible polygons
# clipped and integrated adaptively; 7e5 rays a group leave a standard error of 5e-4 at most.
cat >"$DIR/hidden.obj" <<'END'
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 0 1 1
v 1 1 1
v 1 0 1
v 0 0 0.5
v 0.5 0 0.5
v 0.5 0.5 0.5
v 0 0.5 0.5
g low
f 1 2 3 4
g high
f 5 6 7 8
g plate
f 9 10 11 12
END
ok "factors past a plate" exits 0 factors "$DIR/hidden.obj" --closure none --patches 1500 \
    --rays 1024 --progress none
near() { awk -F, -v row="$1" -v column="$2" -v wanted="$3" \
    '$1 == row { d = $column - wanted; exit !(d < 0.0015 && d > -0.0015) }' "$DIR/out"; }
ok "low sees high around the plate" near low 4 0.14987
ok "high sees the plate" near high 5 0.10381
ok "low sees only its back" near low 5 0

finish

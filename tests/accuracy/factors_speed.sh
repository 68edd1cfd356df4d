#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Whole matrices of many surfaces, from the file read to the file written: a gridded box of 9,600
# surfaces, closure of a box of 50,784, a city block of 22,000 facets. CPU and wall seconds, memory.
# tests/accuracy/factors_speed.sh PROGRAM
set -u
ISOLUX=${1:?names the program}
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT

# gridded_box N: a unit cube of 6 N x N squares as View3D's input, a surface each.
gridded_box() {
    awk -v n="$1" '
    function side(ox, oy, oz, ax, ay, az, bx, by, bz,   i, j, k) {
        for (i = 0; i < n; i++) for (j = 0; j < n; j++) for (k = 0; k < 4; k++) {
            s = (i + (k == 1 || k == 2)) / n; t = (j + (k >= 2)) / n
            print "V", ++v, ox + ax * s + bx * t, oy + ay * s + by * t, oz + az * s + bz * t
        }
    }
    BEGIN { print "T gridded box\nF 3"
        side(0,0,0, 1,0,0, 0,1,0); side(0,0,1, 0,1,0, 1,0,0); side(0,0,0, 0,1,0, 0,0,1)
        side(1,0,0, 0,0,1, 0,1,0); side(0,0,0, 0,0,1, 1,0,0); side(0,1,0, 1,0,0, 0,0,1)
        for (i = 0; i < v / 4; i++)
            print "S", i + 1, 4 * i + 1, 4 * i + 2, 4 * i + 3, 4 * i + 4, 0, 0, 0.9, "s" i + 1
        print "E" }'
}

# city N K: N x N boxes on a street grid, faces of K x K squares, all as triangles.
city() {
    awk -v n="$1" -v k="$2" '
    function quad(ox, oy, oz, ax, ay, az, bx, by, bz, na, nb,   i, j, c) {
        for (i = 0; i < na; i++) for (j = 0; j < nb; j++) {
            for (c = 0; c < 4; c++) {
                s = (i + (c == 1 || c == 2)) / na; t = (j + (c >= 2)) / nb
                print "v", ox + ax * s + bx * t, oy + ay * s + by * t, oz + az * s + bz * t
            }
            v += 4
            face[++f] = "f " v - 3 " " v - 2 " " v - 1; face[++f] = "f " v - 3 " " v - 1 " " v
        }
    }
    BEGIN { w = 12
        for (x = 0; x < n; x++) for (y = 0; y < n; y++) {
            X = 20 * x; Y = 20 * y; h = 10 + (7 * x + 13 * y) % 11 * 2
            quad(X,Y,h, w,0,0, 0,w,0, k,k); quad(X,Y,0, w,0,0, 0,0,h, k,k)
            quad(X+w,Y,0, 0,w,0, 0,0,h, k,k); quad(X+w,Y+w,0, -w,0,0, 0,0,h, k,k)
            quad(X,Y+w,0, 0,-w,0, 0,0,h, k,k)
            quad(X+w,Y,0, 8,0,0, 0,w,0, 2,3); quad(X,Y+w,0, 20,0,0, 0,8,0, 5,2)
        }
        for (i = 1; i <= f; i++) print face[i] }'
}

# measure TEXT ARGUMENTS...: CPU and wall seconds, peak memory, row sums.
measure() {
    local text=$1
    shift
    local times
    times=$( { TIMEFORMAT='%U %S %R'; time "$ISOLUX" factors "$@" --json "$DIR/j" \
        --progress none 2>"$DIR/err"; } 2>&1) || { cat "$DIR/err"; exit 1; }
    awk -v text="$text" -v times="$times" '
    function value(key) { if (!match($0, "\"" key "\": [-0-9.e+]*")) return ""
        return substr($0, RSTART + length(key) + 4, RLENGTH - length(key) - 4) }
    { all = all $0 }
    END { $0 = all; split(times, t, " ")
        printf "%-44s %6.2f s CPU, %6.2f s wall, %5.0f MB; cast %.2f s, closed %.2f s; rows off " \
            "by %.1e, pairs %.1e\n", text, t[1] + t[2], t[3], value("peak_bytes") / 1e6,
            value("cast_seconds"), value("closure_seconds"), value("row_sum_error_max"),
            value("reciprocity_error_max") }' "$DIR/j"
}

gridded_box 40 >"$DIR/box40.vs3"
for form in npz mtx; do
    measure "9,600 surfaces, by patch, .$form" "$DIR/box40.vs3" --by patch -o "$DIR/F.$form"
done
for form in csv npz vf; do
    measure "9,600 surfaces as groups, .$form" "$DIR/box40.vs3" -o "$DIR/F.$form"
done
gridded_box 92 >"$DIR/box92.vs3"
measure "50,784 surfaces, closure both" "$DIR/box92.vs3" --by patch --patches 60000 \
    --closure both -o "$DIR/F.npz"
measure "the same in 16 bits" "$DIR/box92.vs3" --by patch --patches 60000 --storage 16 \
    -o "$DIR/F.npz"
TMPDIR=$DIR measure "the same, --max-memory 256MB" "$DIR/box92.vs3" --by patch --patches 60000 \
    --max-memory 256MB -o "$DIR/F.npz"
city 12 4 >"$DIR/city.obj"
echo "city: $(grep -c '^f' "$DIR/city.obj") facets"
measure "city, by patch, .npz" "$DIR/city.obj" --by patch --patches 30000 -o "$DIR/F.npz"
measure "city, by patch, .mtx" "$DIR/city.obj" --by patch --patches 30000 -o "$DIR/F.mtx"

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A table, in Markdown, of what check finds in scenes and whether light gets out of them: for files,
# and for all scenes below folders. Run by hand; a scene takes seconds, a large one half a minute.
#
#   tests/accuracy/scenes.sh PROGRAM FILE|FOLDER...
#
# leak: of scenes that a closed part encloses and that are lit inside, the share of the light that
# escapes all the same; of others a dash, for light may leave them.
set -u
isolux=${1:?names the program}
shift
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# Scenes of a folder, not what belongs to them.
scenes() {
    find "$1" -type f \( -name '*.msd' -o -name '*.obj' -o -name '*.gltf' -o -name '*.glb' -o \
        -name '*.ply' -o -name '*.vs3' \) ! -path '*/meshes/*' | LC_ALL=C sort
}

# What check found, as cells.
cells() {
    awk '
    function number(line) {
        line = substr(line, index(line, ":") + 1)
        gsub(/[^-0-9.e+]/, "", line)
        return line + 0
    }
    function several(n, what) { return n " " what (n == 1 ? "" : "s") }
    function join(a, b) { return a (a == "" ? "" : ", ") b }
    { split($0, w, "\""); key = w[2] }
    /^  "[a-z_]+": \{/ { part = key; kind = ""; next }
    /^  \}/ { part = ""; next }
    part == "scene" && key == "triangles" { triangles = number($0) }
    part == "faces" && /^    "[a-z_]+": [0-9]/ { face[key] = number($0) }
    part == "rims" && /^    "found":/ { rims = number($0) }
    part == "rims" && key == "curved_borders" { curved = number($0) }
    part == "units" && /"suspicious": true/ { units = 1 }
    part == "defects" && /^    "[a-z-]+": \{/ { kind = key }
    part == "defects" && /^      "found":/ { n = number($0) }
    part == "defects" && /^      "repaired":/ && n > 0 {
        r = number($0)
        list = join(list, kind " " n (r > 0 ? " (" r ")" : ""))
    }
    END {
        if (rims > 0) open = several(rims, "rim")
        if (curved > 0) open = join(open, several(curved, "curved face"))
        if (units) list = join(list, "units suspicious")
        printf "%d | %s | %d = %d + %d + %d | %s", triangles,
            open == "" ? "closed" : "open: " open, face["input"], face["patches"],
            face["out_of_reach"], face["input"] - face["patches"] - face["out_of_reach"],
            list == "" ? "none" : list
    }' "$1"
}

# Whether a closed part has the whole box of the scene, and only its inner side is seen.
enclosed() {
    tr -d ' \n' <"$1" | awk '
    function value(text, key) {
        return match(text, "\"" key "\":[-0-9.e+]+") \
            ? substr(text, RSTART + length(key) + 3, RLENGTH - length(key) - 3) + 0 : 0
    }
    {
        if (!match($0, /"bounds":\[\[[^]]*\],\[[^]]*\]\]/)) exit 1
        box = substr($0, RSTART, RLENGTH)
        n = split(substr($0, index($0, "\"parts\":{")), part, /\{"group":/)
        for (k = 2; k <= n; k++) {
            inner = value(part[k], "volume") < 0 ? "fronts" : "backs"
            outer = inner == "fronts" ? "backs" : "fronts"
            if (index(part[k], "\"closed\":true") && index(part[k], box) &&
                value(part[k], inner) > 0 && value(part[k], outer) == 0) { found = 1; exit 0 }
        }
        exit 1
    }'
}

# Share of the light that escapes, from a summary.
escaped() {
    tr -d ' \n' <"$1" | awk '
    function sum(key,   text, at, v) {
        at = index($0, "\"energy\":")
        text = substr($0, at)
        if (at == 0 || !match(text, "\"" key "\":\\[[^]]*\\]")) return -1
        split(substr(text, RSTART + length(key) + 4, RLENGTH - length(key) - 5), v, ",")
        return v[1] + v[2] + v[3] }
    { all = sum("emitted"); out = sum("escaped")
      if (all > 0) printf "%.2g", out / all; else printf "no light" }'
}

row() {
    local scene=$1 leak=- patches=-
    if ! timeout 300 "$isolux" check "$scene" --json "$dir/c.json" --progress none \
        >/dev/null 2>"$dir/err"; then
        echo "| $2 | not read: $(head -n 1 "$dir/err" | sed 's/^isolux: //; s/|/\//g') | | | | | |"
        return
    fi
    timeout 600 "$isolux" solve "$scene" --quality draft --patches 2000 --light ceiling \
        -o "$dir/s.ply" --json "$dir/s.json" --progress none 2>/dev/null
    case $? in 0 | 4) patches=$(sed -n '/"mesh"/,/"area"/s/.*"patches": *\([0-9]*\).*/\1/p' \
        "$dir/s.json" | head -n 1)
        enclosed "$dir/c.json" && leak=$(escaped "$dir/s.json") ;;
    esac
    echo "| $2 | $(cells "$dir/c.json") | $patches | $leak |"
}

echo "| scene | triangles | verdict | faces = patches + out of reach + left out" \
    "| defects found (repaired) | patches | leak |"
echo "|---|---|---|---|---|---|---|"
for what in "$@"; do
    if [ -d "$what" ]; then
        base=$(cd "$what/.." && pwd)/
        scenes "$(cd "$what" && pwd)" | while read -r scene; do
            row "$scene" "${scene#"$base"}"
        done
    else
        row "$what" "$(basename "$what")"
    fi
done

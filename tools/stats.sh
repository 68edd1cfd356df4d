#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Budgets of the code, as a table; exit status 1 when a hard one is broken. Needs universal-ctags.
#
# Lengths, widths and forgotten notes are looked for in tests too, the rest in the product alone.
set -u
export LC_ALL=C.UTF-8
cd "$(dirname "$0")/.." || exit 1
command -v ctags >/dev/null || {
    echo "stats: needs universal-ctags (make deps)" >&2
    exit 1
}

product=$(ls {base,math,mesh,raycast,inspect,scenes,radiosity,render,viewer,app}/*.{c,h,cpp} 2>/dev/null)
tests=$(ls tests/*.{c,h} tests/fuzz/*.{c,h} 2>/dev/null)
sources=$(echo "$product" | grep -v '\.h$')
public=$(tools/headers.sh base math mesh raycast inspect scenes radiosity render)
lines=$(cat $product | wc -l)
status=0

# Code without comments and string literals, as file:line:text.
code() {
    awk '
        FNR == 1 { inside = 0 }
        {
            text = $0
            gsub(/\\./, "", text)
            gsub(/"[^"]*"/, "\"\"", text)
            out = ""
            while (text != "") {
                if (inside) {
                    at = index(text, "*/")
                    if (at == 0) break
                    text = substr(text, at + 2)
                    inside = 0
                } else {
                    at = index(text, "/*")
                    if (at == 0) { out = out text; break }
                    out = out substr(text, 1, at - 1)
                    text = substr(text, at + 2)
                    inside = 1
                }
            }
            sub(/\/\/.*/, "", out)
            print FILENAME ":" FNR ":" out
        }' "$@"
}

# label  value  budget  hard|soft  [text to show when broken]
row() {
    local mark=ok
    if [ "$4" != ok ]; then
        mark=$5
        [ "$5" = OVER ] && status=1
    fi
    printf '%-42s %10s   %-12s %s\n' "$1" "$2" "$3" "$mark"
    [ "$4" != ok ] && [ -n "${6-}" ] && echo "$6" | head -n 20 | sed 's/^/    /'
    return 0
}

at_most() { [ "$1" -le "$2" ] && echo ok || echo no; }
count() { [ -z "$1" ] && echo 0 || echo "$1" | wc -l; }

# --- lengths -------------------------------------------------------------------------------------

functions=$(ctags -x --kinds-C=f --kinds-C++=f --_xformat='%{line} %{end} %{input} %N' \
    $product $tests | awk '$2 != "-" { print $2 - $1 + 1, $3 ":" $1, $4 }' | sort -n)
number=$(count "$functions")
median=$(echo "$functions" | sed -n "$(((number + 1) / 2))p" | cut -d ' ' -f 1)
ninety=$(echo "$functions" | sed -n "$(((number * 9 + 9) / 10))p" | cut -d ' ' -f 1)
longest=$(echo "$functions" | tail -n 1 | cut -d ' ' -f 1)
over=$(echo "$functions" | awk '$1 > 80')
files=$(wc -l $product $tests | awk '$2 != "total" { print $1, $2 }' | sort -n)
number_files=$(count "$files")
big=$(echo "$files" | awk '$1 > 650')
wide=$(grep -nHE '^.{101,}' $product $tests)

printf '%-42s %10s   %-12s\n' '' measured budget
row "lines of code, without tests" "$lines" "" ok soft
row "functions, with tests" "$number" "" ok soft
row "function lines, median" "$median" "" ok soft
row "function lines, 90 %" "$ninety" "45" "$(at_most "$ninety" 45)" OVER
row "function lines, longest" "$longest" "80" "$(at_most "$longest" 80)" OVER "$over"
row "file lines, median" "$(echo "$files" | sed -n "$(((number_files + 1) / 2))p" | cut -d ' ' -f 1)" \
    "150-400" ok soft
row "file lines, longest" "$(echo "$files" | tail -n 1 | cut -d ' ' -f 1)" "650" \
    "$([ -z "$big" ] && echo ok || echo no)" OVER "$big"
row "lines wider than 100" "$(count "$wide")" "0" "$(at_most "$(count "$wide")" 0)" OVER "$wide"

# --- habits --------------------------------------------------------------------------------------

asserts=$(code $sources | grep -cE '\bassert\(')
source_lines=$(cat $sources | wc -l)
share=$(awk -v a="$asserts" -v n="$source_lines" 'BEGIN { printf "%.1f", 1000 * a / (n ? n : 1) }')
row "asserts per 1000 lines of .c" "$share" "10" \
    "$([ "$((asserts * 1000))" -ge "$((10 * source_lines))" ] && echo ok || echo no)" OVER

# A literal with a negative exponent that is neither named, nor in the file of tolerances, nor a change
# of unit, nor in the tables of settings a user can change.
bare=$(code $(echo "$product" | grep -vE '^(math/tolerance\.h|app/(options|quality)\.c)$') |
    grep -E '[^A-Za-z0-9_.][0-9][0-9.]*[eE]-[0-9]' | grep -vE '\b1e-[369] \* ' |
    grep -vE 'static const |# *define|\bconst(expr)? (double|float) [a-z_]+ = [0-9.]+e')
row "tolerances written bare" "$(count "$bare")" "0" "$(at_most "$(count "$bare")" 0)" OVER "$bare"

# A signal handler has nothing else to write to. Of a struct written out in place, the first line says.
variables=$(ctags -x --kinds-C=v --kinds-C++=v --_xformat='%{input} %{line} %C' $product |
    while read -r file line text; do
        case $text in
        '}'*) text=$(head -n "$line" "$file" | grep -E '^[a-z]' | tail -n 1) ;;
        esac
        echo "$file:$line: $text"
    done | grep -vE '\bconst(expr)?\b|\bextern\b|volatile sig_atomic_t')
row "file-scope variables not const" "$(count "$variables")" "0" \
    "$(at_most "$(count "$variables")" 0)" OVER "$variables"

notes=$(grep -nHE '\b(TODO|FIXME)\b' $product $tests | grep -vE '#[0-9]+')
row "TODO without an issue number" "$(count "$notes")" "0" "$(at_most "$(count "$notes")" 0)" OVER \
    "$notes"

many=$(ctags -x --kinds-C=f --kinds-C++=f --_xformat='%{signature} %{input}:%{line} %N' $product |
    awk '{ text = $0; n = gsub(/,/, ",", text); if (n > 5) print n + 1, $(NF - 1), $NF }')
row "functions with more than 6 parameters" "$(count "$many")" "0" \
    "$(at_most "$(count "$many")" 0)" "over, soft" "$many"

# A public function without a comment above it or above the group without blank line it stands in.
bald=$(awk '
    FNR == 1 { said = 0 }
    /^[ \t]*$/ { said = 0 }
    /\*\// || /\/\*/ { said = 1 }
    /^[A-Za-z_].*[ *][a-z][a-z0-9_]*\(.*/ && !/^(static|typedef|#|extern "C")/ && !said {
        print FILENAME ":" FNR ": " $0
    }' $public)
row "public functions without a comment" "$(count "$bald")" "0" "$(at_most "$(count "$bald")" 0)" \
    "over, soft" "$bald"

prototypes=$(ctags -x --kinds-C=p --language-force=C --_xformat='%N' $public | wc -l)
row "header lines per public function" \
    "$(($(cat $public | wc -l) / (prototypes > 0 ? prototypes : 1)))" "about 15" ok soft
exit "$status"

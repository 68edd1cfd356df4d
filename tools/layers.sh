#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Refuses includes that point upwards, and outside libraries that more than one file includes.
set -u
export LC_ALL=C
cd "$(dirname "$0")/.." || exit 1

# Each layer, and those that it may include besides itself.
layers='base
math base
mesh base math
raycast base math
inspect base math mesh raycast
scenes base math mesh raycast
radiosity base math mesh raycast scenes
render base math mesh raycast scenes radiosity
viewer base math mesh raycast scenes radiosity render
app base math mesh raycast inspect scenes radiosity render viewer'

# Headers of the language and the system: not outside libraries.
system='arpa/inet|assert|complex|ctype|dirent|dlfcn|endian|err|errno|execinfo|fcntl|fenv|float|fnmatch|ftw|
getopt|glob|inttypes|libgen|limits|link|locale|malloc|math|poll|pthread|regex|sched|search|semaphore|setjmp|signal|
spawn|stdalign|stdarg|stdatomic|stdbool|stddef|stdint|stdio|stdlib|stdnoreturn|string|strings|sys/[a-z]+|
termios|tgmath|threads|time|unistd|wchar|wctype|[a-z]*mmintrin|x86intrin|cpuid|arm_neon'
system=$(echo "$system" | tr -d '\n')

status=0
names=$(echo "$layers" | cut -d ' ' -f 1)
while read -r layer allowed; do
    [ -d "$layer" ] || continue
    forbidden=$(for name in $names tests; do
        case " $layer $allowed " in *" $name "*) ;; *) echo "$name" ;; esac
    done | paste -s -d '|')
    [ -n "$forbidden" ] || continue
    if grep -rnE "^ *# *include *[<\"](\.\./)*($forbidden)/" --include='*.[ch]' \
        --include='*.cpp' "$layer"; then
        echo "layers: $layer/ may include only: $layer ${allowed:-(nothing else)}" >&2
        status=1
    fi
done <<<"$layers"

# library  file, for each include of an outside library: C++'s own headers have no dot and no slash
users=$(grep -rE '^ *# *include *<' --include='*.[ch]' --include='*.cpp' $names 2>/dev/null |
    sed -nE 's/^([^:]*):[^<]*<([^>]*)>.*/\2 \1/p' | grep -E '^[^ ]*[./]' | grep -vE "^($system)\.h " |
    sed -E 's/^openexr[^ ]*/OpenEXR/; s/^(stb\/)?(stb_[a-z_]*)[^ ]*/\2/; s/^([^\/ ]*)\/[^ ]*/\1/' | sort -u)
# JSON is read by one file (scenes/gltf_json.c) and written by another (app/json.c).
shared=$(echo "$users" | grep -vE '^jansson\.h (scenes/gltf_json|app/json)\.c$' |
    cut -d ' ' -f 1 | uniq -d)
for library in $shared; do
    echo "layers: $library is included by more than one file:" \
        $(echo "$users" | sed -n "s|^$library ||p") >&2
    status=1
done
[ "$status" = 0 ] && echo "layers: no include points upwards; outside libraries:" \
    $(echo "$users" | cut -d ' ' -f 1 | sort -u)
exit "$status"

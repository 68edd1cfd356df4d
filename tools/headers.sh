#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The public headers of the library, one a line: those that a file of another folder includes, all of
# base/ and math/ but internal.h, and what these include in turn.
#
#   headers.sh FOLDER...
set -u
export LC_ALL=C
cd "$(dirname "$0")/.." || exit 1

# "FILE HEADER" for each include of one of ours, and each header once.
edges=$(grep -rE '^ *# *include *"[a-z]+/[a-z_0-9]+\.h"' --include='*.[ch]' --include='*.cpp' \
    "$@" app 2>/dev/null | sed -E 's/^([^:]*):[^"]*"([^"]*)".*/\1 \2/')
public=$({
    echo "$edges" | awk '{ split($1, a, "/"); split($2, b, "/"); if (a[1] != b[1]) print $2 }'
    ls base/*.h math/*.h | grep -v '/internal\.h$'
} | grep -vE '^(app|viewer)/' | sort -u)
while :; do
    more=$({
        echo "$public"
        echo "$edges" | awk -v list="$public" '
            BEGIN { n = split(list, names, "\n"); for (i = 1; i <= n; i++) known[names[i]] = 1 }
            $1 in known { print $2 }'
    } | sort -u)
    [ "$more" = "$public" ] && break
    public=$more
done
echo "$public"

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs test programs under valgrind's memcheck, one after the other: minutes for those with many rays.
# Leaks are left to config=sanitize, which sees them in children as well.
set -u
cd "$(dirname "$0")/.." || exit 1
passed=0
failed=0
out=$(mktemp) || exit 1
trap 'rm -f "$out"' EXIT
for program in "$@"; do
    if valgrind -q --error-exitcode=99 --leak-check=no --child-silent-after-fork=yes \
        --suppressions=tests/valgrind.supp "$program" >"$out" 2>&1 </dev/null; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$program:"
        grep -E '^==|FAILED|LINE' "$out" | head -n 20
    fi
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]

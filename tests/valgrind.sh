#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs test programs under valgrind's memcheck, JOBS at once: a minute or more for the slowest.
# Leaks are left to config=sanitize, which sees them in children as well. Memcheck knows no AVX-512:
# the kernel that the tests take by themselves is avx2.
#
#   valgrind.sh PROGRAM...     JOBS: how many at once; VALGRIND_TIMEOUT: seconds each
set -u
cd "$(dirname "$0")/.." || exit 1
out=$(mktemp -d) || exit 1
trap 'rm -rf "$out"' EXIT
export out limit=${VALGRIND_TIMEOUT:-900}

# One line: the program's name, seconds of processor time, and what is wrong with it.
check_one() {
    local name status
    name=$(basename "$1")
    # TMPDIR: tests that run at once must not meet in a file.
    mkdir -p "$out/$name.scratch"
    TIMEFORMAT=%U
    { time TMPDIR=$out/$name.scratch timeout -k 10 "$limit" valgrind -q --error-exitcode=99 \
        --leak-check=no --child-silent-after-fork=yes --suppressions=tests/valgrind.supp \
        "$1" >"$out/$name" 2>&1 </dev/null; } 2>"$out/$name.time"
    status=$?
    case $status in
    0) status=passed ;;
    124 | 137) status="failed: ended after $limit s" ;;
    *) status="failed: exit status $status" ;;
    esac
    echo "$name $(cat "$out/$name.time") s, $status"
    [ "$status" = passed ] || grep -E '^==|FAILED|LINE' "$out/$name" | head -n 20
}
export -f check_one

printf '%s\n' "$@" | xargs -P "${JOBS:-1}" -I {} bash -c 'check_one {}' | tee "$out/all"
passed=$(grep -c ' s, passed$' "$out/all")
failed=$(($# - passed))
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]

#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs test programs and scripts, each in a process of its own, and counts their TAP lines.
#
#   run.sh PROGRAM|SCRIPT...     BUILD: build folder; JOBS: how many at once; TEST_TIMEOUT: seconds each
#
# A test that crashes, is killed, says less than its plan or has none counts as one more failure, with
# its output. The last line is "N passed, N failed"; exit status 1 when any failed.
set -u
# The project's root: test programs open their files from here.
cd "$(dirname "$0")/.." || exit 1

BUILD=${BUILD:-build}
JOBS=${JOBS:-1}
mkdir -p "$BUILD/tests/log"
BUILD=$(cd "$BUILD" && pwd)
export BUILD CC="${CC:-gcc}" OPT="${OPT:-}" CONFIG="${CONFIG:-release}"
export ISOLUX="$BUILD/isolux"
export CMOCKA_MESSAGE_OUTPUT=TAP
# A test that runs make must not wait for this make's job tokens.
unset MAKEFLAGS MFLAGS MAKELEVEL
log=$BUILD/tests/log
limit=${TEST_TIMEOUT:-600}

# Name of the log and of the scratch folder of a test.
test_name() { basename "$1" .sh; }

run_one() {
    local name
    name=$(test_name "$1")
    local scratch=$BUILD/tests/scratch/$name
    local command=("$1")
    rm -rf "$scratch" && mkdir -p "$scratch"
    case $1 in
    *.sh) command=(bash "$1") ;;
    */replay_*) command=("$1" "tests/fuzz/corpus/${name#replay_}") ;;
    esac
    # The braces take the shell's own word on a crash, which report_one says better.
    {
        TMPDIR=$scratch timeout -k 10 "$limit" "${command[@]}" \
            </dev/null >"$log/$name.out" 2>"$log/$name.err"
        echo $? >"$log/$name.status"
    } 2>/dev/null
    rm -rf "$scratch"
}

passed=0
failed=0
skipped=0

# What is wrong with a finished test beyond its "not ok" lines; nothing when it is sound.
complaint() { # status plan told failures
    if [ "$1" = 124 ] || [ "$1" = 137 ]; then
        echo "ended after $limit seconds"
    elif [ "$1" -gt 128 ]; then
        echo "killed by signal $(kill -l "$1")"
    elif [ -z "$2" ]; then
        echo "no plan (exit status $1)"
    elif [ "$2" != "$3" ]; then
        echo "planned $2 tests, told of $3 (exit status $1)"
    elif [ "$1" != 0 ] && [ "$4" = 0 ]; then
        echo "exit status $1"
    fi
}

report_one() {
    local name status plan told ok not_ok skip wrong
    name=$(test_name "$1")
    status=$(cat "$log/$name.status")
    plan=$(sed -nE 's/^1\.\.([0-9]+).*/\1/p' "$log/$name.out" | head -n 1)
    skip=$(grep -ciE '^(not )?ok\b.*# *skip' "$log/$name.out")
    ok=$(grep -E '^ok\b' "$log/$name.out" | grep -ciEv '# *skip')
    not_ok=$(grep -E '^not ok\b' "$log/$name.out" | grep -ciEv '# *skip')
    told=$((ok + not_ok + skip))
    wrong=$(complaint "$status" "$plan" "$told" "$not_ok")
    [ -n "$wrong" ] && not_ok=$((not_ok + 1))
    printf '%-28s %4d passed, %d failed%s\n' "$name" "$ok" "$not_ok" \
        "$([ "$skip" != 0 ] && echo ", $skip skipped")"
    if [ "$not_ok" != 0 ]; then
        [ -n "$wrong" ] && echo "  $name: $wrong"
        grep -vE '^ok\b' "$log/$name.out" | tail -n 60 | sed 's/^/  | /'
        tail -n 60 "$log/$name.err" | sed 's/^/  ! /'
    fi
    passed=$((passed + ok))
    failed=$((failed + not_ok))
    skipped=$((skipped + skip))
}

started=0
shown=0
tests=("$@")
pids=()
while [ "$shown" -lt "${#tests[@]}" ]; do
    while [ "$started" -lt "${#tests[@]}" ] && [ "$(jobs -rp | wc -l)" -lt "$JOBS" ]; do
        run_one "${tests[$started]}" &
        pids[started]=$!
        started=$((started + 1))
    done
    # Results appear in the order of the list, whatever ends first.
    if ! kill -0 "${pids[$shown]}" 2>/dev/null; then
        wait "${pids[$shown]}"
        report_one "${tests[$shown]}"
        shown=$((shown + 1))
    elif [ "$started" -lt "${#tests[@]}" ]; then
        wait -n
    else
        wait "${pids[$shown]}"
    fi
done
rm -rf "$BUILD/tests/scratch"
[ "$skipped" != 0 ] && echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]

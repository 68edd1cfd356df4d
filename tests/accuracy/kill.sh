#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs killed (SIGKILL) at random moments and resumed from the checkpoint that is there: the same
# bytes as an unbroken run, each time. Run by hand; takes minutes.
#
#   tests/accuracy/kill.sh [RUNS [SCENE]]     100 of each of solve and render; the Cornell box
set -u
cd "$(dirname "$0")/../.." || exit 1
isolux=${ISOLUX:-build/isolux}
runs=${1:-100} scene=${2:-scenes/files/cornell.msd}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
RANDOM=${SEED:-1}

# A result, whether or not it is as good as was asked.
made() {
    "$isolux" "$@"
    local code=$?
    [ "$code" = 0 ] || [ "$code" = 4 ]
}

# KIND ENDING OPTIONS...: breaks that many runs off and goes on with them
kill_runs() {
    local kind=$1 ending=$2 begin length resumed=0 early=0 late=0 wrong=0
    shift 2
    begin=$(date +%s%N)
    made "$kind" "$scene" -o "$dir/whole.$ending" --progress none "$@" || exit 1
    length=$(($(date +%s%N) - begin))
    for ((k = 0; k < runs; k++)); do
        rm -f "$dir/broken"* "$dir"/.isolux-*
        "$isolux" "$kind" "$scene" -o "$dir/broken.$ending" --progress none --checkpoint 0.05s \
            "$@" &
        local pid=$! wait_ns=$((length / 1000 * (RANDOM % 1000)))
        sleep "$(printf '%d.%09d' $((wait_ns / 1000000000)) $((wait_ns % 1000000000)))"
        kill -9 "$pid" 2>/dev/null
        wait "$pid" 2>/dev/null
        if [ -e "$dir/broken.$ending" ]; then # it was faster this time
            late=$((late + 1)) k=$((k - 1))
        elif [ -e "$dir/broken.$ending.checkpoint" ]; then
            resumed=$((resumed + 1))
            made "$kind" "$scene" -o "$dir/broken.$ending" --progress none \
                --resume "$dir/broken.$ending.checkpoint" "$@" || wrong=$((wrong + 1))
        else # killed before anything was there to save: begins again
            early=$((early + 1))
            made "$kind" "$scene" -o "$dir/broken.$ending" --progress none "$@" ||
                wrong=$((wrong + 1))
        fi
        cmp -s "$dir/whole.$ending" "$dir/broken.$ending" || wrong=$((wrong + 1))
    done 2>/dev/null
    echo "$kind: $runs runs killed, $resumed resumed, $early before a checkpoint," \
        "$late had ended; $wrong wrong"
    [ "$wrong" = 0 ]
}

kill_runs solve ply --rays 256 --patches 3000 || exit 1
# Some 60 rounds; a tolerance that is not reached, which exit code 4 tells.
kill_runs solve ply --rays 4096 --patches 3000 --solver stochastic --tolerance 1e-6 || exit 1
# Rounds of links between clusters, and the last reflection.
kill_runs solve ply --rays 512 --patches 3000 --solver hierarchical --tolerance 1e-4 || exit 1
kill_runs render exr --patches 1000 --size 96x96 --spp 32 || exit 1

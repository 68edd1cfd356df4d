#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What a picture of a scene costs and how far off it is: processor seconds of the whole program, and
# errors against this program's own path tracer, for each quality.
# tests/accuracy/picture.sh PROGRAM [SCENE [SAMPLES [SIZE]]]
#   SAMPLES  paths per pixel of the reference (default 1024); its own noise is printed first
# The columns are those of `isolux compare`; the reference's noise is part of all but `block`.
set -u
ISOLUX=${1:?names the program}
SCENE=${2:-$(cd "$(dirname "$0")/../../scenes/files" && pwd)/cornell.msd}
SAMPLES=${3:-1024} SIZE=${4:-256x256}
DIR=$(mktemp -d) || exit 1
trap 'rm -rf "$DIR"' EXIT
TIMEFORMAT='%U CPU s'

"$ISOLUX" render "$SCENE" --renderer path --diffuse --spp "$SAMPLES" --size "$SIZE" \
    -o "$DIR/reference.exr" 2>"$DIR/err" || { cat "$DIR/err"; exit 1; }
grep paths "$DIR/err"
for quality in draft medium high; do
    echo "$quality"
    time "$ISOLUX" render "$SCENE" --diffuse --quality $quality --size "$SIZE" \
        -o "$DIR/$quality.exr" >/dev/null 2>"$DIR/err" || { cat "$DIR/err"; exit 1; }
    grep '^  error' "$DIR/err"
    "$ISOLUX" compare "$DIR/reference.exr" "$DIR/$quality.exr" 2>&1 |
        grep -E '^ +(all|smooth|block|bias) '
done

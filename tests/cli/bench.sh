#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# isolux bench: what its JSON holds.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"

ok "bench" exits 0 bench "$DIR/cube.obj" --patches 50 --rays 16 --threads 2 --progress plain \
    --json "$DIR/bench.json"
for key in bench workload threads rays_per_second nodes_per_ray triangles_per_ray kernel tree \
    build_seconds bytes_per_triangle peak_bytes bvh; do
    grep -q "\"$key\":" "$DIR/bench.json" || missing="${missing:-} $key"
done
ok "keys" test -z "${missing:-}"
for workload in primary hemisphere visibility; do
    ok "$workload on one thread and on two" \
        test "$(grep -c "\"workload\": \"$workload\"" "$DIR/bench.json")" = 2
done
# The cube and its plate are 14 triangles: no ray meets more.
few() {
    awk -F: '/"triangles_per_ray"/ { n++; bad += !($2 + 0 > 0 && $2 + 0 <= 14) }
        END { exit !(n == 6 && bad == 0) }' "$DIR/bench.json"
}
ok "no ray meets more triangles than there are" few
ok "a better tree" exits 0 bench "$DIR/cube.obj" --patches 50 --rays 16 --threads 1 --tree high \
    --progress plain --json "$DIR/high.json"
ok "named in both" grep -q '"tree": "medium"' "$DIR/bench.json"
ok "and" grep -q '"tree": "high"' "$DIR/high.json"
ok "said for people too" grep -q 'hemisphere .* a ray meets' "$DIR/err"
ok "a kernel of another name" env ISOLUX_ISA=scalar bash -c \
    "'$ISOLUX' --version | grep -q 'kernel   scalar'"
ok "a kernel that is not there" env ISOLUX_ISA=mmx bash -c \
    "! '$ISOLUX' bench 2>'$DIR/err' && grep -q 'sse4.2' '$DIR/err'"
finish

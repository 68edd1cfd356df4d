#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Pictures with a layer for each light group.
. "$(dirname "$0")/tap.inc"
make_cube "$DIR"
lights=scenes/files/two-lights.msd
fast=(--quality draft --patches 300 --rays 16 --size 40x30 --progress none)
view=(--eye 0.5,0.05,0.4 --target 0.5,1,0.5 --up 0,0,1)

has() { grep -qa "lightgroup\.$2\.R" "$1"; }
same() { cmp -s "$1" "$2"; }

ok "two lights" exits 0 render $lights "${fast[@]}" --light-groups -o "$DIR/a.exr"
ok "a layer of the first" has "$DIR/a.exr" light-1
ok "a layer of the second" has "$DIR/a.exr" light-2
ok "no other" bash -c "! grep -qa 'lightgroup.background' '$DIR/a.exr'"
ok "any number of threads" exits 0 render $lights "${fast[@]}" --light-groups -o "$DIR/b.exr" \
    --threads 1
ok "any number of threads: same bytes" same "$DIR/a.exr" "$DIR/b.exr"
ok "all samples for all pixels" exits 0 render $lights "${fast[@]}" --spp 4 --light-groups \
    -o "$DIR/c.exr"
ok "a lamp of a mesh" exits 0 render "$DIR/cube.obj" "${fast[@]}" "${view[@]}" --light-groups \
    -o "$DIR/d.exr"
ok "it has the group's name" has "$DIR/d.exr" ceiling
ok "dimmed" exits 0 render "$DIR/cube.obj" "${fast[@]}" "${view[@]}" --light-groups \
    --set 'ceiling.emission=*0.5' -o "$DIR/e.exr" --json "$DIR/e.json"
ok "dimmed: mixed" grep -q '"way": "mixed"' "$DIR/e.json"
ok "painted, and a lamp more" exits 0 render "$DIR/cube.obj" "${fast[@]}" "${view[@]}" \
    --light-groups --set plate.emission=2 --set floor.reflectance=0.1 -o "$DIR/f.exr" \
    --json "$DIR/f.json"
ok "painted: solved anew" grep -q '"way": "solved"' "$DIR/f.json"
ok "painted: its own layer" has "$DIR/f.exr" plate
ok "no light at all" exits 0 render "$DIR/cube.obj" "${fast[@]}" "${view[@]}" --light-groups \
    --set ceiling.emission=0 -o "$DIR/g.exr"
ok "dimmed afterwards" exits 0 develop "$DIR/a.exr" --mix light-1=0 --exposure -5 -o "$DIR/m.png"
ok "the other lamp alone" exits 0 develop "$DIR/a.exr" --layer lightgroup.light-2 --exposure -5 \
    -o "$DIR/n.png"
ok "all of it" exits 0 develop "$DIR/a.exr" --exposure -5 -o "$DIR/o.png"
ok "all, once each" exits 0 develop "$DIR/a.exr" --exposure -5 --mix light-1=1 --mix light-2=1,1,1 \
    -o "$DIR/p.png"
ok "is the same" cmp "$DIR/o.png" "$DIR/p.png"
ok "half of it is another" bash -c "! cmp -s '$DIR/m.png' '$DIR/o.png'"
ok "a layer with itself" exits 0 compare "$DIR/a.exr" "$DIR/b.exr" --layer lightgroup.light-1
ok "no such group" fails 3 'no channel lightgroup.sun.R' develop "$DIR/a.exr" --mix sun=2
ok "no factor" fails 2 'wants NAME=FACTOR' develop "$DIR/a.exr" --mix light-1
ok "below 0" fails 2 'wants NAME=FACTOR' develop "$DIR/a.exr" --mix light-1=-1
ok "twice" fails 2 'there twice' develop "$DIR/a.exr" --mix light-1=2 --mix light-1=3
ok "of all layers" fails 2 'not with --layer' develop "$DIR/a.exr" --mix light-1=2 --layer direct
ok "without records" exits 0 render $lights "${fast[@]}" --light-groups --record-rays 0 \
    -o "$DIR/r.exr"
ok "it has the layers too" has "$DIR/r.exr" light-1
ok "not of paths" fails 2 'is of a solution' render $lights --light-groups --renderer path

# Broken off in the picture, whose checkpoint holds the groups; records would make it too quick.
for change in '--set ceiling.emission=*0.5' '--set plate.emission=2'; do
    some=("${fast[@]}" "${view[@]}" --light-groups $change --record-rays 0 \
        --error "$(sized 1% 8%)" --spp 65536)
    ok "unbroken" exits 0 render "$DIR/cube.obj" "${some[@]}" -o "$DIR/h.exr"
    interrupted TERM "grep -q gather '$DIR/err'" render "$DIR/cube.obj" "${some[@]}" \
        -o "$DIR/i.exr" --checkpoint 1h --progress plain
    ok "broken off" test "$CODE" = 5
    ok "resumed" exits 0 render "$DIR/cube.obj" "${some[@]}" -o "$DIR/i.exr" \
        --resume "$DIR/i.exr.checkpoint"
    ok "resumed: same bytes" same "$DIR/h.exr" "$DIR/i.exr"
done
finish

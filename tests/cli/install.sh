#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The installed library as a stranger uses it: headers, pkg-config, both kinds of linking; and gone
# again after `make uninstall`.
set -u
echo 1..6
number=0
tell() { # status name
    number=$((number + 1))
    if [ "$1" = 0 ]; then echo "ok $number - $2"; else echo "not ok $number - $2"; fi
}

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
root=$work/root
prefix=/opt/isolux
read -ra options <<<"$OPT"

install() {
    make --no-print-directory config="$CONFIG" BUILD="$BUILD" CC="$CC" DESTDIR="$root" \
        PREFIX="$prefix" "$1" >"$work/make.log" 2>&1 || { cat "$work/make.log"; false; }
}
install install-files
tell $? "make install with DESTDIR and PREFIX"

export PKG_CONFIG_PATH=$root$prefix/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$root
export LD_LIBRARY_PATH=$root$prefix/lib
cat >"$work/consumer.c" <<'SOURCE'
#include <math.h>
#include <math/shape.h>
#include <stdio.h>

int main(void)
{
    const Affine map = affine_identity();
    Shape sphere;
    Error err = { 0 };
    if (!shape_init(&sphere, SHAPE_SPHERE, 0, &map, &err))
        return 1;
    printf("%.9f\n", shape_area(&sphere, 0, 1, 0, 1) / acos(-1));
    return 0;
}
SOURCE
flags=$(pkg-config --cflags isolux) && libraries=$(pkg-config --libs isolux)
# shellcheck disable=SC2086
"$CC" -std=c17 -Wall -Wextra -Werror "${options[@]}" $flags -o "$work/shared" "$work/consumer.c" \
    $libraries
tell $? "a program compiles with pkg-config alone"
[ "$("$work/shared")" = 4.000000000 ]
tell $? "and knows that a sphere's area is 4 pi"

all=$(pkg-config --static --libs isolux | sed "s|-lisolux|$root$prefix/lib/libisolux.a|")
# shellcheck disable=SC2086
"$CC" -std=c17 "${options[@]}" $flags -o "$work/static" "$work/consumer.c" $all &&
    [ "$("$work/static")" = 4.000000000 ]
tell $? "the static library too"

# A header that leaves out what it needs compiles only by luck: each one alone.
wrong=0
for header in "$root$prefix"/include/isolux/*/*.h; do
    # shellcheck disable=SC2086
    echo "#include <${header#"$root$prefix"/include/isolux/}>" |
        "$CC" -std=c17 -D_GNU_SOURCE -Wall -Werror $flags -fsyntax-only -x c - || wrong=1
done
tell $wrong "each installed header compiles by itself"

install uninstall && [ -z "$(find "$root" -not -type d)" ]
tell $? "make uninstall leaves nothing"

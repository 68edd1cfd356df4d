#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What isolux is built from, as Debian packages.
#
#   deps.sh check [COMPILER OPTIONS]   whether compilers and headers are there, wherever they come from
#   deps.sh install                    installs the packages that are missing; nothing to do: nothing done
set -u

packages='gcc g++ make pkg-config libopenmesh-dev libassimp-dev libopenexr-dev libpng-dev libstb-dev
libjansson-dev libzip-dev libxxhash-dev librandom123-dev libcmocka-dev libglfw3-dev libepoxy-dev libimgui-dev
libgl1-mesa-dri xauth xvfb universal-ctags'

# header  package
headers='assimp/cimport.h libassimp-dev
openexr.h libopenexr-dev
png.h libpng-dev
zip.h libzip-dev
GLFW/glfw3.h libglfw3-dev
epoxy/gl.h libepoxy-dev
imgui/imgui.h libimgui-dev
stb/stb_image.h libstb-dev
jansson.h libjansson-dev
xxhash.h libxxhash-dev
Random123/philox.h librandom123-dev
OpenMesh/Core/System/config.h libopenmesh-dev'

check() {
    missing=
    command -v "${CC%% *}" >/dev/null 2>&1 || missing="$missing $CC"
    command -v "${CXX%% *}" >/dev/null 2>&1 || missing="$missing $CXX"
    if [ -n "$missing" ]; then
        # Nobody to ask for headers: the package list knows.
        missing="$missing$(packages_missing | sed -E 's/\<(gcc|g\+\+)( |$)//g')"
    else
        # One run of the preprocessor asks for all headers.
        missing=$(echo "$headers" | while read -r header package; do
            printf '#if !__has_include(<%s>)\nMISSING %s\n#endif\n' "$header" "$package"
        done | $CC "$@" -E -P -x c - | sed -n 's/^MISSING */ /p' | tr -d '\n')
    fi
    [ -z "$missing" ] && return 0
    echo "isolux: missing:$missing" >&2
    echo "isolux: run \"make deps\", which installs them on Debian and its relatives" >&2
    return 1
}

# Those of the list, and of the arguments, that dpkg does not know as installed.
packages_missing() {
    command -v dpkg-query >/dev/null 2>&1 || return 0
    for package in $packages "$@"; do
        [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] ||
            printf ' %s' "$package"
    done
}

install() {
    if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
        echo "isolux: no Debian here; taking the libraries for installed" >&2
        return 0
    fi
    missing=$(packages_missing "$@")
    [ -z "$missing" ] && return 0
    root=
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null 2>&1 || {
            echo "isolux: missing:$missing" >&2
            echo "isolux: neither root nor sudo; as root: apt-get install$missing" >&2
            return 1
        }
        root=sudo
    fi
    echo "isolux: installing$missing"
    log=$(mktemp) || return 1
    # Not quiet on failure: a mirror that does not answer must be seen.
    if { $root apt-get update && $root env DEBIAN_FRONTEND=noninteractive apt-get install -y \
        --no-install-recommends $missing; } </dev/null >"$log" 2>&1; then
        rm -f "$log"
        return 0
    fi
    cat "$log" >&2
    rm -f "$log"
    return 1
}

case ${1-} in
check | install)
    what=$1
    shift
    "$what" "$@"
    ;;
*)
    echo "usage: deps.sh check|install" >&2
    exit 2
    ;;
esac

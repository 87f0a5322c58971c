#!/usr/bin/env bash
# Installs the Debian packages that a build needs: only those that are missing, and nothing where none is.
#
#   tools/setup.sh base tests viz        groups: base tests viz bench peers fuzz format tidy
#
# Uses sudo only where it is not run by root. On a system without apt-get it prints the list and succeeds, so that a build
# with the same libraries from elsewhere can go on. Exit code 1: something is missing and could not be installed.
set -euo pipefail

packages_of() {
    case "$1" in
        base) echo "g++ cmake ninja-build make pkg-config python3 libglm-dev libeigen3-dev libhwy-dev libxxhash-dev" \
                   "libtbb-dev libfmt-dev nlohmann-json3-dev libcli11-dev libboost-dev libpng-dev" ;;
        # libcgal-demo holds scans and bad meshes that tests read; with what it needs some 80 MB.
        tests) echo "libgtest-dev libgmock-dev libqhull-dev gnuplot-nox libcgal-demo" ;;
        # VTK draws through X and OpenGL: Xvfb is the display, Mesa's llvmpipe the graphics card, xauth is what xvfb-run needs.
        viz) echo "libvtk9-dev libx11-dev xvfb xauth libgl1-mesa-dri libglx-mesa0" ;;
        bench) echo "libbenchmark-dev" ;;
        peers) echo "libbullet-dev libode-dev libembree-dev libfcl-dev libcgal-dev" ;;
        fuzz) echo "clang-16 libclang-rt-16-dev" ;;  # as for tidy
        format) echo "clang-format-14" ;;
        tidy) echo "clang-tidy-16" ;;  # the first in Debian 12 that knows std::source_location
        *) echo "setup: unknown group '$1' (base tests viz bench peers fuzz format tidy)" >&2; return 2 ;;
    esac
}

wanted=()
for group in "${@:-base}"; do
    list=$(packages_of "$group")
    read -ra names <<<"$list"
    wanted+=("${names[@]}")
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "setup: no apt-get here, so nothing was installed. The build needs what Debian 12 calls:"
    printf '    %s\n' "${wanted[@]}"
    exit 0
fi

missing=()
for name in "${wanted[@]}"; do
    state=$(dpkg-query -W -f='${db:Status-Abbrev}' "$name" 2>/dev/null || true)
    [[ $state == ?i* ]] || missing+=("$name")
done
if [ ${#missing[@]} -eq 0 ]; then
    exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "setup: missing packages, and neither root nor sudo to install them. As root, run:" >&2
        echo "    apt-get install --no-install-recommends ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
    echo "setup: ${as_root[*]:+sudo }apt-get $*"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -qq -o Acquire::Retries=3 "$@" >"$log" 2>&1
}
# A stale or missing package list is the usual reason for a failing install; without a network the old list may still do.
apt update || { echo "setup: apt-get update failed, going on with the list that is there:"; tail -n 3 "$log"; }
if ! apt install --no-install-recommends "${missing[@]}"; then
    tail -n 20 "$log" >&2
    echo "setup: could not install: ${missing[*]}" >&2
    exit 1
fi

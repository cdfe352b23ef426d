#!/usr/bin/env bash
# embree.sh CLASS FOLDER : unpacks Debian's Embree for the CPU class into FOLDER/packages and configures a build in FOLDER
# that links embree_cost with it.
set -eu
cd "$(dirname "$0")/.."
. toolchains/with_packages.sh
folder=$(realpath -m "$2")
[ "$1" = aarch64 ] || { echo "embree.sh: Debian has no Embree for $1: try DEVICE=aarch64" >&2; exit 1; }
unpack_once "$folder/packages" usr/include/embree3 libembree-dev libembree3-3 libtbb12 libtbbmalloc2
configure_dynamic "$1" "$folder" -DPOCKETRAY_EMBREE="$folder/packages"

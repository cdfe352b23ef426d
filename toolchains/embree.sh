#!/usr/bin/env bash
# embree.sh CLASS FOLDER : unpacks Debian's Embree for the CPU class into FOLDER/packages and configures a build in FOLDER
# that links embree_cost with it.
set -eu
cd "$(dirname "$0")/.."
class=$1 folder=$(realpath -m "$2")
case $class in
  aarch64) arch=arm64 ;;
  *) echo "embree.sh: Debian has no Embree for $class: try DEVICE=aarch64" >&2; exit 1 ;;
esac
if [ ! -d "$folder/packages/usr/include/embree3" ]; then
  rm -rf "$folder/packages"
  mkdir -p "$folder/packages"
  toolchains/unpack_packages.sh $arch "$folder/packages" libembree-dev libembree3-3 libtbb12 libtbbmalloc2
fi
generator=() launcher=()
! command -v ninja >/dev/null || [ -f "$folder/CMakeCache.txt" ] || generator=(-G Ninja)
! command -v ccache >/dev/null || launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
sysroot=$(toolchains/sysroot.sh "$class")
cmake -S . -B "$folder" ${generator[@]+"${generator[@]}"} ${launcher[@]+"${launcher[@]}"} \
  -DCMAKE_TOOLCHAIN_FILE="$PWD/toolchains/$class.cmake" -DPOCKETRAY_SYSROOT="$sysroot" -DPOCKETRAY_STATIC=OFF \
  -DPOCKETRAY_EMBREE="$folder/packages" >/dev/null

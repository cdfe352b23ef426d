#!/usr/bin/env bash
# sdl2.sh CLASS FOLDER : unpacks Debian's SDL2 for the CPU class into FOLDER/packages and configures a build in FOLDER of a
# program for the device's own SDL2 and C library, with all other libraries inside.
set -eu
cd "$(dirname "$0")/.."
class=$1 folder=$(realpath -m "$2")
case $class in
  aarch64) arch=arm64 ;;
  *) echo "sdl2.sh: SDL2 is used on aarch64 alone, not on $class" >&2; exit 1 ;;
esac
config=$folder/packages/usr/lib/aarch64-linux-gnu/cmake/SDL2
if [ ! -d "$config" ]; then
  rm -rf "$folder/packages"
  mkdir -p "$folder/packages"
  toolchains/unpack_packages.sh $arch "$folder/packages" libsdl2-dev libsdl2-2.0-0
fi
# Debian's SDL_config.h includes another of this architecture, as from /usr/include/aarch64-linux-gnu.
ln -sfn ../aarch64-linux-gnu/SDL2 "$folder/packages/usr/include/SDL2/SDL2"
generator=() launcher=()
! command -v ninja >/dev/null || [ -f "$folder/CMakeCache.txt" ] || generator=(-G Ninja)
! command -v ccache >/dev/null || launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
sysroot=$(toolchains/sysroot.sh "$class")
# Only the device has what its SDL2 needs in turn.
cmake -S . -B "$folder" ${generator[@]+"${generator[@]}"} ${launcher[@]+"${launcher[@]}"} \
  -DCMAKE_TOOLCHAIN_FILE="$PWD/toolchains/$class.cmake" -DPOCKETRAY_SYSROOT="$sysroot" -DPOCKETRAY_STATIC=OFF \
  -DPOCKETRAY_TESTS=OFF -DZLIB_LIBRARY="$sysroot/lib/libz.a" -DSDL2_DIR="$config" -DCMAKE_REQUIRE_FIND_PACKAGE_SDL2=ON \
  -DCMAKE_EXE_LINKER_FLAGS="-Wl,--gc-sections,--allow-shlib-undefined -static-libstdc++ -static-libgcc -s" >/dev/null

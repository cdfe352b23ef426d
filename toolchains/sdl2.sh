#!/usr/bin/env bash
# sdl2.sh CLASS FOLDER : unpacks Debian's SDL2 for the CPU class into FOLDER/packages and configures a build in FOLDER of a
# program for the device's own SDL2 and C library, with all other libraries inside.
set -eu
cd "$(dirname "$0")/.."
. toolchains/with_packages.sh
folder=$(realpath -m "$2")
[ "$1" = aarch64 ] || { echo "sdl2.sh: SDL2 is used on aarch64 alone, not on $1" >&2; exit 1; }
config=usr/lib/aarch64-linux-gnu/cmake/SDL2
unpack_once "$folder/packages" $config libsdl2-dev libsdl2-2.0-0
# Debian's SDL_config.h includes another of this architecture, as from /usr/include/aarch64-linux-gnu.
ln -sfn ../aarch64-linux-gnu/SDL2 "$folder/packages/usr/include/SDL2/SDL2"
# Only the device has what its SDL2 needs in turn.
configure_dynamic "$1" "$folder" -DPOCKETRAY_TESTS=OFF -DZLIB_LIBRARY="$(toolchains/sysroot.sh "$1")/lib/libz.a" \
  -DSDL2_DIR="$folder/packages/$config" -DCMAKE_REQUIRE_FIND_PACKAGE_SDL2=ON \
  -DCMAKE_EXE_LINKER_FLAGS="-Wl,--gc-sections,--allow-shlib-undefined -static-libstdc++ -static-libgcc -s"

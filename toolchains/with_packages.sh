# Sourced: builds for a device class against libraries that Debian has for it, besides those of toolchains/sysroot.sh.

# unpack_once FOLDER PROBE PACKAGE... : Debian's 64-bit ARM packages, unless FOLDER has the file or folder PROBE.
unpack_once() {
  [ ! -e "$1/$2" ] || return 0
  rm -rf "$1"
  mkdir -p "$1"
  toolchains/unpack_packages.sh arm64 "$1" "${@:3}"
}

# configure_dynamic CLASS FOLDER CMAKE-OPTION... : a build in FOLDER whose programs load libraries on the device.
configure_dynamic() {
  local class=$1 folder=$2 sysroot options=()
  ! command -v ninja >/dev/null || [ -f "$folder/CMakeCache.txt" ] || options+=(-G Ninja)
  ! command -v ccache >/dev/null || options+=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  sysroot=$(toolchains/sysroot.sh "$class")
  cmake -S . -B "$folder" ${options[@]+"${options[@]}"} -DCMAKE_TOOLCHAIN_FILE="$PWD/toolchains/$class.cmake" \
    -DPOCKETRAY_SYSROOT="$sysroot" -DPOCKETRAY_STATIC=OFF "${@:3}" >/dev/null
}

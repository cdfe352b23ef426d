#!/usr/bin/env bash
# sysroot.sh CLASS : prints a folder with zlib for the target CPU (include/, lib/libz.a) and links to this machine's header-only
# libraries; makes the folder if needed.
set -eu
cd "$(dirname "$0")/.."
case $1 in
  armhf) arch=armhf ;;
  armel) arch=armel ;;
  aarch64) arch=arm64 ;;
  *) echo "sysroot.sh: unknown CPU class '$1'" >&2; exit 2 ;;
esac
. /etc/os-release
cache=${XDG_CACHE_HOME:-${HOME:-$PWD/build}/.cache}/pocketray
sysroot=$cache/sysroot-${ID:-linux}-${VERSION_CODENAME:-any}-$1
work=$cache/sysroot-$arch.$$
fail() { echo "pocketray: $*" >&2; echo "Alternatively, put zlib.h, zconf.h and a static libz.a for $1 into $sysroot/include and /lib." >&2; exit 1; }

fetch_zlib() {
  mkdir -p "$work/sysroot/include" "$work/sysroot/lib"
  toolchains/unpack_packages.sh "$arch" "$work/unpacked" zlib1g-dev || fail "cannot fetch zlib1g-dev:$arch"
  find "$work/unpacked" -name 'z*.h' -path '*/include/*' -exec cp {} "$work/sysroot/include/" \;
  find "$work/unpacked" -name libz.a -exec cp {} "$work/sysroot/lib/" \;
  [ -f "$work/sysroot/lib/libz.a" ] && [ -f "$work/sysroot/include/zconf.h" ] || fail "zlib1g-dev:$arch has no static library"
  rm -rf "$sysroot"
  mv "$work/sysroot" "$sysroot"
}

if [ ! -f "$sysroot/lib/libz.a" ]; then
  trap 'rm -rf "$work"' EXIT
  echo "pocketray: fetching zlib for $1" >&2
  fetch_zlib
fi
for library in doctest CLI nlohmann; do
  [ ! -d /usr/include/$library ] || ln -sfn /usr/include/$library "$sysroot/include/$library"
done
echo "$sysroot"

#!/usr/bin/env bash
# sysroot.sh CLASS [ZLIB] : prints a folder with zlib for the target CPU (include/, lib/libz.a) and links to this machine's
# header-only libraries; makes the folder if needed. ZLIB: a folder to take zlib from, instead of Debian's package.
set -eu
cd "$(dirname "$0")/.."
zlib=${2:-}
case $1 in
  armhf | armv7) arch=armhf ;;
  armel | armv6) arch=armel ;;
  mips32) arch=mipsel ;;
  aarch64) arch=arm64 ;;
  *) arch= ;;
esac
. /etc/os-release
cache=${XDG_CACHE_HOME:-${HOME:-$PWD/build}/.cache}/pocketray
sysroot=$cache/sysroot-${ID:-linux}-${VERSION_CODENAME:-any}-$1
[ -z "$zlib" ] || sysroot=$cache/sysroot-$(realpath "$zlib" | sha256sum | cut -c 1-12)
work=$cache/sysroot-$1.$$
fail() { echo "pocketray: $*" >&2; [ -n "$zlib" ] || echo "Alternatively, put zlib.h, zconf.h and a static libz.a for it into $sysroot/include and /lib." >&2; exit 1; }

fetch_zlib() {
  mkdir -p "$work/sysroot/include" "$work/sysroot/lib"
  toolchains/unpack_packages.sh "$arch" "$work/unpacked" zlib1g-dev || fail "cannot fetch zlib1g-dev:$arch"
  find "$work/unpacked" -name 'z*.h' -path '*/include/*' -exec cp {} "$work/sysroot/include/" \;
  find "$work/unpacked" -name libz.a -exec cp {} "$work/sysroot/lib/" \;
  [ -f "$work/sysroot/lib/libz.a" ] && [ -f "$work/sysroot/include/zconf.h" ] || fail "zlib1g-dev:$arch has no static library"
  rm -rf "$sysroot"
  mv "$work/sysroot" "$sysroot"
}

if [ -n "$zlib" ]; then
  mkdir -p "$sysroot/include" "$sysroot/lib"
  for name in include/zlib.h include/zconf.h lib/libz.a; do
    [ -f "$zlib/$name" ] || fail "ZLIB=$zlib has no $name"
    cp "$zlib/$name" "$sysroot/$name"
  done
elif [ -z "$arch" ]; then
  fail "Debian has no zlib for this CPU class: give ZLIB=FOLDER with include/zlib.h, include/zconf.h and lib/libz.a"
elif [ ! -f "$sysroot/lib/libz.a" ]; then
  trap 'rm -rf "$work"' EXIT
  echo "pocketray: fetching zlib for $1" >&2
  fetch_zlib
fi
for library in doctest CLI nlohmann; do
  [ ! -d /usr/include/$library ] || ln -sfn /usr/include/$library "$sysroot/include/$library"
done
echo "$sysroot"

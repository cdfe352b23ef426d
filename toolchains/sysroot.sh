#!/usr/bin/env bash
# sysroot.sh CLASS [ZLIB [MBEDTLS]] : prints a folder with zlib for the target CPU (include/, lib/libz.a), mbedTLS if it can be had,
# and links to this machine's header-only libraries; makes the folder if needed. ZLIB, MBEDTLS: folders to take these from,
# instead of Debian's packages, which do not go with another's zlib.
set -eu
cd "$(dirname "$0")/.."
zlib=${2:-} mbedtls=${3:-}
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
[ -z "$zlib$mbedtls" ] || sysroot=$cache/sysroot-$1-$(realpath ${zlib:+"$zlib"} ${mbedtls:+"$mbedtls"} | sha256sum | cut -c 1-12)
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

# Copies mbedTLS from a folder's include/ and the folder of its static libraries.
copy_mbedtls() {  # INCLUDE LIB
  for name in tls x509 crypto; do cp "$2/libmbed$name.a" "$sysroot/lib/" || return 1; done
  rm -rf "$sysroot/include/mbedtls" && cp -r "$1/mbedtls" "$sysroot/include/"
  [ ! -d "$1/psa" ] || cp -rT "$1/psa" "$sysroot/include/psa"
}

# Debian's, tried once; a build without it has no TLS.
fetch_mbedtls() {
  local at
  echo "pocketray: fetching mbedTLS for $1" >&2
  : >"$sysroot/.no-mbedtls"
  toolchains/unpack_packages.sh "$arch" "$work/mbedtls" libmbedtls-dev 2>/dev/null || return 0
  at=$(find "$work/mbedtls" -name libmbedtls.a -exec dirname {} \; | head -n 1)
  [ -z "$at" ] || ! copy_mbedtls "$work/mbedtls/usr/include" "$at" || rm "$sysroot/.no-mbedtls"
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
if [ -n "$mbedtls" ]; then
  for name in include/mbedtls/ssl.h lib/libmbedtls.a lib/libmbedx509.a lib/libmbedcrypto.a; do
    [ -f "$mbedtls/$name" ] || fail "MBEDTLS=$mbedtls has no $name"
  done
  copy_mbedtls "$mbedtls/include" "$mbedtls/lib"
elif [ -z "$zlib" ] && [ ! -f "$sysroot/lib/libmbedtls.a" ] && [ ! -f "$sysroot/.no-mbedtls" ]; then
  trap 'rm -rf "$work"' EXIT
  fetch_mbedtls "$1"
fi
for library in doctest CLI nlohmann; do
  [ ! -d /usr/include/$library ] || ln -sfn /usr/include/$library "$sysroot/include/$library"
done
echo "$sysroot"

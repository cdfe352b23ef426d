#!/usr/bin/env bash
# compiler.sh CLASS [PREFIX [SYSROOT]] : says why a class has no compiler here, and fails, if so.
set -eu
class=$1 prefix=${2:-} sysroot=${3:-}
fail() { printf 'pocketray: %s\n' "$@" >&2; exit 1; }
if [ -n "$prefix" ] && ! command -v "${prefix}g++" >/dev/null; then
  fail "CROSS_PREFIX=$prefix: there is no ${prefix}g++ in PATH"
fi
if [ -n "$sysroot" ] && [ ! -d "$sysroot" ]; then
  fail "SYSROOT=$sysroot: there is no such folder"
fi
[ "$class" = armv4t ] || exit 0
[ -n "$prefix" ] || fail "the ARM920T has no ARMv5 instructions, which Debian's C library needs: give a compiler with a C library for
ARMv4T, as crosstool-NG or a vendor's SDK makes: make DEVICE=armv4t CROSS_PREFIX=arm-920t-linux-gnueabi-"
# The C library's own record of the architecture that it needs.
library=$("${prefix}gcc" -march=armv4t -mfloat-abi=soft -marm ${sysroot:+--sysroot="$sysroot"} -print-file-name=libc.a)
[ -f "$library" ] || fail "there is no libc.a for ARMv4T in ${sysroot:-the folders of ${prefix}gcc}: take a compiler with one, or SYSROOT="
needed=$("${prefix}readelf" -A "$library" 2>/dev/null | sed -n 's/^ *Tag_CPU_arch: //p' | sort -u | tail -n 1)
case $needed in
  v4T | v4) ;;
  '') fail "$library does not tell ${prefix}readelf which ARM it needs: take a compiler with a C library for ARMv4T" ;;
  *) fail "the C library of $prefix needs ARM$needed and the ARM920T is an ARMv4T: take a compiler with another one" ;;
esac

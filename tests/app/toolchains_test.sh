#!/usr/bin/env bash
# toolchains_test.sh ROOT : which compiler and which class toolchains/*.sh choose, and what they say of those that cannot do.
# Method: a vendor's compiler recorded as a script: it tells where its C library is, in a sysroot if given, and for which CPU.
set -u
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
expect() {  # NAME STATUS PATTERN COMMAND... : status and one line that has the pattern
  local name=$1 status=$2 pattern=$3 said got
  shift 3
  said=$("$@" 2>&1)
  got=$?
  said=${said//$'\n'/ }
  { [ $got = "$status" ] && grep -qE -- "$pattern" <<<"$said"; } || { [ $got = "$status" ] && [ -z "$pattern$said" ]; } || {
    echo "FAILED $name: status $got instead of $status, or not '$pattern': $said"
    failures=$((failures + 1))
  }
}
export PATH=$work/bin:$PATH
mkdir -p "$work/bin" "$work/own" "$work/sysroot" "$work/silent"
cat >"$work/bin/arm-vendor-gcc" <<C
#!/bin/sh
folder=$work/own
for argument; do case \$argument in --sysroot=*) folder=\${argument#--sysroot=} ;; esac; done
[ -f "\$folder/libc.a" ] && echo "\$folder/libc.a" || echo libc.a
C
cat >"$work/bin/arm-vendor-readelf" <<'C'
#!/bin/sh
[ ! -s "$2" ] || sed 's/^/  Tag_CPU_arch: /' "$2"
C
ln -s arm-vendor-gcc "$work/bin/arm-vendor-g++"
chmod +x "$work"/bin/*
echo v5TE >"$work/own/libc.a"
echo v4T >"$work/sysroot/libc.a"
: >"$work/silent/libc.a"
mkdir "$work/empty"
compiler() { bash "$root/toolchains/compiler.sh" "$@"; }

for script in "$root"/toolchains/*.sh; do
  [ -x "$script" ] || { echo "FAILED: make cannot run $script, which is not executable"; failures=$((failures + 1)); }
done

expect none_for_armv4t 1 'CROSS_PREFIX=arm-920t' compiler armv4t
expect no_such_prefix 1 'no arm-none-such-g\+\+ in PATH' compiler armhf arm-none-such-
expect another_class 0 '' compiler armhf arm-vendor-
expect no_prefix_for_another_class 0 '' compiler armhf '' "$work/sysroot"
expect library_too_new 1 'needs ARMv5TE' compiler armv4t arm-vendor-
expect library_in_the_sysroot 0 '' compiler armv4t arm-vendor- "$work/sysroot"
expect library_that_does_not_tell 1 'does not tell' compiler armv4t arm-vendor- "$work/silent"
expect no_library 1 'no libc.a' compiler armv4t arm-vendor- "$work/empty"
expect no_sysroot 1 'SYSROOT=.*no such folder' compiler armhf arm-vendor- "$work/none"

device() { bash "$root/toolchains/device.sh" "$@"; }
for pair in miyoo-mini:armhf miyoo:armel gp2x:armv4t pi-zero:armv6 rg350:mips32 portmaster:aarch64 tablet:desktop armv7:armv7; do
  expect "device_${pair%:*}" 0 "^${pair#*:}\$" device "${pair%:*}"
done
expect device_unknown 1 "unknown device .*choose from: .*mips32.* rg350" device toaster
expect device_list_is_none 1 "unknown device" device device-list

# What make passes on, without configuring anything.
vendor=(make -n -C "$root" CROSS_PREFIX=arm-vendor-)
expect make_without_class 0 'toolchains/cross.cmake .*POCKETRAY_CROSS_PREFIX=arm-vendor- .*SYSROOT=.*FLAGS=-mcpu=any' \
  "${vendor[@]}" CROSS_FLAGS=-mcpu=any configure
expect make_takes_the_sysroot 0 "toolchains/armv4t.cmake .*POCKETRAY_CROSS_SYSROOT=$work/sysroot" \
  "${vendor[@]}" DEVICE=armv4t SYSROOT="$work/sysroot" configure
expect make_refuses_the_library 2 'no compiler for armv4t' "${vendor[@]}" DEVICE=armv4t configure
expect make_passes_zlib 0 "sysroot.sh cross \"$work/zlib\"" "${vendor[@]}" ZLIB="$work/zlib" configure
expect count_of_armv4t_is_refused 2 'class armv4t cannot be counted: .* mips32' make -C "$root" CROSS_PREFIX=arm-vendor- \
  DEVICE=armv4t SYSROOT="$work/sysroot" check-bench-class

# Every CPU without floating point gets the kernels in integers, by one macro of ours.
for macro in __SOFTFP__ __mips_soft_float; do
  expect "no_fpu_$macro" 0 POCKETRAY_HAS_NO_FPU "${CXX:-c++}" -D$macro -E -dM -x c++ "$root/src/base/soft_float.h"
done
expect an_fpu 1 '' bash -c '"$1" -E -dM -x c++ "$2" | grep POCKETRAY_HAS_NO_FPU' - "${CXX:-c++}" "$root/src/base/soft_float.h"
expect no_compilers_macro_elsewhere 1 '' grep -rlE '__SOFTFP__|__mips_soft_float' "$root/src" --include=*.cpp \
  --exclude=soft_float_arm.cpp

# A zlib of one's own goes to a folder of its own, and what it lacks is named.
export XDG_CACHE_HOME=$work/cache
mkdir -p "$work/zlib/include" "$work/zlib/lib"
touch "$work/zlib/include/zlib.h" "$work/zlib/lib/libz.a"
expect zlib_lacks_a_header 1 'ZLIB=.* has no include/zconf.h' bash "$root/toolchains/sysroot.sh" cross "$work/zlib"
touch "$work/zlib/include/zconf.h"
expect zlib_is_taken 0 "^$work/cache/pocketray/sysroot-cross-[0-9a-f]+\$" bash "$root/toolchains/sysroot.sh" cross "$work/zlib"
expect zlib_is_there 0 '' test -f "$(echo "$work"/cache/pocketray/sysroot-cross-*/lib/libz.a)"
expect zlib_must_be_given 1 'give ZLIB=FOLDER' bash "$root/toolchains/sysroot.sh" armv4t

[ $failures = 0 ] && echo "toolchains: passed"
exit $((failures > 0))

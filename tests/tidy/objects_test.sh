#!/usr/bin/env bash
# objects_test.sh FOLDER NM OBJDUMP COMPILER [FLAGS...] : checks the compiled core for this CPU.
# Goal: no multiply-add is fused (it would round once where other CPUs round twice); the core uses no heap, no exceptions and
# no libm function that differs between C libraries, and constructs nothing before main().
# Method: disassemble CMake's objects in FOLDER and read their symbols. Then break each rule in a file compiled for the same
# CPU, and see it found.
set -eu
folder=$1 nm=$2 objdump=$3 compiler=$4
shift 4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# x86 (FMA3, FMA4), aarch64, 32-bit ARM (VFPv4 and NEON). ARM's vmla rounds the product first and is allowed.
fused='[[:space:]](vfn?m(add|sub|addsub|subadd)[0-9]*[sp][sd]|fn?m(add|sub)|fml[as]|fmlal2?|vfn?m[as](\.[a-z0-9]+)*)[[:space:]]'
symbols=' U (malloc|calloc|realloc|free|aligned_alloc|posix_memalign|strdup|_Zn[wa].*|_Zd[la].*|__cxa_throw|__cxa_allocate_exception|__cxa_begin_catch|__dynamic_cast|(sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|fma)[fl]?)$'

# Box tests of wide kernels may round once: their bounds are wide enough, and results do not depend on them.
box_test='vfmsub[0-9]*ps[[:space:]].*%xmm'

fused_in() { "$objdump" -d --no-show-raw-insn "$@" | grep -E "$fused" | sort | uniq -c || true; }
symbols_in() { "$nm" -A --undefined-only "$@" | grep -E "$symbols" || true; }
constructors_in() { "$objdump" -h "$@" | grep -E '\.(init_array|ctors)' || true; }

# Weak symbols of kernels for a wider instruction set, outside their own namespace: the linker may choose such a copy
# for all objects, and CPUs without that instruction set would run it. Meaningless without optimisation, as nothing is
# inlined.
weak_in() {
  "$nm" -A --defined-only "$@" | grep -E ' [uVvWw] ' | grep -vE ' [uVvWw] _Z(T[A-Z]|Z)*N[KO]*9pocketray(4avx2|6avx512)' || true
}

failures=0
expect_nothing() {  # TEXT FOUND
  [ -n "$2" ] || return 0
  printf '%s:\n%s\n' "$1" "$2"
  failures=$((failures + 1))
}
expect_found() {  # TEXT FOUND
  [ -z "$2" ] || return 0
  echo "the planted violation was not found: $1"
  failures=$((failures + 1))
}

mapfile -t all < <(find "$folder" -name '*.o' | sort)
mapfile -t core < <(find "$folder" -name '*.o' -not -path '*/src/engine/workers.cpp.o' | sort)
[ ${#core[@]} -gt 0 ] || { echo "no objects in $folder"; exit 1; }
mapfile -t wide < <(find "$folder" -name '*_avx2*.o' -o -name '*_avx512*.o' | sort)
mapfile -t narrow < <(printf '%s\n' "${all[@]}" | grep -vE '_avx(2|512)')
expect_nothing "fused multiply-add" "$(fused_in "${narrow[@]}" | head -n 5)"
if [ ${#wide[@]} -gt 0 ]; then
  expect_nothing "fused multiply-add beyond box tests" "$(fused_in "${wide[@]}" | grep -v "$box_test" | head -n 5 || true)"
fi
expect_nothing "heap, exceptions or libm" "$(symbols_in "${core[@]}")"
expect_nothing "constructors before main()" "$(constructors_in "${core[@]}")"
optimised=0
for flag in "$@"; do
  case $flag in -O0) optimised=0 ;; -O*) optimised=1 ;; esac
done
if [ $optimised = 1 ] && [ ${#wide[@]} -gt 0 ]; then
  expect_nothing "weak symbols of wide kernels" "$(weak_in "${wide[@]}")"
fi

plant() {  # CODE FLAGS... : compiles it into $work/planted.o
  echo "$1" >"$work/planted.cpp"
  shift
  "$compiler" "$@" -c "$work/planted.cpp" -o "$work/planted.o"
}
case $("$compiler" -dumpmachine) in
  x86_64* | i?86*) has_fused="-mfma" ;;
  aarch64* | arm*hf) has_fused="" ;;
  *) has_fused=none ;;
esac
if [ "$has_fused" != none ]; then
  # shellcheck disable=SC2086
  plant 'float f(float a, float b, float c) { return a * b + c; }' "$@" -O2 -ffp-contract=fast $has_fused
  expect_found "fused multiply-add" "$(fused_in "$work/planted.o" | grep -v "$box_test" || true)"
fi
plant '#include <cmath>
float f(float a) { return std::sin(a); }' "$@"
expect_found "libm" "$(symbols_in "$work/planted.o")"
plant 'int* f() { return new int; }' "$@"
expect_found "heap" "$(symbols_in "$work/planted.o")"
plant 'int g(); int value = g();' "$@"
expect_found "constructor" "$(constructors_in "$work/planted.o")"

plant 'namespace pocketray { inline namespace avx2 { template <class T> int own(T) { return 1; } template int own(int); } }
template <class T> int shared(T) { return 2; } template int shared(int);' "$@"
found=$(weak_in "$work/planted.o")
expect_found "weak symbol" "$found"
expect_nothing "weak symbol of its own namespace" "$(grep own <<<"$found" || true)"

echo "${#all[@]} objects, $failures failures"
[ "$failures" = 0 ]

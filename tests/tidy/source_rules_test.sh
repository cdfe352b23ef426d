#!/usr/bin/env bash
# source_rules_test.sh ROOT : ROOT obeys the rules of check_sources.sh, and the checker finds violations. Method: break
# every rule once in a small tree; the report must name the planted file and the rule. Allowed look-alikes must pass.
set -eu
root=$1
check=$(cd "$(dirname "$0")" && pwd)/check_sources.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

plant() {  # FILE LINES... : a tree with only this file
  rm -rf "${tree:?}"/*
  mkdir -p "$tree/src" "$tree/platform" "$tree/tests" "$tree/$(dirname "$1")"
  printf '%s\n' "${@:2}" >"$tree/$1"
}
must_fail() {  # RULE FILE LINES...
  plant "${@:2}"
  local output
  if output=$(bash "$check" "$tree") || ! grep -F "$2:" <<<"$output" | grep -qF "$1"; then
    echo "not found: '$1' in $2: ${*:3}"
    failures=$((failures + 1))
  fi
}
must_pass() {  # FILE LINES...
  plant "$@"
  local output
  if ! output=$(bash "$check" "$tree"); then
    echo "wrongly refused in $1: $output"
    failures=$((failures + 1))
  fi
}

must_fail "(rank 2) must not include shade/shade.h (rank 4)" src/accel/a.cpp '#include "shade/shade.h"'
must_fail "(rank 2) must not include brdf/brdf.h (rank 2)" src/accel/a.h '#include "brdf/brdf.h"'
must_fail "(rank 1) must not include effect/effect.h" src/scene/deep/a.h '#  include "effect/effect.h"'
must_fail "has no rank" src/misc/a.h '#pragma once'
must_fail "folders alone" src/a.cpp '#include <cstdio>'
must_fail "platform/ includes nothing of src/" platform/linux/fb.cpp '#include "base/status.h"'
must_fail "present/ must not include platform/platform.h" src/present/a.cpp '#include "platform/platform.h"'
must_fail "plan/ must not include platform/linux/framebuffer.h" src/plan/a.cpp '#include "platform/linux/framebuffer.h"'
must_fail "by its path" src/app/a.cpp '#include "../base/vec3.h"'
must_fail "includes CLI11" src/app/a_command.cpp '#include <CLI/CLI.hpp>'
must_fail "includes CLI11" tests/app/a_test.cpp '#  include <CLI/App.hpp>'
must_fail "operating system" src/base/a.cpp '#ifdef __linux__' '#endif'
must_fail "operating system" src/app/a.cpp '#if defined(FOO) && defined(_WIN32)' '#endif'
must_fail "exceptions" src/base/a.cpp 'void f() { throw 1; }'
must_fail "exceptions" platform/null/a.cpp 'void f() { try { g(); } catch (...) {} }'
must_fail "heap in the core" src/base/a.cpp 'int* p = new int;'
must_fail "heap in the core" src/accel/a.cpp '/* x */ void* p = malloc(4);'
must_fail "heap in the core" platform/sdl2/a.cpp 'std::free(p);'
must_fail "heap container" src/base/a.cpp 'int* p = new (std::nothrow) int;'
must_fail "heap container" src/shade/a.cpp 'std::vector<int> rows;'
must_fail "header of the heap" src/plan/a.cpp '#include <string>'
must_fail "libm function" src/shade/a.cpp 'float x = std::pow(a, b);'
must_fail "libm function" src/base/a.cpp 'x = sinf (y);'
must_fail "libm function" src/brdf/a.cpp 'x = 2*::acos(y);'
must_fail "libm function" src/brdf/a.cpp 'x = std::fma(a, b, c);'
must_fail "longer than" src/base/a.cpp $(seq 451)
must_fail "longer than" tests/base/a_test.cpp $(seq 451)

# A type defined in another file of the same namespace, with and without members, as a template and with an alignment.
plant_beside() { printf '%s\n' "${@:2}" >"$tree/$1"; }
twice_must() {  # found|allowed FILE OTHER-FILE LINES... : puts these lines in both files
  local output
  plant "$2" "${@:4}"
  mkdir -p "$(dirname "$tree/$3")"
  plant_beside "${@:3}"
  output=$(bash "$check" "$tree") || true
  if grep -q "is defined in .*, too" <<<"$output"; then [ "$1" = found ]; else [ "$1" = allowed ]; fi || {
    echo "types twice must be $1 in $2 and $3: ${*:4}; got: $output"
    failures=$((failures + 1))
  }
}
twice_must found src/plan/a.h src/desktop/import/b.h 'namespace pocketray {' 'struct Storage {' 'int x;' '};' '}'
twice_must found src/plan/a.h platform/b.h 'namespace n {' 'template <class T>' 'class alignas(16) Storage final : Base {};' '}'
twice_must found src/plan/a.h tests/plan/b.h 'namespace {' 'struct X { int y; };' '}' 'namespace n {' 'enum class E : int { a };' '}'
twice_must found tests/plan/a.h tests/plan/b.h 'extern "C" {' 'struct Rig {};' '}'
twice_must allowed tests/plan/a.h tests/wire/b.h 'struct Rig {};'
twice_must allowed src/plan/a.cpp src/desktop/import/b.cpp 'namespace n {' 'namespace {' 'struct Storage {};' '}' 'struct Storage;' '}'
twice_must allowed src/plan/a.cpp src/desktop/import/b.cpp 'void f() {' '  struct Storage {};' 'struct Storage {};' '}'
twice_must allowed src/base/simd_a.h src/base/simd_b.h 'struct Float4 {};'

comment_that_opens() { printf '// %s it.' "$1"; }
twenty=$(yes "$(comment_that_opens Whether)" | head -n 20)
must_fail "opens with a back-reference" src/base/a.h "$twenty" "  $(comment_that_opens 'The same')"
must_pass src/base/a.h "$twenty" "$(comment_that_opens Offset)"
must_pass tests/base/a_test.cpp "$twenty" "$(comment_that_opens Of)"
must_pass src/shade/a.cpp '#include "accel/accel.h"' '#include "shade/b.h"' '#include <cmath>'
must_pass src/app/command_parse.cpp '#include <CLI/CLI.hpp>'
must_pass src/app/a.cpp '#include "platform/platform.h"' '#include <vector>' 'auto p = new std::vector<int>; throw std::pow(1, 2);'
must_pass src/desktop/accuracy/a.cpp '#include "present/pack.h"' '#include <vector>' 'double x = std::pow(a, b);'
must_fail "(rank 6) must not include engine/frame.h (rank 7)" src/desktop/accuracy/a.cpp '#include "engine/frame.h"'
must_fail "(rank 9) must not include viewer/viewer.h (rank 10)" src/remote/client/a.cpp '#include "viewer/viewer.h"'
must_fail "(rank 7) must not include session/open_scene.h (rank 8)" src/engine/a.cpp '#include "session/open_scene.h"'
must_fail "(rank 6) must not include desktop/import/gltf.h (rank 9)" src/desktop/accuracy/a.cpp '#include "desktop/import/gltf.h"'
must_fail "only desktop/ and app/ include desktop/, here desktop/accuracy/flip.h" src/session/a.cpp '#include "desktop/accuracy/flip.h"'
must_pass src/app/a.cpp '#include "desktop/accuracy/flip.h"'
must_fail "folder desktop/games has no rank" src/desktop/games/a.cpp 'int x;'
must_fail "engine/ must not include platform/file.h" src/engine/a.cpp '#include "platform/file.h"'
must_fail "heap container" src/engine/a.cpp 'std::vector<int> rows;'
must_fail "libm function" src/engine/a.cpp 'double x = std::log(y);'
must_pass tests/app/a.cpp '#include "platform/platform.h"' '#include "engine/frame.h"' 'std::string s;'
must_pass src/plan/a.cpp '#include "platform/devices/miyoo_mini.h"'
must_pass platform/linux/a.cpp '#include "platform/platform.h"' '#ifdef __linux__' '#endif'
must_pass tests/platform/a_test.cpp '#ifdef __linux__' '#endif'
must_pass src/accel/a.cpp '#include <new>' 'T* p = new (place) T;'
must_pass src/base/a.cpp 'x = det_pow(a, b); // pow(a, b), a new one' 'const char* s = "malloc(new)";' 'a.exp(b); std::sqrt(2);' \
  '/* throw' 'malloc(4) */ A(const A&) = delete;' $(seq 400)

bash "$check" "$root" || failures=$((failures + 1))
[ "$failures" = 0 ] || { echo "$failures failures"; exit 1; }

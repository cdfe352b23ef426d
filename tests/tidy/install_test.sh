#!/usr/bin/env bash
# install_test.sh SOURCE BUILD COMPILER : an installed copy is enough to build the README's example.
# Method: install BUILD into a fresh prefix, cut the first C++ block out of README.md, build it by the CMake package and by
# pkg-config, run both, and compare the pixel they print with the installed program's own picture. Then what the library
# makes of arguments that it cannot use.
set -eu
source=$1 build=$2 compiler=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
fail() { echo "$*"; exit 1; }

cmake -DCMAKE_INSTALL_PREFIX="$prefix" -P "$build/cmake_install.cmake" >"$work/log" || fail "$(cat "$work/log")"
awk '/^```cpp$/ { inside = 1; next } /^```$/ && inside { exit } inside' "$source/README.md" >"$work/main.cpp"
[ -s "$work/main.cpp" ] || fail "README.md has no block of C++"
[ "$(wc -l <"$work/main.cpp")" -le 20 ] || fail "the example in README.md has grown beyond 20 lines"

cat >"$work/CMakeLists.txt" <<'C'
cmake_minimum_required(VERSION 3.13)
project(example CXX)
find_package(pocketray REQUIRED CONFIG)
add_executable(example main.cpp)
target_link_libraries(example PRIVATE pocketray::pocketray)
C
{ cmake -S "$work" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release &&
  cmake --build "$work/build"; } >"$work/log" 2>&1 || fail "$(cat "$work/log")"
by_cmake=$("$work/build/example")

pc=$(find "$prefix" -name pocketray.pc)
export PKG_CONFIG_PATH=${pc%/*}
# shellcheck disable=SC2046
"$compiler" -O2 -Wall -Wextra -Werror "$work/main.cpp" -o "$work/example" $(pkg-config --cflags --libs pocketray)
by_pkg_config=$("$work/example")

# shellcheck disable=SC2046
"$compiler" -std=c++17 -O1 -Wall -Wextra -Werror "$source/tests/tidy/installed_misuse.cpp" -o "$work/misuse" \
  $(pkg-config --cflags --libs pocketray)
misuse=$("$work/misuse") || fail "the library takes what it cannot use: $misuse"

[ "$by_cmake" = "$by_pkg_config" ] || fail "CMake's example prints '$by_cmake', pkg-config's '$by_pkg_config'"
"$prefix/bin/pocketray" render cornell -o "$work/cornell.ppm" >/dev/null
# Row 120, column 160 of a binary PPM without comments: its pixels are the last 320·240·3 bytes.
pixel=$(tail -c $((320 * 240 * 3)) "$work/cornell.ppm" | od -An -tx1 -v -j $(((120 * 320 + 160) * 3)) -N 3 | tr -d ' \n')
[ "$by_cmake" = "centre pixel: #$pixel" ] || fail "the example prints '$by_cmake'; the program's own picture has #$pixel there"
[ "$pixel" != 000000 ] || fail "the centre of the Cornell scene is black"
echo "$by_cmake"

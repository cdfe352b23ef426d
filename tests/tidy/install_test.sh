#!/usr/bin/env bash
# install_test.sh SOURCE BUILD CXX CC OBJDUMP : an installed copy is enough to embed the renderer, in C and in C++.
# Method: install BUILD into a fresh prefix, extract the C example from README.md, build it with the CMake package and with
# pkg-config, run both, and compare the pixel they print with the installed program's picture. Build tests/api/, which calls
# every function, against the installed header and library, as C and as C++, and compare their pictures with the program's.
# Finally, check the library's symbols: it exports pocketray_… and nothing else.
set -eu
source=$1 build=$2 cxx=$3 cc=$4 objdump=$5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
fail() { echo "$*"; exit 1; }

cmake -DCMAKE_INSTALL_PREFIX="$prefix" -P "$build/cmake_install.cmake" >"$work/log" || fail "$(cat "$work/log")"
awk '/^```c$/ { inside = 1; next } /^```$/ && inside { exit } inside' "$source/README.md" >"$work/main.c"
[ -s "$work/main.c" ] || fail "README.md has no block of C"
[ "$(wc -l <"$work/main.c")" -le 20 ] || fail "the example in README.md has grown beyond 20 lines"

cat >"$work/CMakeLists.txt" <<'C'
cmake_minimum_required(VERSION 3.13)
project(example C CXX)
find_package(pocketray REQUIRED CONFIG)
add_executable(example main.c)
target_link_libraries(example PRIVATE pocketray::pocketray)
C
{ cmake -S "$work" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_BUILD_TYPE=Release &&
  cmake --build "$work/build"; } >"$work/log" 2>&1 || fail "$(cat "$work/log")"
by_cmake=$("$work/build/example")

pc=$(find "$prefix" -name pocketray.pc)
export PKG_CONFIG_PATH=${pc%/*}
strict=(-O1 -pedantic -Wall -Wextra -Wshadow -Werror)
# shellcheck disable=SC2046
"$cc" -std=c99 "${strict[@]}" "$work/main.c" -o "$work/example" $(pkg-config --cflags --libs pocketray)
by_pkg_config=$("$work/example")
[ "$by_cmake" = "$by_pkg_config" ] || fail "CMake's example prints '$by_cmake', pkg-config's '$by_pkg_config'"

"$prefix/bin/pocketray" render cornell --indirect ambient -o "$work/cornell.ppm" >/dev/null
# Row 120, column 160 of a binary PPM without comments: its pixels are the last 320·240·3 bytes.
pixel=$(tail -c $((320 * 240 * 3)) "$work/cornell.ppm" | od -An -tx1 -v -j $(((120 * 320 + 160) * 3)) -N 3 | tr -d ' \n')
[ "$by_cmake" = "centre pixel: #$pixel" ] || fail "the example prints '$by_cmake'; the program's own picture has #$pixel there"
[ "$pixel" != 000000 ] || fail "the centre of the Cornell scene is black"

# shellcheck disable=SC2046
"$cc" -std=c99 "${strict[@]}" "$source"/tests/api/*.c -o "$work/api_c" $(pkg-config --cflags --libs pocketray)
# shellcheck disable=SC2046
"$cxx" -std=c++11 "${strict[@]}" -x c++ "$source"/tests/api/*.c -x none -o "$work/api_cxx" \
  $(pkg-config --cflags --libs pocketray)
"$prefix/bin/pocketray" bake seesaw -o "$work/seesaw.pray" >/dev/null
for program in api_c api_cxx; do
  "$work/$program" "$work/seesaw.pray" >"$work/log" || fail "$program: $(cat "$work/log")"
  for scene in cornell statue; do
    "$work/$program" "$work/seesaw.pray" "$scene" "$work/$program.ppm"
    "$prefix/bin/pocketray" render "$scene" --indirect ambient -o "$work/$scene.ppm" >/dev/null
    cmp "$work/$program.ppm" "$work/$scene.ppm" || fail "$program renders $scene with other pixels than the program"
  done
done

header=$(sed -n 's/^#define POCKETRAY_VERSION_[MP][A-Z]* //p' "$prefix/include/pocketray/pocketray.h" | paste -sd.)
[ "$header" = "$(pkg-config --modversion pocketray)" ] || fail "the header is of $header, the package of another version"

# Symbols that can be seen or clash: defined, global or weak, except the C++ library's own templates.
exported=$("$objdump" -t "$(find "$prefix" -name libpocketray.a)" |
  awk '/^[0-9a-f]+ ([gw!u]| [gw])/ && !/\*UND\*/ { print ($0 ~ /\.hidden/ ? "hidden " : "visible ") $NF }')
grep -q '^hidden _ZN.*9pocketray' <<<"$exported" || fail "no hidden symbol was found: has objdump another format?"
public=$(grep '^visible pocketray_' <<<"$exported" | sort -u)
declared=$(grep -oE '\bpocketray_[a-z_]+\(' "$prefix/include/pocketray/pocketray.h" | tr -d '(' | sort -u)
for function in $declared; do
  grep -qx "visible $function" <<<"$public" || fail "the library has no $function()"
  grep -q "\b$function(" "$source"/tests/api/*.c || fail "tests/api calls $function() nowhere"
done
others=$(grep -vE '^visible pocketray_|^hidden _ZN?[A-Z]*[0-9]*.*9pocketray|^(visible|hidden) _Z(T[A-Z])?[A-Z]*St|^visible DW\.ref\.' <<<"$exported" || true)
[ -z "$others" ] || fail "symbols that are not the library's own: $others"
echo "$by_cmake, $(wc -w <<<"$declared") functions"

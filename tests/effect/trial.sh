#!/usr/bin/env bash
# trial.sh BUILD [CXX]: adds a setting to a copy of the sources, a member of Quality and a row of setting_list.h (and the
# row of PROTOCOL.md required by the wire test), compiles everything generated from the list together with
# setting_list_test.cpp, and runs that. BUILD has this tree's libraries; objects with the new row are linked before them.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd) build=$(cd "$1" && pwd) cxx=${2:-c++}
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r "$root/src" "$root/tests" "$root/platform" "$copy"
cd "$copy"
sed -i 's|^  NormalMode normals = .*|&\n  float sparkle = 0.25f;|' src/effect/settings.h
row='{"sparkle", "how much it sparkles", "", "sparkle", real_field<\&Quality::sparkle>(Quantity::cut_off), 4,'
row+=' bit(Effect::specular), bit(Effect::specular), false, 0, {8, 1, 0.5, 0}, nullptr, ""},'
sed -i "/^inline constexpr SettingRow kSettingList/,/^};/ s|^};|    $row\n};|" src/effect/setting_list.h
sed -i 's/^| effects on, effects off |/| sparkle | 4, real | how much it sparkles, 0–64 |\n&/' src/wire/PROTOCOL.md
sources="src/effect/setting_list.cpp src/plan/front.cpp src/plan/front_text.cpp src/plan/plan_effects.cpp
  src/wire/message.cpp src/session/scene_options.cpp src/app/options.cpp src/accuracy/knob_list.cpp
  tests/effect/setting_list_test.cpp tests/main.cpp"
objects=
for source in $sources; do
  object=$(basename "$source" .cpp).o objects+=" $object"
  "$cxx" -std=c++17 -O0 -I. -Isrc -Itests -DPOCKETRAY_HAVE_NETWORK -DPOCKETRAY_HAVE_ACCURACY \
    -DPOCKETRAY_SOURCE="\"$copy\"" -c "$source" -o "$object"
done
libraries=
for library in app import accuracy platform; do libraries+=" $(ls "$build/libpocketray_$library.a" 2>/dev/null || true)"; done
# shellcheck disable=SC2086
"$cxx" $objects -Wl,--start-group $libraries "$build/libpocketray.a" -Wl,--end-group -lz -lpng -lSDL2 -pthread -o trial
grep -q '"sparkle"' src/effect/setting_list.h && grep -q sparkle src/effect/settings.h && grep -q sparkle src/wire/PROTOCOL.md
./trial >log || { cat log; exit 1; }
tail -2 log
echo "sparkle is a setting everywhere"

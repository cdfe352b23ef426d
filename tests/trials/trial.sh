#!/usr/bin/env bash
# trial.sh [KIND...]: adds an entry of each kind to a copy of the sources, by one file and its entry in one list, and runs
# the suites that loop over that list. KIND is setting, effect, lobe, accelerator, indirect or device; all of them by default.
# Takes minutes: `make trials`.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
export CCACHE_BASEDIR=$copy CCACHE_NOHASHDIR=true
launcher=$(command -v ccache || true)

edited() {  # FILE : fails where an edit found nothing to change
  cmp -s "$root/$1" "$copy/tree/$1" && { echo "trial.sh: an edit of $1 changed nothing"; exit 1; }
  return 0
}
try() {  # KIND SUITE[:CASES]...
  local kind=$1 entry suite
  shift
  for entry; do suites+=" test_${entry%%:*}"; done
  cmake -S . -B "$copy/build" ${launcher:+-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher} ${launcher:+-DCMAKE_C_COMPILER_LAUNCHER=$launcher} \
    -DPOCKETRAY_BENCH=OFF -DPOCKETRAY_SHARED="$root/../shared" >"$copy/log" 2>&1 || { cat "$copy/log"; exit 1; }
  # shellcheck disable=SC2086
  cmake --build "$copy/build" -j "$(nproc)" --target $suites >"$copy/log" 2>&1 || { grep -E 'error|Error' "$copy/log"; exit 1; }
  for entry; do
    suite=${entry%%:*}
    "$copy/build/test_$suite" ${entry#"$suite"} >"$copy/log" 2>&1 || { cat "$copy/log"; exit 1; }
    echo "$kind: $suite passes with one more"
  done
}

for kind in ${@:-setting effect lobe accelerator indirect device}; do
  rm -rf "$copy/tree"
  mkdir "$copy/tree"
  git -C "$root" ls-files -z --deduplicate | (cd "$root" && xargs -0 cp --parents -t "$copy/tree")
  cd "$copy/tree"
  suites=
  case $kind in
    setting)  # a member of Quality, its row, and the row that the protocol's test requires
      sed -i 's|^  NormalMode normals = .*|&\n  float sparkle = 0.25f;|' src/effect/settings.h
      row='{"sparkle", "how much it sparkles", "", "sparkle", real_field<\&Quality::sparkle>(Quantity::cut_off), 4,'
      row+=' bit(Effect::specular), bit(Effect::specular), false, 0, {8, 1, 0.5, 0}, nullptr, ""},'
      sed -i "/^inline constexpr SettingRow kSettingList/,/^};/ s|^};|    $row\n};|" src/effect/setting_list.h
      sed -i 's/^| effects on, effects off |/| sparkle | 4, real | how much it sparkles, 0–64 |\n&/' src/wire/PROTOCOL.md
      for file in src/effect/settings.h src/effect/setting_list.h src/wire/PROTOCOL.md; do edited $file; done
      try setting effect
      ;;
    effect)  # its bit, its row and its rule; the suite writes the table of pairs anew
      count=$(sed -n 's|^constexpr int kEffectCount = \([0-9]*\);|\1|p' src/effect/effect.h)
      sed -i "s|^  sheen,|&\n  glint,|; s|kEffectCount = $count|kEffectCount = $((count + 1))|" src/effect/effect.h
      sed -i 's|^    {Effect::sheen, .*|&\n    {Effect::glint, "glint", "many samples"},|' src/effect/effect_list.h
      rule='{Effect::glint, [](const EffectCall\& c) { return decided(c.settings.samples_per_pixel > 8, "glints"); }},'
      sed -i "s|^    {Effect::animation, .*|&\n    $rule|" src/plan/effects/picture.cpp
      for file in src/effect/effect.h src/effect/effect_list.h src/plan/effects/picture.cpp; do edited $file; done
      POCKETRAY_WRITE=1 try effect plan effect
      ;;
    lobe)
      cp tests/trials/retro.cpp src/brdf/
      sed -i 's/kPhongBrdf;/kPhongBrdf, kRetroBrdf;/; s/&kGgxBrdf}/\&kGgxBrdf, \&kRetroBrdf}/' src/brdf/brdf_list.h
      edited src/brdf/brdf_list.h
      try lobe brdf plan
      ;;
    accelerator)  # brute force by another name
      sed 's/brute/linear/g; s/kBruteAccel/kLinearAccel/g' src/accel/brute.cpp >src/accel/linear.cpp
      sed -i 's/kBruteAccel;/kBruteAccel, kLinearAccel;/; s/&kBruteAccel}/\&kBruteAccel, \&kLinearAccel}/' src/accel/accel_list.h
      edited src/accel/accel_list.h
      try accelerator accel app:-tc=options_*
      ;;
    indirect)  # none by another name
      sed 's/NoIndirect/VoidIndirect/g; s/"none"/"void"/' src/indirect/none.h >src/indirect/void.h
      sed -i 's|^#include "indirect/none.h"|&\n#include "indirect/void.h"|; s|^    NoIndirect, .*|&\n    VoidIndirect,|' src/indirect/indirect_list.h
      edited src/indirect/indirect_list.h
      try indirect indirect
      ;;
    device)
      sed 's/kGp2x/kTrial/; s/"gp2x"/"trial"/' platform/devices/gp2x.h >platform/devices/trial.h
      sed -i 's|^#include "platform/devices/tablet.h"|&\n#include "platform/devices/trial.h"|; s/kTablet,/kTablet, kTrial,/' platform/devices/device_list.h
      edited platform/devices/device_list.h
      try device platform:-tc=device*
      ;;
    *) echo "trial.sh: no kind '$kind': setting, effect, lobe, accelerator, indirect or device" >&2; exit 2 ;;
  esac
done

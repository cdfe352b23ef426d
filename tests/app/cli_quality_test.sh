#!/usr/bin/env bash
# The dial between speed and accuracy. Usage: cli_quality_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: each level gives the picture of its settings; medium is the default, and a setting on the command line wins, even at
# its default. Method: pictures by level and by settings, of a scene without radiosity, whose ambient light the upper
# levels replace.
small=(--size 32x24)
picture() {  # NAME OPTION...
  "${run[@]}" render seesaw "${small[@]}" "${@:2}" -o "$1.ppm" >/dev/null 2>"$1.err" || cat "$1.err"
}
picture usual
picture medium --quality medium
check medium_is_the_default cmp -s usual.ppm medium.ppm
picture draft --quality draft
picture draft_by_settings --depth 2 --area-lights 1 --cut-off 4 --selective .5 --resolution half --light-tolerance .5
check draft_is_its_settings cmp -s draft.ppm draft_by_settings.ppm
picture high --quality high
picture high_by_settings --edge-samples 8 --indirect instant-radiosity --virtual-lights 256 --compensation rays
check high_is_its_settings cmp -s high.ppm high_by_settings.ppm
picture high_without_edges --quality high --edge-samples 0
picture one_sample --indirect instant-radiosity --virtual-lights 256 --compensation rays
check settings_change_the_level cmp -s high_without_edges.ppm one_sample.ppm
picture high_of_two_samples --quality high --samples 2
check samples_leave_out_edges test "$(grep -c 'edge' high_of_two_samples.err)" = 0
check levels_ask_for_nothing_without_effect test "$(grep -c 'has no effect' high.err)" = 0
expect quality_unknown 1 'draft, low, medium, high or best' render cornell "${small[@]}" --quality superb -o refused.png
expect quality_beside_a_budget 2 'excludes' render cornell "${small[@]}" --quality low --budget-ms 40 -o refused.png
expect plan_shows_the_dial 0 '^  high .*edge-samples 0 to 8.*indirect auto to instant-radiosity|^  high .*indirect auto to instant-radiosity.*edge-samples 0 to 8' plan seesaw
expect plan_says_what_measures_it 0 'quality, built in; .pocketray accuracy. measures' plan cornell
# Goal: plan says what baked radiosity would take, unless it is stored or there is nothing to solve.
if "${run[@]}" bake --help 2>/dev/null | grep -q -- --radiosity && "${run[@]}" --help | grep -q '^ *accuracy '; then
  "${run[@]}" bake cube --no-radiosity -o plain.pray >/dev/null
  expect plan_offers_radiosity 0 'would store 0.26 MiB or more; --prices predicts its time' plan plain.pray
  expect plan_offers_radiosity_as_json 0 '"bytes_at_least": 267740' plan plain.pray --json -
  if [ $# -eq 0 ]; then  # emulated, it takes minutes
    expect plan_predicts_radiosity 0 'would take [0-9.]+ s here and store 0.26 MiB' plan plain.pray --prices
    "${run[@]}" bake cube -o lit.pray >/dev/null 2>&1
    "${run[@]}" plan lit.pray >lit.txt
    check plan_offers_no_second_radiosity test "$(grep -c 'radiosity: not stored' lit.txt)" = 0
  fi
fi
expect plan_has_the_dial_as_json 0 '"level": "best"' plan cornell --json -

# Goal: where the scene's front was measured, levels are its points. Method: a front of two candidates in the cache; the
# picture of each by name.
if "${run[@]}" --help | grep -q '^ *accuracy '; then
  for i in 1 2 3; do  # beside other work, the most accurate settings may also be the fastest: no front
    "${run[@]}" accuracy cube --size 16x12 --threads 2 --reference-samples 2 --rounds 1 -o "sweep$i" >/dev/null 2>&1
    ! ls "$XDG_CACHE_HOME"/pocketray/*-2.front >/dev/null 2>&1 || break
  done
  front=$(ls "$XDG_CACHE_HOME"/pocketray/*.front | grep -v -e '-2.front')
  expect plan_knows_the_prices_of_this_machine 0 'priced_here": true' plan cube --threads 2 --json -
  expect plan_says_that_prices_are_of_another 0 'with times of another machine or number of threads' plan cube --threads 1
  rest="depth=8 cut-off=0.5 texture-filter=scene normals=scene indirect=auto reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32"
  rm "$XDG_CACHE_HOME"/pocketray/*-2.front
  printf "pocketray-front 2\nsamples=2 area-lights=1 $rest flip=.4 flip888=.3 ns=100\nsamples=9 area-lights=4 $rest flip=.2 flip888=.1 ns=1e4\n" >"$front"
  expect plan_shows_what_was_measured 0 '^  draft .*ꟻLIP 0.300 +samples 1 to 2, area-lights 4 to 1' plan cube
  expect plan_says_that_it_was_measured 0 'as .pocketray accuracy. measured this scene' plan cube
  "${run[@]}" render cube "${small[@]}" --quality best -o best.ppm >/dev/null
  "${run[@]}" render cube "${small[@]}" --samples 9 -o nine.ppm >/dev/null
  check best_is_the_most_accurate_measured cmp -s best.ppm nine.ppm
  printf 'pocketray-front 1\nsamples=2 area-lights=1 %s flip=.4 ns=1\n' "$rest" >"$front"
  expect plan_ignores_an_older_front 0 'quality, built in' plan cube
fi

finish

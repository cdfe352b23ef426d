#!/usr/bin/env bash
# Time budgets, fronts and their prices. Usage: cli_budget_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: settings along a front keep a time budget; their prices are stored, and the choice is reported. Method: a front of
# one candidate gives the picture of its settings; files in a cache of their own; budgets beyond any machine in both ways.
one="samples=2 depth=1 area-lights=2 cut-off=0 texture-filter=nearest normals=flat indirect=auto reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32"
printf 'pocketray-front 2\n%s flip=0.25 ns=1\n' "$one" >one.front
expect budget_front_file 0 'expected ꟻLIP 0.2500; traded away: nothing' \
  render "$subject" "${small[@]}" --budget-ms 1000000 --front one.front -o budget.ppm
"${run[@]}" render "$subject" "${small[@]}" --samples 2 --depth 1 --area-lights 2 --cut-off 0 --texture-filter nearest \
  --normals flat -o settings.ppm >/dev/null
check budget_gives_the_picture_of_its_settings cmp -s budget.ppm settings.ppm
check budget_keeps_the_price_it_learnt grep -q '^samples=2 depth=1 .* flip=0.25 ns=[0-9.e+]*$' one.front
printf 'pocketray-front 2\n%s flip=0.25 ns=1\n' "$one" >kept.front
expect budget_front_read_only 0 'prices are not saved' \
  render "$subject" "${small[@]}" --budget-ms 1000000 --front /dev/fd/3 -o kept.ppm 3<kept.front
check budget_front_read_only_renders cmp -s budget.ppm kept.ppm
# The scene has neither area lights nor reflections, and the last candidate is dominated: all remain, each with its own
# price.
quality="cut-off=0 texture-filter=nearest normals=flat indirect=auto reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32"
printf "pocketray-front 2\n%s $quality flip=%s ns=%s\n%s $quality flip=%s ns=%s\n%s $quality flip=%s ns=%s\n" \
  'samples=1 depth=1 area-lights=1' 0.5 1 'samples=1 depth=3 area-lights=4' 0.25 2 'samples=2 depth=4 area-lights=1' 0.75 3 \
  >three.front
expect budget_front_of_another_scene 0 'expected ꟻLIP 0.2500' \
  render cube "${small[@]}" --budget-ms 1000000 --front three.front -o found.ppm
check budget_keeps_what_the_scene_ignores test "$(grep -cE 'depth=(1 .*flip=0.5|3 .*flip=0.25|4 .*flip=0.75) ' three.front)" = 3
check budget_prices_what_the_scene_ignores test "$(grep -c 'ns=[123]$' three.front)" = 0
check budget_keeps_no_price_that_was_wrong test "$(grep -c 'ns=1$' one.front)" = 0
expect budget_is_named 0 '^  0.001 ms: ' render "$subject" "${small[@]}" --budget-ms 0.001 -o found.ppm
expect budget_traces_a_quarter 0 '0.001 ms: .*resolution=half' render "$subject" "${small[@]}" --budget-ms 0.001 -o found.ppm
expect budget_too_small 0 "even the front's fastest settings" render "$subject" "${small[@]}" --budget-ms 0.001 -o found.ppm
check budget_in_the_cache test "$(ls cache/of_its_own/pocketray/*.front | wc -l)" = 1
expect budget_of_a_flight 0 '% of 6 frames within 110' \
  render seesaw "${small[@]}" --frames 0:5 --orbit 2 --budget-ms 1000000 -o flight.raw
check budget_flight_moves_the_camera test "$(cat flight-000[0-5].raw | wc -c)" = $((6 * 32 * 24 * 2))
# Goal: a front's reconstructions are planned for. Method: a small triangle under a lamp, whose stored light is at its corners;
# planned with bicubic light, which needs no gradients, and rendered as the front has it.
if [ ${#run[@]} -eq 1 ] && "${run[@]}" bake --help | grep -q -- --radiosity; then  # emulated, it takes minutes
  printf 'newmtl lamp\nKd 0 0 0\nKe 3 3 3\nnewmtl grey\nKd .5 .5 .5\n' >lamp.mtl
  printf '%s\n' 'mtllib lamp.mtl' 'v -5 3 -5' 'v 5 3 -5' 'v 5 3 5' 'v -5 3 5' 'v 0 0 0' 'v 0 0 .3' 'v .3 0 0' \
    'usemtl lamp' 'f 1 2 3 4' 'usemtl grey' 'f 5 6 7' >lamp.obj
  "${run[@]}" bake lamp.obj --radiosity -o lamp.pray >/dev/null 2>&1
  printf 'pocketray-front 2\n%s flip=0.25 ns=1\n' "${one/bicubic/cubic}" >cubic.front
  expect budget_plans_gradients 0 'reconstruction=cubic' \
    render lamp.pray "${small[@]}" --budget-ms 1000000 --front cubic.front -o found.ppm
fi
expect budget_json 0 '"frames_within_110_percent": 1' \
  render cube "${small[@]}" --budget-ms 1000000 --front one.front --json - -o found.ppm
expect budget_excludes_what_it_chooses 2 'excludes' render cube "${small[@]}" --budget-ms 40 --samples 4
for ms in 0 -1 nan inf 1e305 0.0001 soon; do
  expect "budget_no_time_$ms" 1 'budget-ms' render cube "${small[@]}" --budget-ms "$ms"
done
expect front_without_budget 1 'choose from: add --budget-ms' render cube "${small[@]}" --front one.front -o refused.ppm
# Goal: --flip-max takes the fastest settings whose error was measured to be small enough, whatever they take, and with a
# time the best of these. Method: three candidates whose pictures differ; the picture of each by name.
rest="depth=1 area-lights=1 cut-off=0 texture-filter=nearest normals=flat indirect=auto reconstruction=bicubic virtual-lights=64 light-tolerance=0.0625 environment-shadows=32"
printf "pocketray-front 2\nsamples=1 $rest selective=0.5 resolution=half flip=0.1 ns=100\nsamples=1 $rest selective=0 resolution=full flip=0.02 ns=1000\nsamples=9 $rest selective=0 resolution=full flip=0.01 ns=9000\n" >errors.front
cp errors.front as_measured.front
settings=(--depth 1 --area-lights 1 --cut-off 0 --texture-filter nearest --normals flat)
"${run[@]}" render "$subject" "${small[@]}" "${settings[@]}" -o plain.ppm >/dev/null
"${run[@]}" render "$subject" "${small[@]}" "${settings[@]}" --samples 9 -o fine.ppm >/dev/null
"${run[@]}" render "$subject" "${small[@]}" "${settings[@]}" --selective .5 --resolution half -o coarse.ppm >/dev/null
for row in 0.5:coarse:0.1 0.05:plain:0.02 0.02:plain:0.02 0.01:fine:0.01; do
  IFS=: read -r most name error <<<"$row"
  expect "flip_max_$most" 0 "ꟻLIP ≤ $most: samples=. .*expected ꟻLIP ${error}[0-9]*; traded away: " \
    render "$subject" "${small[@]}" --flip-max "$most" --front errors.front -o chosen.ppm
  check "flip_max_${most}_gives_the_picture" cmp -s chosen.ppm "$name.ppm"
  cp as_measured.front errors.front  # with its prices, which are no longer this program's
done
expect flip_max_within_a_time 0 '1000000 ms, ꟻLIP ≤ 0.05: samples=9 ' \
  render "$subject" "${small[@]}" --flip-max .05 --budget-ms 1000000 --front errors.front -o chosen.ppm
check flip_max_within_a_time_is_the_best cmp -s chosen.ppm fine.ppm
expect flip_max_in_json 0 '"flip_max": 0.05' \
  render cube "${small[@]}" --flip-max .05 --front errors.front --json - -o found.ppm
expect flip_max_beyond_the_front 1 'is 0.001, but the most accurate settings of the front err by 0.01: allow' \
  render "$subject" "${small[@]}" --flip-max .001 --front errors.front -o refused.ppm
expect flip_max_not_measured 1 'measure them with `pocketray accuracy`' render "$subject" "${small[@]}" --flip-max .02 -o refused.ppm
expect flip_max_excludes_what_it_chooses 2 'excludes' render cube "${small[@]}" --flip-max .02 --samples 4
expect flip_max_and_looks 2 'excludes' render cube "${small[@]}" --flip-max .02 --background 1,1,1
expect flip_max_aov 1 '--flip-max or --aov' render cube "${small[@]}" --flip-max .02 --aov depth -o refused.ppm
expect flip_max_of_a_view 0 'ꟻLIP ≤ 0.05: samples=1' \
  view "$subject" "${small[@]}" --screen null --frames 2 --flip-max .05 --front as_measured.front
for most in 0 -1 nan 1.5 soon; do expect "flip_max_$most" 1 'flip-max' render cube "${small[@]}" --flip-max "$most"; done
expect front_is_not_there 1 'no such file' render cube "${small[@]}" --budget-ms 40 --front none.front -o refused.ppm
printf 'pocketray-front 2\nsamples=99\n' >bad.front
expect front_is_bad 1 'bad.front: line 2: ' render cube "${small[@]}" --budget-ms 40 --front bad.front -o refused.ppm
expect budget_aov 1 '--aov' render cube "${small[@]}" --budget-ms 40 --aov depth -o refused.ppm
expect orbit_of_a_lone_frame 1 '--frames' render cube "${small[@]}" --orbit 2 -o refused.ppm
expect bench_front 0 'ns per pixel .*samples=1 ' bench cube "${small[@]}" --frames 1 --front new.front
check bench_front_keeps_all test "$(grep -c '^samples=' new.front)" -ge 5
expect front_in_a_folder_that_is_not_there 1 'no/such/folder/new.front' \
  bench cube "${small[@]}" --frames 1 --front no/such/folder/new.front
check front_makes_no_folder test ! -e no
mkdir homeless && cd homeless || exit 1
XDG_CACHE_HOME= HOME= expect budget_without_a_home 0 'prices are not saved' \
  render cube "${small[@]}" --budget-ms 1000000 -o ../found.ppm
check budget_without_a_home_leaves_no_file test -z "$(ls)"
cd ..
expect bench_front_cache 0 'prices saved in .*cache/of_its_own' bench cube "${small[@]}" --frames 1 --front
XDG_CACHE_HOME=/dev/null expect budget_cache_cannot_be_written 0 '/dev/null.*prices are not saved' \
  render cube "${small[@]}" --budget-ms 1000000 -o found.ppm
if [ $# -eq 0 ]; then
  for seconds in 1 4 16 64; do  # a busy machine may still be loading
    still=$(timeout --foreground --preserve-status -s INT $seconds "${run[@]}" view cube --size 8x8 --screen null --budget-ms 100000 2>&1)
    ! grep -q . <<<"$still" || break
  done
  check view_tells_of_its_budget_at_an_interrupt grep -qE '% of [0-9]+ frames? within' <<<"$still"
fi
check bench_front_cache_has_prices_alone test "$(grep -l flip= cache/of_its_own/pocketray/*-*.front | wc -l)" = 0

finish

#!/usr/bin/env bash
# The program as a user meets it: exit statuses, one-line errors, files. Usage: cli_test.sh PROGRAM [EMULATOR...]
# PROGRAM is built with the sealed heap, so every command here also proves that nothing allocates after the seal.
set -u
program=$(realpath "$1")
shift
run=("$@" "$program")
subject=cornell
[ $# -eq 0 ] || subject=seesaw  # sculpting the statue takes an emulated CPU without FPU ten seconds
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
passed=0 failed=0
has_png=$("${run[@]}" render cube --size 8x8 -o probe.png >/dev/null 2>&1 && echo 1 || echo 0)

# expect NAME STATUS PATTERN COMMAND...: the exit status, and a pattern in what it prints.
expect() {
  local name=$1 status=$2 pattern=$3
  shift 3
  local out got
  out=$("${run[@]}" "$@" 2>&1 </dev/null)
  got=$?
  if [ "$got" -ne "$status" ]; then
    echo "FAILED $name: exit $got, expected $status: $out" && failed=$((failed + 1))
  elif ! grep -qE -- "$pattern" <<<"$out"; then
    echo "FAILED $name: '$pattern' is not in: $out" && failed=$((failed + 1))
  elif [ "$status" -eq 1 ] && [ "$(grep -vc '[0-9] %, .* left$' <<<"$out")" -ne 1 ]; then  # but for the progress of slow builds
    echo "FAILED $name: an error must be one line: $out" && failed=$((failed + 1))
  else
    passed=$((passed + 1))
  fi
}
# A server comes into use within some frames, and on a busy machine not within these few: then again.
expect_in_use() {
  local name=$1 pattern=$2
  shift 2
  for _ in 1 2 3 4 5 6 7 8 9; do
    "${run[@]}" "$@" 2>&1 </dev/null | grep -E -- "$pattern" >/dev/null && passed=$((passed + 1)) && return
  done
  expect "$name" 0 "$pattern" "$@"
}
check() {
  local name=$1
  shift
  if "$@"; then passed=$((passed + 1)); else echo "FAILED $name: $*" && failed=$((failed + 1)); fi
}
small=(--size 32x24 --threads 2)

# Goal: help teaches and usage errors are told apart from bad input.
expect help 0 'render +render a frame' --help
expect help_of_command 0 '--area-lights' render --help
expect version 0 '[0-9]+\.[0-9]+' --version
expect no_command 2 'subcommand' 
expect unknown_option 2 'nonsense' render cornell --nonsense
expect unknown_scene 1 'no_such_scene' render no_such_scene -o a.ppm
expect bad_size 1 '320x240' render cube --size 0y3 -o a.ppm
expect bad_size_zero 1 'width' render cube --size 0x3 -o a.ppm
expect bad_ending 1 '\.png' render cube "${small[@]}" -o a.jpeg
expect bad_folder 1 'cannot be written' render cube "${small[@]}" -o no/such/folder/a.ppm
expect bad_depth 1 'depth' render cube "${small[@]}" --depth 99 -o a.ppm
expect bad_effect 1 'no effect' render cube "${small[@]}" --effects auto,-sparkle -o a.ppm
expect bad_camera 1 'VFOV' render cube "${small[@]}" --camera "1 2" -o a.ppm
expect camera_at_its_target 1 'same point' render cube "${small[@]}" --camera "1,1,1 1,1,1 0,1,0 40" -o a.ppm
expect camera_index 1 'no camera 7' render cube "${small[@]}" --camera-index 7 -o a.ppm
expect too_little_memory 1 'memory .*would' render statue --memory 1M -o a.ppm
expect aov_name 1 'depth, normal' render cube "${small[@]}" --aov colour -o a.ppm
expect unknown_device 1 'gp2x' render cube "${small[@]}" --device toaster -o a.ppm
expect device_memory 0 'of 16.0 MiB' plan cornell --device gp2x
expect emulate_unknown 1 "emulate.*gp2x, miyoo" render cube "${small[@]}" --emulate toaster -o a.ppm
expect emulate_and_another_device 1 'name one of them' render cube "${small[@]}" --emulate tablet --device gp2x -o a.ppm
expect emulate_memory 0 'of 16.0 MiB' plan cube --emulate gp2x
expect isa_name 1 'this CPU has baseline' render cube "${small[@]}" --isa sse9 -o a.ppm
expect isa_in_report 0 '2 threads, baseline' bench cube "${small[@]}" --frames 1 --no-prices --isa baseline
expect frames_format 1 'first:last' render seesaw "${small[@]}" --frames 9:3 -o a.ppm

# Goal: every output exists and has its size. Method: PPM and PFM headers and byte counts, raw framebuffers.
expect render_ppm 0 'ns per pixel' render "$subject" "${small[@]}" -o a.ppm
check ppm_size test "$(stat -c %s a.ppm)" -eq $((13 + 32 * 24 * 3))
expect render_pfm 0 'ns per pixel' render "$subject" "${small[@]}" -o a.pfm
check pfm_size test "$(tail -c $((32 * 24 * 12)) a.pfm | wc -c)" -eq $((32 * 24 * 12))
expect render_raw 0 'ns per pixel' render "$subject" "${small[@]}" --raw-format rgb565 --rotate 90 --dither -o a.raw
check raw_size test "$(stat -c %s a.raw)" -eq $((32 * 24 * 2))
for aov in depth normal triangle cost; do expect "aov_$aov" 0 'ns per pixel' render "$subject" "${small[@]}" --aov $aov -o "$aov.pfm"; done
expect sequence 0 'a frame' render seesaw "${small[@]}" --frames 3:5 -o s.ppm
for n in 3 4 5; do check "sequence_file_$n" test -s s-000$n.ppm; done
check no_part_file_is_left test -z "$(ls ./*.part 2>/dev/null)"
if [ "$has_png" = 1 ]; then
  expect render_png 0 'ns per pixel' render "$subject" "${small[@]}" -o a.png
  check png_magic test "$(head -c 8 a.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a
else
  expect png_is_refused 1 'libpng' render "$subject" "${small[@]}" -o a.png
fi

# Goal: the picture depends on nothing it should not depend on.
"${run[@]}" render "$subject" --size 32x24 --threads 1 -o one.ppm >/dev/null
"${run[@]}" render "$subject" --size 32x24 --threads 5 -o five.ppm >/dev/null
check threads_give_one_picture cmp -s one.ppm five.ppm
expect bake 0 'triangles' bake "$subject" -o c.pray
expect render_baked 0 'ns per pixel' render c.pray --size 32x24 -o baked.ppm
check baked_gives_the_same_picture cmp -s one.ppm baked.ppm
"${run[@]}" render "$subject" --size 32x24 --effects all -o all.ppm >/dev/null
check all_effects_give_the_same_picture cmp -s one.ppm all.ppm
for accel in compact brute; do
  "${run[@]}" render "$subject" --size 32x24 --accel $accel -o $accel.ppm >/dev/null
  check "accel_${accel}_gives_the_same_picture" cmp -s one.ppm $accel.ppm
done
expect accel_name 2 'brute' render "$subject" --accel octree -o b.ppm
expect bake_compact 0 'triangles' bake "$subject" --accel compact -o d.pray
check compact_is_smaller test "$(stat -c %s d.pray)" -lt "$(stat -c %s c.pray)"
expect render_baked_compact 0 'ns per pixel' render d.pray --size 32x24 -o baked_compact.ppm
check baked_compact_gives_the_same_picture cmp -s one.ppm baked_compact.ppm
expect plan_baked_compact 0 'accelerator compact' plan d.pray
expect plan_other_than_baked 0 'accelerator bvh' plan d.pray --accel bvh

# Goal: an emulated handheld is slower, has its own screen and cores, and the same picture.
expect emulate 0 '32×24.*1 thread, emulating tablet: 4.47 times slower' render "$subject" --size 32x24 \
  --emulate tablet -o emulated.ppm
check emulated_gives_the_same_picture cmp -s one.ppm emulated.ppm
[ $# -gt 0 ] || expect emulate_screen_and_cores 0 '640×480.*2 threads, emulating miyoo-mini' \
  render cube --emulate miyoo-mini -o large.ppm
expect emulate_in_bench 0 '"emulated": "tablet"' bench cube "${small[@]}" --frames 1 --emulate tablet --json -
expect emulate_in_view 0 '' view cube --size 32x24 --screen null --frames 2 --emulate tablet

# Goal: a file that lies is refused in one line.
head -c 5000 c.pray >cut.pray
expect truncated_scene 1 'cut.pray' render cut.pray -o b.ppm
: >empty.pray
expect empty_scene 1 'empty' render empty.pray -o b.ppm
mkdir folder.pray
expect folder_as_scene 1 "regular file" render folder.pray -o b.ppm
if "${run[@]}" render --help | grep -q glTF; then
  printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' >nan.obj
  expect number_that_is_none 1 "nan.obj: line 2: 'nan' .*export" render nan.obj -o b.ppm
fi
check nothing_was_written test ! -e b.ppm

# Goal: reports.
expect plan 0 'shadow +on' plan "$subject"
expect plan_map 0 'persistent +accelerator' plan "$subject"
expect plan_json 0 '"total_bytes"' plan "$subject" --json -
expect bench 0 'per pixel' bench cube "${small[@]}" --frames 2
expect bench_json 0 '"scanline_ns_per_pixel"' bench cube "${small[@]}" --frames 2 --json -
expect view_null 0 '' view seesaw "${small[@]}" --screen null --frames 3
expect view_still_frames 0 '' view cube "${small[@]}" --screen null --frames 3
export SDL_VIDEODRIVER=dummy  # the emulator, where it is built in
"${run[@]}" view cube "${small[@]}" --screen sdl2 --frames 1 >/dev/null 2>&1
if [ $? -ne 1 ]; then
  expect view_window 0 '' view seesaw "${small[@]}" --screen sdl2 --frames 3
  expect view_emulated 0 '' view cube "${small[@]}" --screen sdl2 --frames 2 --emulate tablet
fi
unset SDL_VIDEODRIVER
expect view_unknown_screen 1 'sdl2' view cube "${small[@]}" --screen crt

# Goal: a time budget is kept by settings along a front, whose prices are kept; what was chosen is said. Method: a front of
# one candidate gives the picture of its settings; files in a cache of their own; budgets beyond any machine in both ways.
export XDG_CACHE_HOME=$folder/cache/of_its_own
one="samples=2 depth=1 area-lights=2 cut-off=0 texture-filter=nearest normals=flat"
printf 'pocketray-front 1\n%s flip=0.25 ns=1\n' "$one" >one.front
expect budget_front_file 0 'expected ꟻLIP 0.2500; gave up: nothing' \
  render "$subject" "${small[@]}" --budget-ms 1000000 --front one.front -o budget.ppm
"${run[@]}" render "$subject" "${small[@]}" --samples 2 --depth 1 --area-lights 2 --cut-off 0 --texture-filter nearest \
  --normals flat -o settings.ppm >/dev/null
check budget_gives_the_picture_of_its_settings cmp -s budget.ppm settings.ppm
check budget_keeps_the_price_it_learnt grep -q '^samples=2 depth=1 .* flip=0.25 ns=[0-9.e+]*$' one.front
# The scene has neither area lights nor reflections, and the last candidate is dominated: all stay, with prices of their own.
quality="cut-off=0 texture-filter=nearest normals=flat"
printf "pocketray-front 1\n%s $quality flip=%s ns=%s\n%s $quality flip=%s ns=%s\n%s $quality flip=%s ns=%s\n" \
  'samples=1 depth=1 area-lights=1' 0.5 1 'samples=1 depth=3 area-lights=4' 0.25 2 'samples=2 depth=4 area-lights=1' 0.75 3 \
  >three.front
expect budget_front_of_another_scene 0 'expected ꟻLIP 0.2500' \
  render cube "${small[@]}" --budget-ms 1000000 --front three.front -o found.ppm
check budget_keeps_what_the_scene_ignores test "$(grep -cE 'depth=(1 .*flip=0.5|3 .*flip=0.25|4 .*flip=0.75) ' three.front)" = 3
check budget_prices_what_the_scene_ignores test "$(grep -c 'ns=[123]$' three.front)" = 0
check budget_keeps_no_price_that_was_wrong test "$(grep -c 'ns=1$' one.front)" = 0
expect budget_is_named 0 '^  0.001 ms: ' render "$subject" "${small[@]}" --budget-ms 0.001 -o found.ppm
expect budget_too_small 0 'even the fastest' render "$subject" "${small[@]}" --budget-ms 0.001 -o found.ppm
check budget_in_the_cache test "$(ls cache/of_its_own/pocketray/*.front | wc -l)" = 1
expect budget_of_a_flight 0 '% of 6 frames within 110' \
  render seesaw "${small[@]}" --frames 0:5 --orbit 2 --budget-ms 1000000 -o flight.raw
check budget_flight_moves_the_camera test "$(cat flight-000[0-5].raw | wc -c)" = $((6 * 32 * 24 * 2))
expect budget_json 0 '"frames_within_110_percent": 1' \
  render cube "${small[@]}" --budget-ms 1000000 --front one.front --json - -o found.ppm
expect budget_excludes_what_it_chooses 2 'excludes' render cube "${small[@]}" --budget-ms 40 --samples 4
for ms in 0 -1 nan inf 1e305 0.0001 soon; do
  expect "budget_no_time_$ms" 2 'budget-ms' render cube "${small[@]}" --budget-ms "$ms"
done
expect front_without_budget 2 'requires' render cube "${small[@]}" --front one.front
expect front_is_not_there 1 'no such file' render cube "${small[@]}" --budget-ms 40 --front none.front -o refused.ppm
printf 'pocketray-front 1\nsamples=99\n' >bad.front
expect front_is_bad 1 'bad.front: line 2: ' render cube "${small[@]}" --budget-ms 40 --front bad.front -o refused.ppm
expect budget_aov 1 '--aov' render cube "${small[@]}" --budget-ms 40 --aov depth -o refused.ppm
expect orbit_of_a_lone_frame 1 '--frames' render cube "${small[@]}" --orbit 2 -o refused.ppm
expect bench_front 0 'ns a pixel .*samples=1 ' bench cube "${small[@]}" --frames 1 --front new.front
check bench_front_keeps_all test "$(grep -c '^samples=' new.front)" -ge 5
expect front_in_a_folder_that_is_not_there 1 'no/such/folder/new.front' \
  bench cube "${small[@]}" --frames 1 --front no/such/folder/new.front
check front_makes_no_folder test ! -e no
mkdir homeless && cd homeless || exit 1
XDG_CACHE_HOME= HOME= expect budget_without_a_home 0 'prices are not kept' \
  render cube "${small[@]}" --budget-ms 1000000 -o ../found.ppm
check budget_without_a_home_leaves_no_file test -z "$(ls)"
cd ..
expect bench_front_cache 0 'prices kept in .*cache/of_its_own' bench cube "${small[@]}" --frames 1 --front
XDG_CACHE_HOME=/dev/null expect budget_cache_cannot_be_written 0 '/dev/null.*prices are not kept' \
  render cube "${small[@]}" --budget-ms 1000000 -o found.ppm
if [ $# -eq 0 ]; then
  for seconds in 1 4 16 64; do  # a busy machine may still be loading
    still=$(timeout --foreground --preserve-status -s INT $seconds "${run[@]}" view cube --size 8x8 --screen null --budget-ms 100000 2>&1)
    ! grep -q . <<<"$still" || break
  done
  check view_tells_of_its_budget_at_an_interrupt grep -qE '% of [0-9]+ frames? within' <<<"$still"
fi
check bench_front_cache_has_prices_alone test "$(grep -l flip= cache/of_its_own/pocketray/*-*.front | wc -l)" = 0
if "${run[@]}" view --help | grep -q split-screen; then
  for reference in model physical; do
    expect split_screen_$reference 0 "RMSE [0-9.]+ from the $reference reference of (1[6-9]|[2-9][0-9]|[1-9][0-9]{2,}) samples" \
      view seesaw "${small[@]}" --screen null --frames 2 --split-screen $reference
  done
  expect split_screen_budget 0 'from the model reference' \
    view cube "${small[@]}" --screen null --frames 2 --split-screen model --budget-ms 1000000
  expect split_screen_unknown 2 'split-screen' view cube --screen null --split-screen none
  ! "${run[@]}" view --help | grep -q -- --server ||
    expect split_screen_of_servers 1 'leave it out, or --server' \
      view cube --screen null --split-screen model --server 127.0.0.1:1
fi
expect view_budget 0 '% of 4 frames within' view seesaw "${small[@]}" --screen null --frames 4 --budget-ms 1000

# Goal: the render server says where it listens, what it offers and why it does not start; it ends when it is told to.
# Method: any free port; an address that others reach; a port that is taken; an interrupt.
if "${run[@]}" --help | grep -q '^ *serve '; then
  expect serve_help 0 'insecure-lan' serve --help
  expect serve_to_others 1 'asks nobody who they are.*--insecure-lan' serve --listen 0.0.0.0:0
  expect serve_without_port 1 'HOST:PORT' serve --listen 127.0.0.1:
  expect serve_without_folder 1 'no/such/folder' serve --listen :0 --scenes no/such/folder
  expect serve_memory 1 'memory' serve --listen :0 --memory 1M
  expect serve_scene_memory 1 '--scene-memory is' serve --listen :0 --scene-memory much
  expect serve_clients 2 'clients' serve --clients 0
fi
if [ $# -eq 0 ] && "${run[@]}" --help | grep -q '^ *serve '; then  # an emulated CPU serves nobody
  mkdir scenes && cp d.pray scenes/ && head -c 5000 c.pray >scenes/cut.pray
  "${run[@]}" serve --listen 127.0.0.1:0 --scenes scenes --threads 2 >serve.out 2>serve.err &
  server=$!
  until grep -q '^listening' serve.out || ! kill -0 $server; do sleep 0.1; done
  check serve_lists_its_scenes grep -q '^ *d.pray ' serve.out
  check serve_leaves_out_what_is_broken test "$(grep -c '^pocketray: cut.pray is left out: ' serve.err)" = 1
  address=$(sed -n 's/^listening at \([0-9.:]*\): .*/\1/p' serve.out)
  check serve_says_where_it_listens grep -qE '^127\.0\.0\.1:[0-9]+$' <<<"$address"

  # Goal: a device without the scene fetches it, one without room for it shows what the server renders: the same pixels.
  expect scenes 0 '^ *d\.pray +45 109 triangles' scenes --server "$address"
  expect scenes_json 0 '"triangles": 45109' scenes --server "$address" --json -
  expect scenes_of_nobody 1 '127.0.0.1:1: nothing listens' scenes --server 127.0.0.1:1
  expect scenes_without_server 2 'server' scenes
  remote=(--size 32x24 --server "$address")
  expect fetch 0 'device rendered [1-9]' render d "${remote[@]}" -o fetched.ppm
  check fetched_scene_gives_the_same_picture cmp -s one.ppm fetched.ppm
  expect fetch_from_the_one_that_has_it 0 'ns per pixel' render d --server 127.0.0.1:1 "${remote[@]}" -o second.ppm
  check second_server_gives_the_same_picture cmp -s one.ppm second.ppm
  expect fetch_unknown 1 'no_such is no file.* 127.*: it has cornell, ' render no_such "${remote[@]}" -o b.ppm
  expect fetch_from_nobody 1 'nothing listens' render no_such --server 127.0.0.1:1 -o b.ppm
  for scene in cornell d d.pray; do
    expect "thin_$scene" 0 'device rendered 0 %' \
      render $scene "${remote[@]}" --memory 700K -o "thin_$scene.ppm"
    check "thin_${scene}_gives_the_same_picture" cmp -s one.ppm "thin_$scene.ppm"
  done
  expect thin_plan 0 'frame +output' render cornell "${remote[@]}" --memory 700K --plan -o b_thin.ppm
  expect thin_says_so 0 'does not fit --memory 0.7M: the servers render every pixel.*M would hold' \
    render cornell "${remote[@]}" --memory 700K -o b_thin.ppm
  turned=(--rotate 90 --dither --exposure 0.5 --camera "0,0,3 0,0,0 0,1,0 40")
  expect raw_alone 0 '' render cornell --size 32x24 "${turned[@]}" -o alone.raw
  expect thin_raw 0 'rendered 0 %' render cornell "${remote[@]}" "${turned[@]}" --memory 700K -o thin.raw
  check thin_raw_is_the_same cmp -s alone.raw thin.raw
  expect raw_shared 0 '' render cornell "${remote[@]}" "${turned[@]}" -o shared.raw
  check shared_raw_is_the_same cmp -s alone.raw shared.raw
  expect seesaw_alone 0 '' render seesaw --size 32x24 --frames 3:5 -o alone.ppm
  expect thin_sequence 0 'rendered 0 %' render seesaw "${remote[@]}" --memory 400K --frames 3:5 -o thin.ppm
  for n in 3 4 5; do check "thin_frame_$n" cmp -s alone-000$n.ppm thin-000$n.ppm; done
  expect thin_view 0 '' view seesaw "${remote[@]}" --memory 500K --screen null --frames 3
  expect thin_without_server 1 'no server can render it; 127.*nothing listens' \
    render cornell --server 127.0.0.1:1 --memory 700K -o b.ppm
  expect thin_camera_index 1 'cannot render with these settings' \
    render cornell "${remote[@]}" --memory 700K --camera-index 7 -o b.ppm
  expect thin_without_room 1 'MiB of memory without a scene' render cornell "${remote[@]}" --memory 64K -o b.ppm
  check no_picture_of_what_failed test ! -e b.ppm
  expect serve_port_is_taken 1 'another program listens' serve --listen "$address"
  kill -INT $server
  wait $server
  check serve_is_interrupted test $? -eq 3
  check serve_prints_totals grep -q '^[1-9][0-9]* clients, [1-9][0-9]* frames' serve.out

  "${run[@]}" serve --listen 127.0.0.1:0 --threads 1 >sharing.out 2>sharing.err &
  server=$!
  until grep -q '^listening' sharing.out || ! kill -0 $server; do sleep 0.1; done
  address=$(sed -n 's/^listening at \([0-9.:]*\): .*/\1/p' sharing.out)

  # Goal: with a server every picture is the one without, byte for byte, however it is packed and whoever renders what.
  # Method: sequences, so that the server comes into use; sealed, as all is here.
  shared=(--size 64x48 --threads 1 --frames 0:7)
  for kind in plain raw share cost; do
    ending=ppm more=() sharing=(--server "$address")
    case $kind in
      raw) ending=raw more=(--raw-format rgb565 --dither --rotate 90) ;;
      share) sharing+=(--share 0.3) ;;
      cost) sharing+=(--price 2 --energy-pixel 1e-6 --energy-byte 1e-6 --cost-weight 3) ;;
    esac
    expect "render_alone_$kind" 0 'a frame' render seesaw "${shared[@]}" "${more[@]}" -o "alone.$ending"
    expect_in_use "render_shared_$kind" 'shared: the device rendered' \
      render seesaw "${shared[@]}" "${more[@]}" "${sharing[@]}" -o "shared.$ending"
    for n in 0 1 2 3 4 5 6 7; do check "shared_${kind}_$n" cmp -s alone-000$n.$ending shared-000$n.$ending; done
  done
  # Goal: a flight around the scene is the same whoever renders it, on a device without the scene, too.
  flight=(--size 32x24 --threads 1 --frames 0:3 --orbit 7)
  expect orbit_alone 0 'a frame' render seesaw "${flight[@]}" -o alone.ppm
  expect orbit_shared 0 'shared: the device rendered' render seesaw "${flight[@]}" --server "$address" -o shared.ppm
  expect orbit_thin 0 'a frame' render seesaw "${flight[@]}" --memory 700K --server "$address" -o thin.ppm
  for n in 0 1 2 3; do
    check "orbit_shared_$n" cmp -s alone-000$n.ppm shared-000$n.ppm
    check "orbit_thin_$n" cmp -s alone-000$n.ppm thin-000$n.ppm
  done
  # Goal: what an emulated device does before a frame takes the device's time, not the device's time of that.
  timeout -k 1 120 "${run[@]}" render seesaw --size 16x12 --frames 0:1 --emulate pi-zero --server "$address" \
    -o paced.ppm >/dev/null
  check emulated_frames_come test $? -eq 0
  expect_in_use render_two_servers 'gave [0-9]+' render seesaw "${shared[@]}" --server "$address" --server "$address" -o two.ppm
  check two_servers_give_the_same_picture cmp -s alone-0007.ppm two-0007.ppm
  expect cost_cap 0 'a frame' render seesaw "${shared[@]}" --server "$address" --price 1 --cost-cap 0.001 -o cap.ppm
  check cost_cap_gives_the_same_picture cmp -s alone-0007.ppm cap-0007.ppm
  expect view_shared 0 '' view seesaw "${small[@]}" --screen null --frames 5 --server "$address"
  one=(render cube "${small[@]}" -o refused.ppm)
  expect server_without_port 1 'HOST:PORT' "${one[@]}" --server 127.0.0.1
  expect server_with_a_wrong_port 1 '99999.*HOST:PORT' "${one[@]}" --server 127.0.0.1:99999
  expect server_with_colons 1 'IPv6' "${one[@]}" --server "$address:1"
  expect server_radiance 1 'radiance' render cube "${small[@]}" -o refused.pfm --server "$address"
  expect server_aov 1 'colours' "${one[@]}" --aov depth --server "$address"
  expect servers_too_many 1 'at most 8' "${one[@]}" $(printf -- "--server $address %.0s" 1 2 3 4 5 6 7 8 9)
  for value in 1.5 -0.5 nan; do expect "share_$value" 1 '0 … 1' "${one[@]}" --server "$address" --share=$value; done
  for option in price energy-pixel energy-byte cost-weight cost-cap; do
    expect "${option}_below_0" 1 'negative' "${one[@]}" --server "$address" --$option=-1
    expect "${option}_without_a_server" 1 '--server' "${one[@]}" --$option=1
  done
  expect price_is_no_number 2 'price' "${one[@]}" --server "$address" --price cheap
  expect cost_weight_and_cap 1 'exclude' "${one[@]}" --server "$address" --cost-weight 1 --cost-cap 1
  expect share_without_a_server 1 '--server' "${one[@]}" --share 0.5
  check nothing_refused_is_written test ! -e refused.ppm -a ! -e refused.pfm

  # Goal: a server that is killed in a sequence is told in one line, and every picture is complete. Method: killed when
  # a few of the frames are there, by an emulated device that takes long enough for each.
  many=(render seesaw --size 96x72 --frames 0:24 --emulate tablet)
  "${run[@]}" "${many[@]}" -o lost.ppm --server "$address" >lost.out 2>lost.err &
  device=$!
  until [ -s lost-0004.ppm ] || ! kill -0 $device; do sleep 0.05; done
  kill -KILL $server
  wait $server 2>/dev/null
  wait $device
  check device_goes_on_without_its_server test $? -eq 0
  check device_tells_the_loss_in_one_line test "$(grep -c "$address.* going on without it" lost.err)" = 1
  check device_tells_nothing_else test "$(grep -vc '[0-9] %, .* left$' lost.err)" = 1
  "${run[@]}" render seesaw --size 96x72 --frames 0:24 -o kept.ppm >/dev/null
  for n in 00 04 05 12 24; do check "frame_${n}_is_complete" cmp -s kept-00$n.ppm lost-00$n.ppm; done
  expect render_without_its_server 0 'going on without it' render seesaw "${shared[@]}" --server "$address" -o gone.ppm
  check without_its_server_the_same_picture cmp -s alone-0007.ppm gone-0007.ppm
  expect view_without_its_server 0 'going on without it' \
    view seesaw "${small[@]}" --screen null --frames 5 --server "$address"

  # Goal: the report on the split in text, JSON and a file; what cannot be is refused; an interrupt keeps what is there.
  report=(split-report cube --size 64x48 --steps 3 --frames 2 --device-ns 5000 --server-ns 500)
  expect split_report 0 '^ *chosen +0\.[0-9]+ ' "${report[@]}"
  expect split_report_paper 0 'Cornell box +2 ' "${report[@]}"
  expect split_report_file 0 '2 servers' "${report[@]}" --servers 2 --no-paper -o .
  check split_report_csv test "$(wc -l <split.csv)" -ge 5
  if command -v python3 >/dev/null; then
    "${run[@]}" "${report[@]}" --json - >figures.json 2>/dev/null
    check split_report_json_keys python3 -c '
import json
f = json.load(open("figures.json"))
assert all(set(f[k]) == {"m", "ns_per_pixel"} for k in ("chosen", "best"))
assert len(f["sweep"]) >= 3 and all(set(p) == {"m", "ns_per_pixel"} for p in f["sweep"])
assert f["best"]["ns_per_pixel"] == min(p["ns_per_pixel"] for p in f["sweep"]) < f["local_ns_per_pixel"]
keys = {"times_of", "processors", "share", "ns_per_pixel", "our_share", "our_ns_per_pixel"}
assert len(f["paper"]) == 6 and all(keys <= set(row) for row in f["paper"])'
  fi
  expect split_report_device 1 'gp2x' split-report cube --emulate toaster
  expect split_report_no_server 2 'servers' "${report[@]}" --servers 0
  expect split_report_many_servers 2 'servers' "${report[@]}" --servers 9
  "${run[@]}" split-report cube --device-ns 5000 --server-ns 500 --frames 100 >/dev/null 2>interrupted.err &
  reporting=$!
  # SIGINT, the second of the signals, is caught: the program runs.
  until grep -qE '^SigCgt:.*[2367abef]$' /proc/$reporting/status || ! kill -0 $reporting; do sleep 0.05; done
  sleep 0.2
  kill -INT $reporting
  wait $reporting
  check split_report_is_interrupted test $? -eq 3
fi

# Goal: a sweep leaves its table and its page, goes on where it was interrupted, and refuses another's folder.
if "${run[@]}" --help | grep -q '^ *accuracy '; then
  tiny=(--size 16x12 --threads 2 --reference-samples 2)
  expect accuracy_without_folder 2 'output-folder' accuracy cube
  expect accuracy_output 1 'rgb565-dithered' accuracy cube "${tiny[@]}" -o sweep --output vga
  expect accuracy_reference 1 'model or physical' accuracy cube "${tiny[@]}" -o sweep --reference best
  expect accuracy_folder 1 'no/such' accuracy cube "${tiny[@]}" -o no/such/folder
  "${run[@]}" accuracy cube "${tiny[@]}" -o sweep --rounds 1000 >/dev/null 2>interrupted.err &
  sweeping=$!
  until grep -qs '"rounds": [1-9]' sweep/accuracy.state || ! kill -0 $sweeping; do sleep 0.05; done
  kill -INT $sweeping
  wait $sweeping
  check accuracy_is_interrupted test $? -eq 3
  check accuracy_says_that_it_is_kept grep -q 'kept in sweep.*same command' interrupted.err
  expect accuracy 0 'index.html shows it' accuracy cube "${tiny[@]}" -o sweep --rounds 1 --json sweep.json
  check accuracy_table grep -q '^samples,16,[0-9]' sweep/accuracy.csv
  check accuracy_json grep -q '"reference_flip": 0' sweep.json
  check accuracy_page grep -q '</html>' sweep/index.html
  # Goal: instructions are counted where something can, and without it nothing else is lost. Method: the baseline's row;
  # where the CPU does not count them, a valgrind that fails, one that an interrupt finds at work, and a program without
  # symbols. Skipped where valgrind is not there or cannot run this program (an emulated CPU, a sanitizer).
  counts() { awk -F, '$1 == "baseline" && $18 > 100 { found = 1 } END { exit !found }' "$1/accuracy.csv"; }
  if [ $# -eq 0 ] && valgrind -q "$program" --version >/dev/null 2>&1; then
    check accuracy_counts counts sweep
    mkdir fake
    printf '#!/bin/sh\nexit 1\n' >fake/valgrind
    chmod +x fake/valgrind
    real_path=$PATH PATH=$PWD/fake:$PATH
    expect accuracy_failing_valgrind 0 'index.html shows it' accuracy cube "${tiny[@]}" -o other --rounds 1 --json other.json
    if ! counts other; then
      check accuracy_tells_that_valgrind_failed grep -q 'not counted: .* valgrind failed' other.json
      cp sweep/accuracy.state counted.state
      expect accuracy_counts_once 0 'by valgrind over the picture, one thread, [a-z0-9]+' accuracy cube "${tiny[@]}" -o sweep --rounds 1
      check accuracy_keeps_counts cmp -s sweep/accuracy.state counted.state
      printf '#!/bin/sh\necho $$ >fake.id.part && mv fake.id.part fake.id\nexec sleep 60\n' >fake/valgrind
      "${run[@]}" accuracy cube "${tiny[@]}" -o other --rounds 1 >/dev/null 2>&1 &
      sweeping=$!
      until [ -s fake.id ] || ! kill -0 $sweeping 2>/dev/null; do sleep 0.05; done
      kill -INT $sweeping
      wait $sweeping
      check accuracy_is_interrupted_when_counting test $? -eq 3
      check accuracy_ends_valgrind test ! -e "/proc/$(cat fake.id)"
      PATH=$real_path
      expect accuracy_counts_after_all 0 'by valgrind over the picture' accuracy cube "${tiny[@]}" -o other --rounds 1
      if strip -o stripped "$program" 2>/dev/null; then
        run=("$PWD/stripped")
        expect accuracy_without_symbols 0 'not counted: .* no symbols' accuracy cube "${tiny[@]}" -o third --rounds 1
        run=("$program")
      fi
    fi
    PATH=$real_path
  else
    echo "skipped: valgrind is not installed or cannot run $program"
  fi
  expect accuracy_other_samples 1 'samples.*--restart' accuracy cube "${tiny[@]}" -o sweep --samples 2
  echo nonsense >sweep/accuracy.state
  expect accuracy_damaged 1 'damaged.*--restart' accuracy cube "${tiny[@]}" -o sweep
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]

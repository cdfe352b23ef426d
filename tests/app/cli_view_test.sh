#!/usr/bin/env bash
# The viewer without a screen. Usage: cli_view_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

expect view_null 0 '' view seesaw "${small[@]}" --screen null --frames 3
expect view_still_frames 0 '' view cube "${small[@]}" --screen null --frames 3
export SDL_VIDEODRIVER=dummy  # the emulator, if built in
"${run[@]}" view cube "${small[@]}" --screen sdl2 --frames 1 >/dev/null 2>&1
if [ $? -ne 1 ]; then
  expect view_window 0 '' view seesaw "${small[@]}" --screen sdl2 --frames 3
  expect view_emulated 0 '' view cube "${small[@]}" --screen sdl2 --frames 2 --emulate tablet
fi
unset SDL_VIDEODRIVER
expect view_unknown_screen 1 'sdl2' view cube "${small[@]}" --screen crt

# Goal: a display that does not answer is no screen; SDL would draw for nobody. Method: one that is not there.
DISPLAY=:77 WAYLAND_DISPLAY= "${run[@]}" view cube "${small[@]}" --screen sdl2 --frames 1 >/dev/null 2>&1
check view_on_a_display_that_is_gone test $? -eq 1

# Goal: without a screen the viewer runs only if asked to, and otherwise reports what it tried. Method: no display, and
# no framebuffer; one that is named and is not there; a folder for screenshots that cannot be.
if [ ! -e /dev/fb0 ]; then
  saved=("${run[@]}")
  run=(env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER "${run[@]}")
  expect view_without_a_screen 1 'no screen found \(.*linux needs a framebuffer, /dev/fb0.*\): choose one with --screen' \
    view cube "${small[@]}" --frames 1
  run=("${saved[@]}")
fi
expect view_no_framebuffer 1 'no/such/fb' view cube "${small[@]}" --framebuffer no/such/fb --frames 1
expect view_screenshots_nowhere 1 'no/such' view cube "${small[@]}" --screen null --frames 1 --screenshots no/such/folder
expect view_screenshots_new 0 '' view cube "${small[@]}" --screen null --frames 1 --screenshots shots
check view_makes_its_folder test -d shots

# Goal: with --log the console stays empty, and the file has every message, those of failures and of earlier runs included.
expect view_logs 0 '' view cube "${small[@]}" --screen null --frames 1 --log view.log
"${run[@]}" view no-such-scene "${small[@]}" --screen null --log view.log >said 2>&1
check view_logs_failures test $? -eq 1
check view_prints_nothing test ! -s said
check view_log_has_the_failure grep -q 'no-such-scene is neither a file' view.log
"${run[@]}" view still-none "${small[@]}" --screen null --log view.log >/dev/null 2>&1
check view_log_keeps_earlier_runs test "$(grep -c 'is neither a file' view.log)" -eq 2
expect view_log_nowhere 1 'no/such/log cannot be written' view cube "${small[@]}" --screen null --frames 1 --log no/such/log

# Goal: the viewer survives a scene being rewritten and reports each state. Method: touch the file until it is reloaded, at
# intervals that leave it at rest for the two looks a reload takes; truncate it; replace it; remove and restore it.
if [ $# -eq 0 ]; then
  "${run[@]}" bake cube -o live.pray >/dev/null
  "${run[@]}" bake seesaw -o other.pray >/dev/null
  cp live.pray good.pray
  : >view.err
  "${run[@]}" view live.pray "${small[@]}" --screen null >view.out 2>view.err &
  viewing=$!
  told() { grep -c "$1" view.err; }
  is_reloaded() { [ "$(told 'live.pray reloaded')" -gt "$1" ]; }
  touch_and_wait() {
    touch live.pray
    local end=$((SECONDS + 3))
    until is_reloaded 0 || [ $SECONDS -ge $end ]; do sleep 0.05; done
    is_reloaded 0
  }
  wait_for $viewing touch_and_wait
  check view_reloads is_reloaded 0
  before=$(told 'reloaded')
  head -c 3000 good.pray >live.pray
  # A read interrupted by the truncation is reported first and retried.
  wait_for $viewing grep -q 'live.pray: .*; keeping the last picture' view.err
  check view_tells_what_is_broken grep -q 'live.pray: .*; keeping the last picture until the file changes' view.err
  check view_stays kill -0 $viewing
  : >live.pray
  wait_for $viewing grep -q 'live.pray is empty' view.err
  check view_tells_the_next_fault grep -q 'live.pray is empty' view.err
  rm live.pray
  cp other.pray live.pray
  wait_for $viewing is_reloaded "$before"
  check view_loads_it_after_all is_reloaded "$before"
  kill -INT $viewing
  wait $viewing
  check view_is_left test $? -eq 3
fi

if "${run[@]}" view --help | grep -q side-by-side; then
  for reference in model physical; do
    expect side_by_side_$reference 0 "RMSE [0-9.]+ from the $reference reference of (1[6-9]|[2-9][0-9]|[1-9][0-9]{2,}) samples" \
      view seesaw "${small[@]}" --screen null --frames 2 --side-by-side $reference
  done
  expect side_by_side_budget 0 'from the model reference' \
    view cube "${small[@]}" --screen null --frames 2 --side-by-side model --budget-ms 1000000
  expect side_by_side_unknown 1 'side-by-side' view cube --screen null --side-by-side none
  ! "${run[@]}" view --help | grep -q -- --server ||
    expect side_by_side_of_servers 1 'drop --side-by-side or --server' \
      view cube --screen null --side-by-side model --server 127.0.0.1:1
fi
expect view_budget 0 '% of 4 frames within' view seesaw "${small[@]}" --screen null --frames 4 --budget-ms 1000

finish

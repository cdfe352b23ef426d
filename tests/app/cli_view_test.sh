#!/usr/bin/env bash
# The viewer on no screen. Usage: cli_view_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

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

finish

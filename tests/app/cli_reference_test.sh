#!/usr/bin/env bash
# References. Usage: cli_reference_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: a reference that was interrupted and continued, or taken in parts and merged, equals one taken at once, bit for
# bit; files that do not fit end with one line; accuracy takes the file.
if "${run[@]}" --help | grep -q '^ *reference '; then
  export XDG_CACHE_HOME=$PWD/cache
  tiny=(reference cube --size 16x12 --threads 2)
  expect reference_at_once 0 'physical reference, 40 samples per pixel, its own error ꟻLIP 0\.[0-9]+' \
    "${tiny[@]}" --samples 40 -o once.pfm --json once.json
  check reference_json grep -q '"samples_per_pixel": 40' once.json
  check reference_regions test "$(grep -c '"columns"' once.json)" -eq 48
  expect reference_part 0 '24 samples per pixel' "${tiny[@]}" --samples 40 --part 1/2 -o first.pfm
  expect reference_other_part 0 '40 samples per pixel' "${tiny[@]}" --samples 40 --part 2/2 -o second.pfm --merge first.pfm
  check reference_of_parts cmp once.pfm second.pfm
  expect reference_twice 1 'first.pfm.*both have samples 0 … 3 of row 0.*--part' "${tiny[@]}" -o second.pfm --merge first.pfm
  expect reference_begun 0 '8 samples' "${tiny[@]}" --samples 8 -o resumed.pfm
  expect reference_resumed 0 '40 samples' "${tiny[@]}" --samples 40 -o resumed.pfm
  check reference_is_resumed cmp once.pfm resumed.pfm
  "${run[@]}" "${tiny[@]}" --until 0.0001 -o stopped.pfm >stopped.out 2>stopped.err &
  tracing=$!
  sleep 1
  kill -INT $tracing
  wait $tracing
  check reference_is_interrupted test $? -eq 3
  check reference_says_that_it_is_kept grep -q 'so far are in stopped.pfm.*same command' stopped.err
  check reference_keeps_samples grep -Eq 'physical reference, [0-9]+ samples' stopped.out
  expect reference_until 0 'ꟻLIP 0\.0[0-7]' "${tiny[@]}" --until 0.08 -o until.pfm
  expect reference_size 1 'once.pfm.*size "16x12", not "16x16"' reference cube --size 16x16 -o once.pfm
  expect reference_scene 1 'once.pfm.*scene' reference furnace --size 16x12 -o once.pfm
  expect reference_camera 1 'once.pfm.*camera' "${tiny[@]}" --camera '0,1,5 0,0,0 0,1,0 40' -o once.pfm
  expect reference_kind 1 'once.pfm.*kind "physical", not "model"' "${tiny[@]}" --kind model -o once.pfm
  expect reference_look 1 'once.pfm.*background unknown, not "1,0,0"' "${tiny[@]}" --background 1,0,0 -o once.pfm
  expect reference_begun_in_red 0 '2 samples' "${tiny[@]}" --background 1,0,0 --samples 2 -o red.pfm
  expect reference_own_look 1 'red.pfm.*background "1,0,0", not the scene' "${tiny[@]}" --samples 2 -o red.pfm
  expect reference_bad_part 1 'K/N' "${tiny[@]}" --part 3/2 -o part.pfm
  expect reference_suffix 1 'pfm' "${tiny[@]}" -o once.png
  expect reference_itself 1 'overwrite the input' "${tiny[@]}" -o once.pfm --merge once.pfm
  head -c 3000 once.pfm >cut.pfm
  expect reference_cut 1 'cut.pfm' "${tiny[@]}" -o cut.pfm
  expect picture 0 '' render cube --size 16x12 -o picture.pfm
  expect reference_picture 1 'without its samples' "${tiny[@]}" -o picture.pfm
  expect accuracy_by_reference 0 '"samples": 40' accuracy cube --size 16x12 --threads 2 --rounds 1 --reference once.pfm -o sweep --json -
  expect accuracy_by_other_reference 1 'once.pfm.*size' accuracy cube --size 8x6 --rounds 1 --reference once.pfm -o other
fi

finish

#!/usr/bin/env bash
# Reports of coherence. Usage: cli_coherence_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: a report compares a sequence in both ways, writes its files, refuses what cannot be compared before any work, and
# keeps finished frames when interrupted.
if "${run[@]}" --help | grep -q '^ *coherence-report '; then
  tiny=(--size 16x12 --threads 2)
  expect coherence_of_a_still_scene 1 'cube does not move.*choose a scene' coherence-report cube "${tiny[@]}" -o still
  expect coherence_without_animation 1 'does not move' coherence-report seesaw "${tiny[@]}" --effects auto,-animation
  expect coherence_frames 1 'last frame comes before' coherence-report seesaw "${tiny[@]}" --frames 3:1
  expect coherence_table 1 'table' coherence-report seesaw "${tiny[@]}" --table 0
  expect coherence_memory 1 'coherence does not fit in --memory: try --memory [0-9]+M' \
    coherence-report seesaw --size 320x240 --threads 1 --memory 2M --frames 0:1
  expect coherence 0 'equal in every bit' coherence-report seesaw "${tiny[@]}" --frames 0:2 -o reported
  for file in index.html report.json frames.csv frames_papers_way.csv rays.gnuplot; do
    check "coherence_writes_$file" test -s reported/$file
  done
  check coherence_csv test "$(wc -l <reported/frames.csv)" -eq 4
  expect coherence_paper 0 '^ +1 .* 0\.3984 .* 0\.6248$' coherence-report seesaw "${tiny[@]}" --frames 0:1
  check coherence_skips_the_paper test "$("${run[@]}" coherence-report seesaw "${tiny[@]}" --frames 0:1 --no-paper 2>&1 | grep -c "paper's way")" -eq 0
  "${run[@]}" coherence-report seesaw "${tiny[@]}" --frames 0:1 --no-paper --json - >alone.json 2>/dev/null
  if command -v python3 >/dev/null; then
    check coherence_json_keys python3 -c '
import json
report = json.load(open("alone.json"))
for key in ("rays", "time", "frame0", "changed", "retraced", "memory", "settings"): assert key in report, key
assert report["retraced"] >= report["changed"] > 0
assert report["papers_way"] is None and len(report["frames"]) == 2'
  fi
  expect coherence_sweeps_the_table 0 '^ +128x128 +8 388 608 ' coherence-report seesaw "${tiny[@]}" --frames 0:1 --no-paper \
    --sweep-table -o swept
  for file in tables.csv tables.gnuplot; do
    check "coherence_writes_$file" test -s swept/$file
  done
  expect coherence_compares 0 '^ +Chapman 1990, frames 16 apart +[01]\.' coherence-report seesaw "${tiny[@]}" --frames 0:1 \
    --no-paper --compare -o compared
  for file in image_space.csv wrong.gnuplot flip.gnuplot; do
    check "coherence_writes_$file" test -s compared/$file
  done
  check coherence_shows_the_comparison grep -q 'Image-space methods' compared/index.html
  expect coherence_compares_single_pixels 1 'leave these out' coherence-report seesaw "${tiny[@]}" --compare --selective 0.2
  "${run[@]}" coherence-report seesaw --size 160x120 --threads 1 --frames 0:99999 -o kept >kept.txt 2>interrupted.err &
  reporting=$!
  # The signal is caught once the first batch is under way at the latest.
  wait_for $reporting grep -qsE '^SigCgt:.*[2367abef]$' /proc/$reporting/status
  sleep 3
  kill -INT $reporting
  wait $reporting
  check coherence_is_interrupted test $? -eq 3
  if [ -s kept.txt ]; then
    check coherence_says_what_is_kept grep -q 'interrupted; [0-9]* finished frames are kept' interrupted.err
    check coherence_keeps_frames test -s kept/report.json
  fi
fi

finish

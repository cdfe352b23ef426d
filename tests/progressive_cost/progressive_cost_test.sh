#!/usr/bin/env bash
# progressive_cost_test.sh PROGRAM : what a frame costs that is shown coarse first and then refined.
# Goal: the whole of it takes at most 1.05 times the instructions of a direct frame, the first picture at most a
# sixteenth, and the pictures are the same. Method: valgrind counts the instructions of tracing, of built-in scenes at
# 320 x 240, one thread.
set -eu
program=$1
valgrind -q --tool=none "$program" cube first >/dev/null 2>&1 || { echo "skipped: valgrind cannot run this program"; exit 77; }

counted() {  # SCENE whole|first|refined
  local count
  count=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=trace_for_counting "$program" "$@" \
    2>&1 >/dev/null | sed -n 's/.*Collected : \([0-9]*\).*/\1/p')
  [ "${count:-0}" -gt 0 ] || { echo "valgrind did not count $*" >&2; exit 1; }
  echo "$count"
}

failures=0
fail() { echo "$*"; failures=$((failures + 1)); }
for scene in cornell statue seesaw; do
  whole=$(counted "$scene" whole) first=$(counted "$scene" first) refined=$(counted "$scene" refined)
  awk -v scene="$scene" -v whole="$whole" -v first="$first" -v refined="$refined" 'BEGIN {
    printf "%-8s %10d instructions direct, %10d refined: %.3f times; first picture %.3f\n", scene, whole, refined,
           refined / whole, first / whole }'
  [ $((refined * 100)) -le $((whole * 105)) ] || fail "$scene: refining takes more than 1.05 times the instructions"
  [ $((first * 16)) -le "$whole" ] || fail "$scene: the first picture takes more than a sixteenth of the frame"
  [ "$("$program" "$scene" whole)" = "$("$program" "$scene" refined)" ] || fail "$scene: the pictures differ"
done
[ "$failures" = 0 ]

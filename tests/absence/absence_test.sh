#!/usr/bin/env bash
# absence_test.sh FOLDER COUNTS COMPILER : an effect that a scene does not call for costs no instruction and no byte.
# Goal: with every effect built in and chosen by the plan, frames of the built-in scenes take at most 0.1 % more instructions
# than in a build without the absent effects (cube, where compilers keep other registers for a tile, 0.3 %; furnace, whose lamps
# light one another, 0.8 %, and lanterns with its 212 lights 1.7 %: each light asks the plan for what may differ); all parts of memory have the same size, and the pictures are the same. With the
# compiler of the committed counts, the instructions of a frame stay within 1 % of them.
# Method: valgrind counts a run of one frame and one of three, so that the start cancels out.
# `absence_test.sh … --write` updates the counts: say in the commit why they changed.
set -eu
folder=$1 counts=$2 compiler=$("$3" --version | head -n 1)
valgrind -q --tool=none "$folder/absence_all" cube 0 >/dev/null 2>&1 || { echo "skipped: valgrind cannot run this program"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

collected() {  # PROGRAM SCENE FRAMES
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 >/dev/null | sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}
frame_of() {  # PROGRAM SCENE : instructions of a frame
  local one three
  one=$(collected "$1" "$2" 1) three=$(collected "$1" "$2" 3)
  [ "${one:-0}" -gt 0 ] && [ "${three:-0}" -gt "$one" ] || { echo "valgrind did not count $*" >&2; exit 1; }
  echo $(((three - one) / 2))
}

failures=0
fail() { echo "$*"; failures=$((failures + 1)); }
echo "# Instructions of a frame of 64 x 48 pixels; written by absence_test.sh --write
compiler $compiler" >"$work/counts"
for program in "$folder"/absence_*; do
  scene=${program##*_}
  [ "$scene" != all ] || continue
  "$program" "$scene" 1 >"$work/without"
  "$folder/absence_all" "$scene" 1 >"$work/all"
  read -r _ effects _ built <"$work/without"
  [ "$effects" = "$built" ] || fail "$scene: built with the effects $built, but its plan has $effects: correct CMakeLists.txt"
  cmp -s <(tail -n +2 "$work/without") <(tail -n +2 "$work/all") || {
    fail "$scene: bytes or pictures differ without the absent effects:"
    diff "$work/without" "$work/all" || true
  }
  without=$(frame_of "$program" "$scene") all=$(frame_of "$folder/absence_all" "$scene")
  printf '%-8s %10d instructions a frame, %10d without the absent effects: %+.3f %%\n' "$scene" "$all" "$without" \
    "$(awk "BEGIN { print 100 * ($all - $without) / $without }")"
  case $scene in furnace) limit=8 ;; lanterns) limit=17 ;; cube) limit=3 ;; *) limit=1 ;; esac  # per mille
  [ $((all * 1000)) -le $((without * (1000 + limit))) ] || fail "$scene: absent effects cost more than $limit/1000"
  echo "$scene $all" >>"$work/counts"
  committed=$(sed -n "s/^$scene //p" "$counts")
  if [ "${4:-}" != --write ] && grep -qxF "compiler $compiler" "$counts" &&
    ! awk "BEGIN { exit !($all <= 1.01 * $committed && $all >= 0.99 * $committed) }"; then
    fail "$scene: $all instructions a frame, $committed committed: run absence_test.sh … --write and say why in the commit"
  fi
done
[ "${4:-}" != --write ] || cp "$work/counts" "$counts"
[ "$failures" = 0 ]

#!/bin/bash
# The full gate of hard cases: runs the tests hard_NN_… and differential_… of the given programs and prints a table:
# case, inputs, wrong answers, bound. JSON=FILE in the environment also writes them as a list of objects. EMULATOR runs
# programs of another CPU. Exit status 1 if any answer is wrong.
set -u
lines=$(mktemp) && log=$(mktemp) || exit 1
trap 'rm -f "$lines" "$log"' EXIT
status=0
for program in "$@"; do
  POCKETRAY_HARDCASES=$lines ${EMULATOR:-} "$program" --test-case='hard_*,differential_*' >"$log" || { status=1; cat "$log"; }
done

sort -o "$lines" "$lines"
awk -F'\t' '
  BEGIN { printf "%-84s %11s %6s  %s\n", "case", "inputs", "wrong", "bound" }
  { printf "%-84s %11d %6d  %s\n", $1, $2, $3, $4; inputs += $2; wrong += $3; seconds += $5 }
  END { printf "%d cases, %d inputs, %d wrong answers, %d s\n", NR, inputs, wrong, seconds; exit NR == 0 || wrong > 0 }
' "$lines" || status=1
if [ -n "${JSON:-}" ]; then
  awk -F'\t' '
    BEGIN { printf "[" }
    { printf "%s\n  {\"case\": \"%s\", \"rays\": %d, \"wrong\": %d, \"bound\": \"%s\"}", (NR > 1 ? "," : ""), $1, $2, $3, $4 }
    END { print "\n]" }
  ' "$lines" >"$JSON" || status=1
fi
exit $status

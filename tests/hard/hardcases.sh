#!/bin/bash
# Runs the hard cases in full: the tests hard_NN_… and differential_… of the programs given. Prints a table of case,
# inputs, wrong answers and bound; with JSON=FILE in the environment, also writes it as a list of objects, and with
# HTML=FILE as a page, which needs python3. EMULATOR runs programs for another CPU. Exit status 1 if any answer is wrong.
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
    {
      printf "%s\n  {\"case\": \"%s\", \"rays\": %d, \"wrong\": %d, \"bound\": \"%s\", \"ordinary\": [", (NR > 1 ? "," : ""), $1, $2, $3, $4
      count = split($6, methods, ";")
      for (i = 1; i <= count; ++i) {
        split(methods[i], m, "|")
        printf "%s{\"method\": \"%s\", \"answer\": \"%s\", \"inputs\": %d, \"wrong\": %d, \"ns\": %.2f, \"our_wrong\": %d, \"our_ns\": %.2f}", \
          (i > 1 ? ", " : ""), m[1], m[2], m[3], m[4], 1e9 * m[5] / m[3], m[6], 1e9 * m[7] / m[3]
      }
      printf "]}"
    }
    END { print "\n]" }
  ' "$lines" >"$JSON" || status=1
fi
if [ -n "${HTML:-}" ]; then
  if command -v python3 >/dev/null; then
    python3 -B "$(dirname "$0")/page/page.py" "$lines" "$HTML" && echo "as a page: $HTML" || status=1
  else
    echo "no page: python3 is missing"
  fi
fi
exit $status

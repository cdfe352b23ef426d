#!/bin/bash
# Runs the hard cases: the tests hard_NN_… and differential_… of the programs given. Prints a table of case, inputs, wrong
# answers and bound, and how many of the programs' tests ran. In the environment, all optional:
#   SHARE=0.01      runs about this share of the full run's inputs
#   SUITES="a b"    runs only test_a and test_b; other tests keep their lines from earlier runs
#   LINES_FILE=FILE keeps a line for each test that ran (support/hard_case.h)
#   JSON=FILE       also writes the table as a list of objects
#   HTML=FILE       also writes a page, which needs python3
#   EMULATOR=…      runs programs for another CPU
# Exit status 1 if an answer is wrong or a test that was to run did not finish.
set -u
awk -v share="${SHARE:-1}" 'BEGIN { exit !(share ~ /^[0-9.]+$/ && share > 0 && share <= 1) }' ||
  { echo "hardcases: SHARE is '$SHARE': it must lie in (0, 1]"; exit 1; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
lines=${LINES_FILE:-$folder/lines} names=$folder/names asked=$folder/asked
: >"$names" && : >"$asked" && touch "$lines" || exit 1
status=0
filter=--test-case='hard_*,differential_*'
suite_of() { local name=${1##*/}; echo "${name#test_}"; }
is_asked_for() { [ -z "${SUITES:-}" ] || [[ " $SUITES " == *" $(suite_of "$1") "* ]]; }

for program in "$@"; do
  listed=$(${EMULATOR:-} "$program" "$filter" --list-test-cases --no-colors) || { echo "$program lists no tests"; exit 1; }
  suite=$(suite_of "$program")
  sed -nE "s/^((hard|differential)_.*)/$suite\t\1/p" <<<"$listed" >>"$names"
  is_asked_for "$program" && sed -nE 's/^((hard|differential)_.*)/\1/p' <<<"$listed" >>"$asked"
done
for suite in ${SUITES:-}; do
  [[ " $* " == *"/test_$suite "* ]] || { echo "hardcases: there is no suite '$suite'"; exit 1; }
done
# Only tests that exist and will not run again keep their lines.
awk -F'\t' 'FILENAME == ARGV[1] { again[$1]; next } FILENAME == ARGV[2] { known[$2]; next } $1 in known && !($1 in again)' \
  "$asked" "$names" "$lines" >"$folder/kept" && cp "$folder/kept" "$lines" || exit 1

for program in "$@"; do
  is_asked_for "$program" || continue
  POCKETRAY_HARDCASES=$lines POCKETRAY_HARDCASES_SHARE=${SHARE:-1} ${EMULATOR:-} "$program" "$filter" >"$folder/log" ||
    { status=1; cat "$folder/log"; }
done

sort -o "$lines" "$lines"
awk -F'\t' '
  BEGIN { printf "%-84s %11s %6s  %s\n", "case", "inputs", "wrong", "bound" }
  FILENAME == ARGV[1] { ++known; suite[$2] = $1; next }
  { printf "%-84s %11d %6d  %s\n", $1, $2, $3, $4; inputs += $2; wrong += $3; seconds += $5; ran += $2 > 0; if ($2 > 0) delete suite[$1] }
  END {
    for (name in suite) printf "not run: %s of test_%s\n", name, suite[name]
    printf "%d of %d tests ran, %d inputs, %d wrong answers, %d s\n", ran, known, inputs, wrong, seconds
    exit ran == 0 || wrong > 0
  }' "$names" "$lines" || status=1
while read -r name; do
  grep -q "^$name	" "$lines" || { echo "$name did not finish"; status=1; }
done <"$asked"
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
    python3 -B "$(dirname "$0")/page/page.py" "$lines" "$names" "$HTML" && echo "as a page: $HTML" || status=1
  else
    echo "no page: python3 is missing"
  fi
fi
exit $status

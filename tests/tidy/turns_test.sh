#!/usr/bin/env bash
# turns_test.sh ROOT : every suite of CI has its turn. Method: plays .ci/turn on a copy of .ci/suites; afterwards no suite may
# have waited for more than three turns, and each turn's minutes must fit. Then doubles the minutes, which must be noticed.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$1/.ci/suites" "$1/.ci/turn" "$folder"
minutes_max=75 failures=0

# The longest wait over twelve turns, and the most minutes of one.
play() {
  local wait=0 most=0 now
  for _ in 1 2 3 4 5 6 7 8 9 10 11 12; do
    "$folder/turn" >/dev/null
    now=$(awk '/^# turn / { turn = $3 } !/^#/ && $3 != "always" && turn - $3 > most { most = turn - $3 } END { print most + 0 }' "$folder/suites")
    [ "$now" -le "$wait" ] || wait=$now
    now=$(awk '/^# turn / { turn = $3 } !/^#/ && ($3 == "always" || $3 == turn) { sum += $2 } END { print sum }' "$folder/suites")
    [ "$now" -le "$most" ] || most=$now
  done
  echo "$wait $most"
}
read -r wait most < <(play)
echo "each suite runs at least once in $((wait + 1)) turns, which take at most $most minutes"
[ "$wait" -le 3 ] || { echo "FAILED: a suite waits for $wait turns: lower the minutes in .ci/suites"; failures=1; }
[ "$most" -le $minutes_max ] || { echo "FAILED: a turn takes $most minutes of $minutes_max"; failures=1; }

sed -i -E '/^#|always/! s/^([^ ]+ +)([0-9]+)/printf "%s%d" "\1" $((2 * \2))/e' "$folder/suites"
read -r wait most < <(play)
[ "$wait" -gt 3 ] || { echo "FAILED: twice the minutes still fit: the test cannot fail"; failures=1; }

# The runner and the list name the same suites.
diff <({ sed -nE 's/^run_suite ([^ $]+) .*/\1/p' "$1/.ci/run"; printf '%s\n' armv7 armv6 mips32; } | sort) \
  <(awk '!/^#/ && NF { print $1 }' "$1/.ci/suites" | sort) || { echo "FAILED: .ci/run and .ci/suites differ"; failures=1; }
exit $failures

#!/usr/bin/env bash
# assertions_test.sh ROOT : the rooms of ROOT keep their assertions: CHECKs per 1,000 lines, counted in each folder of src/ and
# in platform/, stay above a floor.
# Goal: new code comes with its preconditions and invariants, and none are lost in passing. The floors lie a little below what
# there is; a room that has no line here must have the usual number.
# Method: counts statements, not definitions or comments. Then the same on trees with too few, which it must refuse.
set -eu
root=$1
usual=10 overall=15
# Rooms that are arithmetic in innermost loops, or input that is refused by messages, have fewer.
floors='accel=10 accuracy=12 app=0 base=6 brdf=0 import=1 indirect=0 reference=8 remote=21 scene=20 engine=22 plan=28 present=35
  session=19 split=22 wire=18 budget=24 effect=14 shade=11 split_report=21 coherence_report=16 sweep=15 viewer=12 platform=14'

count_checks() {  # ROOT FLOORS OVERALL : a line for each folder, and whether all have enough
  (cd "$1" && find src platform -name '*.h' -o -name '*.cpp' | sort | tr '\n' '\0' | xargs -0 -r awk -v floors="$2" -v usual=$usual -v overall="$3" '
    BEGIN { n = split(floors, entry); for (i = 1; i <= n; ++i) { split(entry[i], pair, "="); floor[pair[1]] = pair[2] } }
    FNR == 1 { split(FILENAME, part, "/"); folder = part[1] != "src" ? part[1] : part[2] == "desktop" ? part[3] : part[2] }
    { ++lines[folder]; ++all_lines }
    /^[ \t]*([a-z][^"\/]*[ ;)])?(PLATFORM_)?CHECK(_[A-Z]+)?\(/ { ++checks[folder]; ++all_checks }
    END {
      for (folder in lines) {
        least = folder in floor ? floor[folder] : usual
        enough = 1000 * checks[folder] >= least * lines[folder]
        printf "%-14s %4d in %5d lines: %4.1f per 1,000%s\n", folder, checks[folder], lines[folder], \
          1000 * checks[folder] / lines[folder], enough ? "" : ", fewer than " least
        failed = failed || !enough
      }
      enough = 1000 * all_checks >= overall * all_lines
      printf "%-14s %4d in %5d lines: %4.1f per 1,000%s\n", "overall", all_checks, all_lines, 1000 * all_checks / all_lines, \
        enough ? "" : ", fewer than " overall
      exit failed || !enough
    }')
}

tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0
plant() {  # FILE CHECKS LINES : a file of so many lines, the first of them checks
  mkdir -p "$tree/src" "$tree/platform" "$tree/$(dirname "$1")"
  { yes '  CHECK_LE(a, b);' | head -n "$2"; yes '// CHECK(a);' | head -n $(($3 - $2)); } >"$tree/$1"
}
must_fail() {  # WHAT
  ! count_checks "$tree" 'poor=2' 0 >"$tree/output" && grep -q "$1" "$tree/output" || {
    echo "not found: $1"
    failures=$((failures + 1))
  }
}
plant src/usual/a.cpp 9 1000
must_fail 'usual .* fewer than 10'
plant src/usual/a.cpp 10 1000
plant src/poor/a.cpp 1 1000
must_fail 'poor .* fewer than 2'
plant src/poor/a.cpp 2 1000
count_checks "$tree" 'poor=2' 6 >"$tree/output" || { echo "wrongly refused: $(cat "$tree/output")"; failures=$((failures + 1)); }
! count_checks "$tree" 'poor=2' 7 >/dev/null || { echo "not found: too few overall"; failures=$((failures + 1)); }

count_checks "$root" "$floors" $overall >"$tree/output" || failures=$((failures + 1))
sort "$tree/output"
[ "$failures" = 0 ]

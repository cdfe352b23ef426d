#!/usr/bin/env bash
# The page of the hard cases.
set -u
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failed=0
check() {
  local name=$1
  shift
  "$@" || { echo "FAILED $name" && failed=1; }
}
not() { ! "$@"; }
page() { python3 -B "$here/page/page.py" lines names page.html; }

# Goal: every figure is a measured one. Method: two tests of a row and one beside an ordinary method, by hand: 3 of 200
# is 1.5 %, 4 µs for 200 answers are 20 ns, 1 µs is 5 ns.
printf 'hard_01_a\t1000\t0\t0 misses\t1.5\t\nhard_01_b\t200\t0\ta < b & c\t0.1\tplain|ray|200|3|4e-06|0|1e-06\ndifferential_x\t5\t0\tbits\t0.0\t\n' >lines
printf 'base\thard_01_a\nbase\thard_01_b\nscene\tdifferential_x\n' >names
check made page
check totals grep -q '0 wrong answers</b> to 1.205 inputs</a>; .*<b>3 of 3 tests</b></a> ran, in 1 rows' page.html
check whole grep -q 'The full run, on' page.html
check complete test -z "$(grep 'did not run' page.html)"
check row grep -q '0</b> wrong</span> of 1.200<' page.html
check share grep -q '1.5 % wrong' page.html
check our_time grep -q '5.0 ns</a> <small>for a ray, <a href="page.csv#row=4">0 wrong of 200<' page.html
check time grep -q '20.0 ns</a></span>' page.html
check linked grep -q '<a href="page.csv#row=4">20.0 ns</a>' page.html
check csv_method grep -qx 'hard_01_b,200,,,,1,plain,ray,3,20,0,5' <(sed -n 4p page.csv)
check row_linked grep -q '<a href="page.csv#row=2;3"><span class="right"><b>0</b> wrong' page.html
check csv_case grep -qx 'hard_01_b,200,0,a < b & c,0.1,1,,,,,,' <(sed -n 3p page.csv)
check escaped grep -q 'a &lt; b &amp; c' page.html
check alone test -z "$(grep -oE '<script|src=|href=.[^#]*|url\(|@import' page.html | grep -vx 'href=.page.csv')"
check well_formed python3 - page.html <<'P'
import html.parser, sys
open_tags = []
class Parser(html.parser.HTMLParser):
    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "br"):
            open_tags.append(tag)
    def handle_startendtag(self, tag, attributes):
        pass
    def handle_endtag(self, tag):
        assert open_tags.pop() == tag, tag
Parser().feed(open(sys.argv[1], encoding="utf-8").read())
assert not open_tags, open_tags
P

# Goal: a wrong answer shows in the totals and its row.
printf 'hard_02_a\t1000\t7\t0 misses\t1.5\t\n' >lines
check made_wrong page
check wrong_total grep -q 'class="wrong">7 wrong answers' page.html
check wrong_row grep -q 'class="wrong"><b>7</b> wrong</span> of 1.000' page.html

# Goal: the page tells which tests it lacks and which share of the inputs ran. Method: one of four tests, a second
# without inputs.
printf 'hard_02_a\t1000\t0\t0 misses\t1.5\t\t0.01\nhard_02_b\t0\t0\tno model\t0\t\t0.01\n' >lines
printf 'base\thard_02_a\nbase\thard_02_b\nscene\thard_02_c\nscene\thard_03_d\n' >names
check made_incomplete page
check ran grep -q '<b>1 of 4 tests</b></a> ran, in 1 rows' page.html
check missing grep -q '3 of 4 tests did not run</b>' page.html
check which grep -q 'test_base: hard_02_b</div><div>test_scene: hard_02_c, hard_03_d</div>' page.html
check in_row grep -q '<summary>1 of 3 tests ran</summary>' page.html
check empty_row grep -q '<span class="wrong"><b>did not run</b></span>' page.html
check some_inputs grep -q 'A run of 1 % of the full run’s inputs' page.html

# Goal: without a case there is no page.
: >lines
check nothing_is_refused test "$(page 2>&1)" = 'page.py: no hard case was run'

# Goal: every row that a test names has a title and a picture.
for row in $(grep -rhoE 'TEST_CASE\("hard_[0-9]+' "$here/.." | grep -oE '[0-9]+' | sort -u); do
  check "row_$row" grep -qE "^    ${row#0}: \(" "$here/page/rows.py"
done

# Goal: tests that ran earlier keep their lines, and what did not run is told. Method: two programs that behave as suites,
# each run alone; then one that ends before its second test.
for suite in base scene; do
  cat >test_$suite <<P
#!/bin/sh
case "\$*" in *--list-test-cases*) echo "[doctest] names"; echo hard_02_$suite; echo hard_03_$suite; exit ;; esac
printf 'hard_02_$suite\\t10\\t0\\tbound\\t1\\t\\t%s\\n' "\$POCKETRAY_HARDCASES_SHARE" >>"\$POCKETRAY_HARDCASES"
[ -z "\$ENDS_EARLY" ] || exit 1
printf 'hard_03_$suite\\t10\\t0\\tbound\\t1\\t\\t%s\\n' "\$POCKETRAY_HARDCASES_SHARE" >>"\$POCKETRAY_HARDCASES"
P
done
chmod +x test_base test_scene
run_suites() { LINES_FILE=kept HTML=page.html bash "$here/hardcases.sh" "$folder/test_base" "$folder/test_scene" >table; }
SUITES=base SHARE=0.5 check alone_runs run_suites
check alone_counted grep -q '^2 of 4 tests ran, 20 inputs, 0 wrong answers' table
check alone_named grep -q '^not run: hard_03_scene of test_scene' table
check alone_shown grep -q '<b>2 of 4 tests</b></a> ran' page.html
SUITES=scene check other_runs run_suites
check both_counted grep -q '^4 of 4 tests ran, 40 inputs' table
check both_shares grep -q 'A run of 50 % to 100 % of the full run' page.html
ENDS_EARLY=1 SUITES=scene check early_end_fails not run_suites
check early_end_told grep -q '^hard_03_scene did not finish' table
check early_end_counted grep -q '^3 of 4 tests ran, 30 inputs' table
check whole_runs run_suites
check whole_counted grep -q '^4 of 4 tests ran, 40 inputs' table
SHARE=2 check share_fails not run_suites
check share_told grep -q "SHARE is '2': it must lie in (0, 1]" table
SUITES=none check unknown_suite_fails not run_suites
exit $failed

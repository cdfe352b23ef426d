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
page() { python3 -B "$here/page/page.py" lines page.html; }

# Goal: every figure is a measured one. Method: two tests of a row and one beside an ordinary method, by hand: 3 of 200
# is 1.5 %, 4 µs for 200 answers are 20 ns, 1 µs is 5 ns.
printf 'hard_01_a\t1000\t0\t0 misses\t1.5\t\nhard_01_b\t200\t0\ta < b & c\t0.1\tplain|ray|200|3|4e-06|0|1e-06\ndifferential_x\t5\t0\tbits\t0.0\t\n' >lines
check made page
check totals grep -q '0 wrong answers</b> to 1.205 inputs of 3 tests in 1 rows' page.html
check row grep -q '0</b> wrong</span> of 1.200<' page.html
check share grep -q '1.5 % wrong' page.html
check our_time grep -q '5.0 ns <small>for a ray, 0 wrong of 200' page.html
check time grep -q '<span>20.0 ns</span>' page.html
check escaped grep -q 'a &lt; b &amp; c' page.html
check alone test -z "$(grep -E '<script|src=|href=|url\(|@import' page.html)"
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

# Goal: without a case there is no page.
: >lines
check nothing_is_refused test "$(page 2>&1)" = 'page.py: no hard case was run'

# Goal: every row that a test names has a title and a picture.
for row in $(grep -rhoE 'TEST_CASE\("hard_[0-9]+' "$here/.." | grep -oE '[0-9]+' | sort -u); do
  check "row_$row" grep -qE "^    ${row#0}: \(" "$here/page/rows.py"
done
exit $failed

#!/usr/bin/env bash
# documents_test.sh ROOT : the documents of ROOT keep the rules of check_documents.sh, and the checker finds what breaks them.
# Method: every rule is broken once in a small tree of its own; the report must name file, line and rule. Look-alikes must pass.
set -eu
root=$1
check=$(cd "$(dirname "$0")" && pwd)/check_documents.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

plant() {  # LINES... : a tree in which docs/a.md has these lines
  rm -rf "${tree:?}"/*
  mkdir -p "$tree/docs" "$tree/build"
  touch "$tree/picture.png" "$tree/build/made.png"
  printf '%s\n' '# Title' 'Text.' '## The `split`, in short' >"$tree/docs/b.md"
  printf '%s\n' "$@" >"$tree/docs/a.md"
}
must_fail() {  # LINE RULE LINES...
  plant "${@:3}"
  local output
  if output=$(bash "$check" "$tree") || ! grep -qF "docs/a.md:$1: $2" <<<"$output"; then
    echo "not found: '$2' in: ${*:3}; got: $output"
    failures=$((failures + 1))
  fi
}
must_pass() {  # LINES...
  plant "$@"
  local output
  if ! output=$(bash "$check" "$tree"); then
    echo "wrongly refused: $output"
    failures=$((failures + 1))
  fi
}

must_fail 1 "dead link: c.md" 'See [c](c.md).'
must_fail 3 "dead link: c.md" '[b](b.md)' '' 'See [b](b.md) and [c](c.md).'
must_fail 1 "dead link: ../picture.jpg" '![A picture](../picture.jpg "with a title")'
must_fail 2 "dead link: c.md" 'See [c].' '[c]: c.md'
must_fail 4 "dead link: c.md" '```' '[c](c.md)' '```' '[c](c.md)'
must_fail 1 "dead link: c.md#short" '[c](c.md#short)'
must_fail 1 "no such heading: b.md#short" '[b](b.md#short)'
must_fail 1 "no such heading: #title" '[here](#title)'
must_fail 1 "no such heading: b.md#not-one" '[b](b.md#not-one)' '# not one'
must_fail 1 "link out of the tree: ../../b.md" '[b](../../b.md)'
must_fail 1 "link to what a build makes: ../build/made.png" '![A picture](../build/made.png)'
must_pass '# Here' '[b](b.md), [b](b.md#the-split-in-short), [here](#here), [title](./b.md#title), [folder](../docs/)' \
  '![A picture](../picture.png "with a title")' '[web](https://example.org/none.md), `[c](c.md)`' '' '    [c](c.md)' \
  '[b]: b.md' '```c' 'a[i](c.md)' '```'

plant ''
yes word | head -n 1500 >"$tree/README.md"
bash "$check" "$tree" || { echo "a README.md of 1,500 words is refused"; failures=$((failures + 1)); }
echo word >>"$tree/README.md"
! bash "$check" "$tree" >/dev/null || { echo "a README.md of 1,501 words passes"; failures=$((failures + 1)); }

bash "$check" "$root" || failures=$((failures + 1))
[ "$failures" = 0 ] || { echo "$failures failures"; exit 1; }

#!/usr/bin/env bash
# check_sources.sh ROOT : the rules of the source tree that no compiler checks. Prints each violation as file:line: rule and
# fails when there is one. source_rules_test.sh shows for every rule that a violation is found.
set -eu
cd "$1"

# Ranks of DESIGN.md: a folder of src/ includes only folders of strictly lower rank, or itself.
ranks="base=0 scene=1 effect=1 brdf=2 accel=2 indirect=3 shade=4 temporal=5 split=5 present=5 wire=5 plan=6 import=6 app=7"

line_count_max=450

# Words that the core (src/ but import/ and app/, and platform/) must do without, as extended regular expressions.
language='\b(try|throw|catch|dynamic_cast|typeid)\b'
heap='\b(new|delete|malloc|calloc|realloc|free|strdup|aligned_alloc|posix_memalign)\b'
containers='\bstd::(vector|string|deque|list|map|set|multimap|multiset|unordered_[a-z]+|function|any|shared_ptr|unique_ptr|make_[a-z]+)\b'
headers='#include <(vector|string|deque|list|map|set|unordered_map|unordered_set|functional|any|memory|iostream|fstream|sstream|stdexcept|regex|locale)>'
# libm functions that round differently from one C library to the next, or fuse. Ours are det_* in base/fmath.h.
libm='(^|[^A-Za-z0-9_.>:]|std::|[^:]::)(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p|b)?|pow|cbrt|hypot|erfc?|[tl]gamma|fma)[fl]?[[:space:]]*\('
systems='^[[:space:]]*#[[:space:]]*(if|elif|ifdef|ifndef)\b.*(__linux|__unix|__APPLE__|_WIN32|_WIN64|__ANDROID__|__FreeBSD__|__MINGW|__CYGWIN__|__EMSCRIPTEN__)'

violations=$(mktemp)
trap 'rm -f "$violations"' EXIT
report() { echo "$1" >>"$violations"; }

sources_in() { find "$@" -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.inl' \) 2>/dev/null | sort || true; }

# A source without comments and without the content of its strings, line by line; includes stay as they are.
plain_code() {
  awk '{
    if ($0 ~ /^[ \t]*#[ \t]*include/) { print; next }
    line = $0; out = ""
    while (length(line)) {
      if (comment) {
        at = index(line, "*/")
        if (!at) { line = ""; break }
        line = substr(line, at + 2); comment = 0
      } else if (match(line, /\/\/|\/\*|"([^"\\]|\\.)*"|'\''([^'\''\\]|\\.)'\''/)) {
        token = substr(line, RSTART, 2)
        out = out substr(line, 1, RSTART - 1)
        rest = substr(line, RSTART + RLENGTH)
        if (token == "//") { line = ""; break }
        if (token == "/*") { comment = 1; line = rest } else { out = out "\"\""; line = rest }
      } else { out = out line; line = "" }
    }
    print out
  }' "$1"
}

# Lines of FILE that match the expression and not the exception, reported with the rule's text.
forbid() {  # FILE EXPRESSION TEXT [EXCEPTION]
  local line
  while IFS=: read -r line _; do
    report "$1:$line: $3"
  done < <(plain_code "$1" | grep -nE "$2" | { if [ -n "${4:-}" ]; then grep -vE "$4"; else cat; fi; } || true)
}

rank_of() {
  local entry
  for entry in $ranks; do
    [ "${entry%%=*}" != "$1" ] || { echo "${entry#*=}"; return; }
  done
  echo none
}

check_includes() {  # FILE
  local file=$1 folder line target top own other
  case $file in
    src/*/*) folder=${file#src/} folder=${folder%%/*} ;;
    platform/*) folder=platform ;;
    src/*) report "$file:1: src/ holds folders alone"; return ;;
    *) folder=tests ;;
  esac
  own=$(rank_of "$folder")
  [ "$own" != none ] || [ "$folder" = platform ] || [ "$folder" = tests ] || report "$file:1: folder $folder has no rank in DESIGN.md"
  while IFS=: read -r line target; do
    target=$(sed -E 's/.*["<]([^">]*)[">].*/\1/' <<<"$target")
    top=${target%%/*}
    other=$(rank_of "$top")
    if [[ $target =~ (^|/)(platform|link)\.h$ ]]; then
      case $folder in
        app | tests | platform) ;;
        *) report "$file:$line: only app/ and tests/ include $target" ;;
      esac
    elif [[ $target == ../* || $target == */../* ]]; then
      report "$file:$line: include $target by its path from src/ or platform/"
    elif [ "$folder" = platform ]; then
      [ "$other" = none ] || report "$file:$line: platform/ includes nothing of src/, here $target"
    elif [ "$folder" != tests ] && [ "$other" != none ] && [ "$top" != "$folder" ] && [ "$other" -ge "$own" ]; then
      report "$file:$line: $folder/ (rank $own) must not include $target (rank $other)"
    elif [ "$folder" != tests ] && [ "$folder" != app ] && [[ $top == platform && $target != platform/devices/* ]]; then
      report "$file:$line: only app/ and tests/ include $target"
    fi
  done < <(grep -nE '^[[:space:]]*#[[:space:]]*include' "$file" || true)
}

while read -r file; do
  check_includes "$file"
  count=$(wc -l <"$file")
  [ "$count" -le $line_count_max ] || report "$file:$count: longer than $line_count_max lines"
  case $file in platform/*) ;; *) forbid "$file" "$systems" "an operating system is named outside platform/" ;; esac
  case $file in
    src/app/* | src/import/* | tests/*) continue ;;
    platform/*) ;;
    *) forbid "$file" "$libm" "libm function in the core: use base/fmath.h" ;;
  esac
  forbid "$file" "$language" "exceptions or RTTI in the core"
  forbid "$file" "$heap" "heap in the core" '=[[:space:]]*delete'
  forbid "$file" "$containers" "heap container in the core"
  forbid "$file" "$headers" "header of the heap or of streams in the core"
done < <(sources_in src platform tests)

count=$(wc -l <"$violations")
cat "$violations"
echo "$(sources_in src platform tests | wc -l) files, $count violations"
[ "$count" = 0 ]

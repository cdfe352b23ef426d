#!/usr/bin/env bash
# check_sources.sh ROOT : checks the source rules that no compiler checks. Prints each violation as file:line: rule, and
# fails if there are any. source_rules_test.sh tests that every rule finds violations.
set -eu
cd "$1"

# Ranks of DESIGN.md: a folder of src/ includes only folders of strictly lower rank, or itself. Folders of src/desktop/, which
# no device build contains, have ranks of their own; only they and app/ include them.
ranks="base=0 scene=1 effect=1 brdf=2 accel=2 indirect=3 shade=4 temporal=5 split=5 present=5 wire=5 plan=6 engine=7 session=8
  remote=9 budget=9 viewer=10 app=12 desktop/reference=5 desktop/accuracy=6 desktop/import=9 desktop/radiosity=9
  desktop/sweep=10 desktop/split_report=10 desktop/coherence_report=10 desktop/reference_view=11"
line_count_max=450
# Comments say what a thing is, not what it shares with the one above: so many may open with a back-reference.
back_reference='^[[:space:]]*// (Of|The same|That|Those|What|Whether)\b'
back_reference_max=20

# heap_rooms may use the heap; all others, and platform/, are the core. platform_rooms may include the platform.
heap_rooms='session|remote|budget|viewer|desktop|app'
# The C++ library allocates for each thread, before the seal.
heap_files='src/engine/workers\.cpp'
platform_rooms='session|remote|budget|viewer|desktop/(reference_view|sweep|split_report|coherence_report)|app'
# The only file that may include CLI11.
command_line_room=src/app/command_parse.cpp

# Words forbidden in the core, as extended regular expressions.
language='\b(try|throw|catch|dynamic_cast|typeid)\b'
heap='\b(new|delete|malloc|calloc|realloc|free|strdup|aligned_alloc|posix_memalign)\b'
containers='\bstd::(nothrow|vector|string|deque|list|map|set|multimap|multiset|unordered_[a-z]+|function|any|shared_ptr|unique_ptr|make_[a-z]+)\b'
headers='#[[:space:]]*include <(vector|string|deque|list|map|set|unordered_map|unordered_set|functional|any|memory|iostream|fstream|sstream|stdexcept|regex|locale)>'
# libm functions that round differently between C libraries, or fuse. Use det_* in base/fmath.h instead.
libm='(^|[^A-Za-z0-9_.>:]|std::|[^:]::)(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p|b)?|pow|cbrt|hypot|erfc?|[tl]gamma|fma)[fl]?[[:space:]]*\('
systems='^[[:space:]]*#[[:space:]]*(if|elif|ifdef|ifndef)\b.*(__linux|__unix|__APPLE__|_WIN32|_WIN64|__ANDROID__|__FreeBSD__|__MINGW|__CYGWIN__|__EMSCRIPTEN__)'

plain=$(mktemp -d)
trap 'rm -rf "$plain"' EXIT

# Copies sources to $plain line by line, without comments and contents of strings; keeps includes.
strip_sources() {
  sed 's|/[^/]*$||' "$plain/.all" | sort -u | sed "s|^|$plain/|" | tr '\n' '\0' | xargs -0 -r mkdir -p
  tr '\n' '\0' <"$plain/.all" | xargs -0 -r awk -v plain="$plain/" '
    FNR == 1 { if (out_file) close(out_file); out_file = plain FILENAME; printf "" > out_file; comment = 0 }
    /^[ \t]*#[ \t]*include/ { print > out_file; next }
    {
      line = $0; out = ""
      while (length(line)) {
        if (comment) {
          at = index(line, "*/")
          if (!at) { line = ""; break }
          line = substr(line, at + 2); comment = 0
        } else if (match(line, /\/\/|\/\*|"([^"\\]|\\.)*"|'\''([^'\''\\]|\\.)'\''/)) {
          token = substr(line, RSTART, 2)
          out = out substr(line, 1, RSTART - 1)
          line = substr(line, RSTART + RLENGTH)
          if (token == "//") line = ""
          else if (token == "/*") comment = 1
          else out = out "\"\""
        } else { out = out line; line = "" }
      }
      print out > out_file
    }'
}

# Reports lines of the files in LIST that match the expression but not the exception, with the rule's text.
forbid() {  # LIST EXPRESSION TEXT [EXCEPTION]
  (cd "$plain" && tr '\n' '\0' <"$1" | xargs -0 -r grep -HnE "$2" || true) |
    { if [ -n "${4:-}" ]; then grep -vE "$4" || true; else cat; fi; } | awk -F: -v text="$3" '{ print $1 ":" $2 ": " text }'
}

check_includes() {
  tr '\n' '\0' <"$plain/.all" | xargs -0 -r awk -v ranks="$ranks" -v line_count_max=$line_count_max \
    -v platform_rooms="$platform_rooms" -v command_line_room="$command_line_room" '
    function report(text) { print FILENAME ":" FNR ": " text }
    function room(first, second) { return first == "desktop" ? first "/" second : first }
    BEGIN { n = split(ranks, entry, " "); for (i = 1; i <= n; ++i) { split(entry[i], pair, "="); rank[pair[1]] = pair[2] + 0 } }
    FNR == 1 {
      split(FILENAME, part, "/")
      folder = part[1] == "src" ? room(part[2], part[3]) : part[1]
      if (part[1] == "src" && folder ~ /\./) report("src/ and src/desktop/ hold folders alone")
      else if (part[1] == "src" && !(folder in rank)) report("folder " folder " has no rank in DESIGN.md")
    }
    FNR == line_count_max + 1 { report("longer than " line_count_max " lines") }
    /^[ \t]*#[ \t]*include[ \t]*["<]/ {
      target = $0; sub(/^[^"<]*["<]/, "", target); sub(/[">].*/, "", target)
      split(target, step, "/")
      top = target ~ /\// ? room(step[1], step[2]) : target
      platform_user = folder ~ "^(" platform_rooms ")$" || part[1] == "tests" || part[1] == "platform"
      if (target ~ /(^|\/)\.\.\//) report("include " target " by its path from src/ or platform/")
      else if (top == "platform" && target !~ /^platform\/devices\// && !platform_user) report(folder "/ must not include " target)
      else if (target ~ /^CLI\// && FILENAME != command_line_room) report("only " command_line_room " includes CLI11, which takes long to compile")
      else if (target ~ /(^|\/)(platform|link)\.h$/ && !platform_user) report(folder "/ must not include " target)
      else if (part[1] == "platform" && top in rank && target ~ /\//) report("platform/ includes nothing of src/, here " target)
      else if (part[1] == "src" && folder in rank && top in rank && target ~ /\// && top != folder && rank[top] >= rank[folder])
        report(folder "/ (rank " rank[folder] ") must not include " target " (rank " rank[top] ")")
      else if (part[1] == "src" && top ~ /^desktop\// && folder !~ /^(desktop\/.*|app)$/)
        report("only desktop/ and app/ include desktop/, here " target)
    }'
}

# Two types with the same name in a namespace violate C++'s one-definition rule, which compilers do not check across
# files. Exempt: types in anonymous namespaces, different folders of tests/ (separate programs), and simd_*.h (only one
# is compiled).
check_types() {
  (cd "$plain" && grep -v '^src/base/simd_' .all | tr '\n' '\0' | xargs -0 -r awk '
    FNR == 1 { depth = outer = hidden = 0; scope[0] = "" }
    !/[{}]/ { next }
    depth == outer && !hidden && match($0, /^(struct|class|union|enum|enum class) +(alignas\([^)]*\) *)?[A-Za-z_0-9]+ *(final *)?(:[^:;]*)?\{/) {
      name = $0
      sub(/^(struct|class|union|enum class|enum) +(alignas\([^)]*\) *)?/, "", name)
      sub(/[^A-Za-z_0-9].*/, "", name)
      name = scope[outer] name
      split(FILENAME, part, "/")
      program = part[1] == "tests" && part[2] != "support" ? part[2] : ""
      for (i = 1; i <= count[name]; ++i)
        if (file[name, i] != FILENAME && (program == "" || owner[name, i] == "" || owner[name, i] == program)) {
          print FILENAME ":" FNR ": type " name " is defined in " file[name, i] ", too"
          break
        }
      ++count[name]
      file[name, count[name]] = FILENAME
      owner[name, count[name]] = program
    }
    {
      opens = /^(inline +)?namespace( +[A-Za-z_0-9:]+)? *\{/ || /^extern "" *\{/
      if (opens) {
        opened = $0
        sub(/ *\{.*/, "", opened)
        sub(/.*(namespace|extern)[ "]*/, "", opened)
      }
      for (rest = $0; match(rest, /[{}]/); rest = substr(rest, RSTART + 1)) {
        if (substr(rest, RSTART, 1) == "{") {
          ++depth
          if (!opens) continue
          opens = 0
          ++outer
          scope[outer] = scope[outer - 1] (opened == "" ? "" : opened "::")
          if (opened == "" && !hidden && $0 !~ /^extern/) hidden = outer
        } else {
          if (depth == outer && outer > 0) { if (hidden == outer) hidden = 0; --outer }
          --depth
        }
      }
    }')
}

# Comments that open with a back-reference, if they are too many.
check_openings() {
  grep -v '^tests/' "$plain/.all" | tr '\n' '\0' | xargs -0 -r grep -HnE "$back_reference" >"$plain/.openings" || true
  [ "$(wc -l <"$plain/.openings")" -le $back_reference_max ] ||
    awk -F: '{ print $1 ":" $2 ": comment opens with a back-reference" }' "$plain/.openings"
}

find src platform tests -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.inl' \) 2>/dev/null | sort >"$plain/.all" || true
grep -vE "^(src/($heap_rooms)/|$heap_files$|tests/)" "$plain/.all" >"$plain/.core" || true
grep '^src/' "$plain/.core" >"$plain/.core_src" || true
grep -vE '^(tests/)?platform/' "$plain/.all" >"$plain/.portable" || true
strip_sources
{
  check_includes
  check_types
  check_openings
  forbid "$plain/.portable" "$systems" "an operating system is named outside platform/"
  forbid "$plain/.core_src" "$libm" "libm function in the core: use base/fmath.h"
  forbid "$plain/.core" "$language" "exceptions or RTTI in the core"
  forbid "$plain/.core" "$heap" "heap in the core" '=[[:space:]]*delete|new \(|#[[:space:]]*include'
  forbid "$plain/.core" "$containers" "heap container in the core"
  forbid "$plain/.core" "$headers" "header of the heap or of streams in the core"
} | sort -t: -k1,1 -k2,2n >"$plain/.violations"
cat "$plain/.violations"
echo "$(wc -l <"$plain/.all") files, $(wc -l <"$plain/.violations") violations"
[ ! -s "$plain/.violations" ]

#!/usr/bin/env bash
# check_documents.sh ROOT : checks the Markdown files of a tree. Every relative link and picture leads to a file or folder of the
# tree, every anchor to a heading, and README.md is read in five minutes. Prints each violation as file:line: rule and fails
# when there is one. documents_test.sh shows for every rule that a violation is found.
set -eu
root=$(realpath "$1")
cd "$root"
word_count_max=1500  # of README.md: 300 a minute

# The targets of a file's links, as "line target": [text](target), ![text](target "title") and [name]: target, not in code.
links() {
  awk '
    /^ *```/ { fenced = !fenced; next }
    fenced || /^    / { next }
    {
      line = $0
      gsub(/`[^`]*`/, "", line)
      if (match(line, /^ *\[[^]]+\]: +[^ ]+/)) {
        target = substr(line, RSTART, RLENGTH)
        sub(/^ *\[[^]]+\]: +/, "", target)
        print FNR, target
      }
      while (match(line, /\]\([^) ]+( +"[^"]*")?\)/)) {
        target = substr(line, RSTART + 2, RLENGTH - 3)
        sub(/ +".*/, "", target)
        print FNR, target
        line = substr(line, RSTART + RLENGTH)
      }
    }' "$1"
}

# The anchors of a file's headings, as forges make them: lower case, no punctuation, hyphens for spaces.
anchors() {
  awk '/^ *```/ { fenced = !fenced } !fenced && sub(/^#+ +/, "")' "$1" | tr '[:upper:]' '[:lower:]' |
    tr -d '!-,./:-@[-^`{-~' | tr ' ' '-'
}

check_link() {  # FILE TARGET : prints what is wrong with it, if anything
  local path=${2%%#*} anchor= target=$root/$1
  [ "${2#*#}" = "$2" ] || anchor=${2#*#}
  [ -z "$path" ] || target=$(realpath -m "$(dirname "$1")/$path")
  case $target in
    "$root/build"*) echo "link to what a build makes: $2" ;;
    "$root" | "$root"/*)
      if [ ! -e "$target" ]; then
        echo "dead link: $2"
      elif [ -n "$anchor" ] && { [ ! -f "$target" ] || ! grep -qxF -e "$anchor" < <(anchors "$target"); }; then
        echo "no such heading: $2"
      fi ;;
    *) echo "link out of the tree: $2" ;;
  esac
}

violations=$(
  find . -path './.git' -prune -o -path './build*' -prune -o -name '*.md' -type f -printf '%P\n' | sort | while read -r file; do
    links "$file" | while read -r line target; do
      case $target in [a-z]*:*) continue ;; esac
      problem=$(check_link "$file" "$target")
      [ -z "$problem" ] || echo "$file:$line: $problem"
    done
  done
  words=$(cat README.md 2>/dev/null | wc -w)
  [ "$words" -le $word_count_max ] || echo "README.md:1: longer than $word_count_max words: $words"
)
[ -z "$violations" ] || { echo "$violations"; exit 1; }

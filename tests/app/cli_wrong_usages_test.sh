#!/usr/bin/env bash
# Goal: wrong usage gets one line of at most 160 characters that names the option, the value, the range or the cure.
# Method: the table wrong_usages.txt. Usage: cli_wrong_usages_test.sh PROGRAM [EMULATOR...]
table=$(realpath "$(dirname "$0")")/wrong_usages.txt
. "$(dirname "$0")/cli.sh"
export LC_ALL=C.UTF-8  # lengths in characters

mkdir folder.pray
: >empty.pray
echo hello >plain
for ending in xyz blend glb; do cp plain plain.$ending; done
"${run[@]}" bake cube -o a.pray >/dev/null
head -c 500 a.pray >cut.pray
for scene in cornell cube; do  # keeps their light, too
  "${run[@]}" render $scene --size 8x6 --threads 1 -o a.ppm >/dev/null 2>&1
done
"${run[@]}" render cube --size 4x3 --threads 1 -o small.ppm >/dev/null

has() {  # WORD : the build has this command, or this option of a command
  local words
  read -ra words <<<"$1"
  "${run[@]}" help "${words[@]}" >/dev/null 2>&1
}
longest=0 rows=0 part=all
while IFS= read -r line; do
  case $line in
    '' | '#'*) continue ;;
    '['*) part=${line:1:-1} && { [ "$part" = all ] || has "$part" || part=; } && continue ;;
  esac
  [ -n "$part" ] || continue
  status=${line%% | *} rest=${line#* | }
  pattern=${rest%% |*} command=${rest#* |}
  eval "arguments=($command)"
  told=$("${run[@]}" "${arguments[@]}" 2>&1 </dev/null)
  got=$?
  rows=$((rows + 1))
  [ ${#told} -le $longest ] || longest=${#told}
  if [ $got = "$status" ] && [[ $told != *$'\n'* ]] && [ ${#told} -le 160 ] && grep -qE -- "^pocketray: .*$pattern" <<<"$told"; then
    passed=$((passed + 1))
  else
    echo "FAILED $command: exit $got, expected $status; ${#told} characters: $told" && failed=$((failed + 1))
  fi
done <"$table"
echo "$rows wrong usages, the longest message has $longest characters"
check rows_are_read test $rows -ge 140

# Goal: the table has at least 200 rows, none of them twice, whatever the build.
check table_is_long test "$(grep -cE '^[12] \| ' "$table")" -ge 200
check table_repeats_nothing test -z "$(grep -E '^[12] \| ' "$table" | sed 's/.* |//' | sort | uniq -d)"
finish

#!/usr/bin/env bash
# Help and version. Usage: cli_help_test.sh PROGRAM [EMULATOR...]
sources=$(realpath "$(dirname "$0")/../..")
. "$(dirname "$0")/cli.sh"
export LC_ALL=C.UTF-8 TERM=xterm
unset NO_COLOR

mapfile -t commands < <("${run[@]}" --help | sed -n '/^Help/,$d; s/^  \([a-z][a-z-]*\)  .*/\1/p')
check commands_are_found test ${#commands[@]} -ge 5

option_lines() { grep -E '^  (-[a-zA-Z], )?--[a-z]' "$1"; }
names() { option_lines "$1" | grep -oE -- '--[a-z-]+' | sed -n 'p'; }
fits() { ! LC_ALL=C.UTF-8 grep -qE '^.{81}' "$1"; }

# Goal: --help has at most twelve options, each on one line of 80 columns; --help-all has them all, in chapters, with
# ranges; --help OPTION explains each. Method: every command; nothing of a parser's types or rules is in any screen.
one_line_each() {  # FILE : after an option's line comes another entry, a heading or an end, no rest of the text
  ! awk '/^  (-[a-zA-Z], )?--[a-z]/ { option = 1; next } option && /^   / { print; found = 1 } { option = 0 } END { exit !found }' "$1"
}
for command in "${commands[@]}"; do
  "${run[@]}" "$command" --help >short
  "${run[@]}" "$command" --help-all >full
  "${run[@]}" help "$command" >again
  check "${command}_twelve_options_at_most" test "$(option_lines short | wc -l)" -le 12
  check "${command}_one_line_for_each" one_line_each short
  check "${command}_fits" fits short
  check "${command}_fits_in_full" fits full
  check "${command}_help_command" cmp -s short again
  check "${command}_all_is_more" test "$(option_lines full | wc -l)" -ge "$(option_lines short | wc -l)"
  check "${command}_no_noise" test -z "$(grep -E 'TEXT|U?INT|FLOAT|Excludes|REQUIRED|OPTIONS|SUBCOMMAND' short full)"
  [ ${#run[@]} = 1 ] || [ "$command" = render ] || continue  # an emulated CPU takes minutes
  while read -r option; do
    "${run[@]}" "$command" --help "$option" >one
    check "${command}_fits_$option" fits one
    check "${command}_help_$option" grep -qE -- "^Usage: pocketray $command … .*$option" one
    [ "$command" = plan ] || continue
    "${run[@]}" help "$command" "${option#--}" >again
    check "${command}_help_again_$option" cmp -s one again
  done < <(grep -oE -- '^  (-[a-zA-Z], )?--[a-z-]+' full | grep -oE -- '--[a-z-]+')
done
expect help_all_of_the_program 0 '^  --texture-max N' --help-all
expect settings_are_in_full_help 0 '^  --area-lights N .*1 … 256' render --help-all
check settings_are_not_in_short_help test -z "$("${run[@]}" render --help | grep -e --area-lights -e --light-every)"
expect excluded_and_why 0 'Excludes  --budget-ms: --budget-ms chooses' render --help samples

# Goal: without UTF-8, help and messages are ASCII, and nothing is lost as a question mark.
is_ascii() { ! LC_ALL=C grep -q '[^ -~	]' "$1" && ! grep -q '?' "$1"; }
LC_ALL=C "${run[@]}" --help-all >plain
check help_is_ascii is_ascii plain
check ranges_are_ascii grep -q '(1 ... 16; default 1)' plain
LC_ALL=C "${run[@]}" render cube --samples x 2>plain
check messages_are_ascii is_ascii plain

# Goal: bold headings on a terminal that has them, and its width. Method: a pseudo-terminal.
if [ ${#run[@]} = 1 ] && command -v script >/dev/null; then
  on_terminal() { script -qec "stty cols 60; $*; $program render --help" /dev/null </dev/null | tr -d '\r'; }
  on_terminal : >bold
  check headings_are_bold grep -q $'^\x1b\[1mPicture\x1b\[0m$' bold
  check width_of_the_terminal test "$(LC_ALL=C.UTF-8 awk '{ gsub(/\x1b\[[0-9]*m/, "") } length > most { most = length } END { print most <= 60 }' bold)" = 1
  for plainly in 'export TERM=dumb' 'export NO_COLOR=1' 'unset TERM'; do
    check "no_bold_$plainly" test -z "$(on_terminal "$plainly" | grep $'\x1b')"
  done
fi
check no_bold_in_a_file test -z "$("${run[@]}" render --help | grep $'\x1b')"

# Goal: the version is that of the library's header, however one asks.
version=$(sed -n 's/^#define POCKETRAY_VERSION_[MP][A-Z]* //p' "$sources/src/engine/pocketray.h" | paste -sd.)
for words in version --version -V -v; do
  check "version_by_$words" grep -qxF "pocketray $version" <("${run[@]}" $words)
done
expect version_of_files 0 "files, version $(sed -n 's/^constexpr std::uint32_t kBakedVersion = \([0-9]*\).*/\1/p' "$sources/src/scene/baked.h") " version

# Goal: prices in help are those of tests/accuracy/FIGURES.md, for every setting that has a row there.
settings=0
while IFS='|' read -r _ name values ms flip _; do
  case $name in ' setting ' | ' output ') continue ;; esac  # the head; the screen's format
  name=$(xargs <<<"$name") values=$(xargs <<<"$values") ms=$(xargs <<<"$ms") flip=$(xargs <<<"$flip")
  "${run[@]}" help render "$name" >one 2>&1
  settings=$((settings + 1))
  tr -s ' \n' '  ' <one >joined
  check "price_of_$name" grep -qF -- "$values takes $ms ms per frame, ꟻLIP $flip from" joined
done < <(sed -n '/^## Figures/,/^## /p' "$sources/tests/accuracy/FIGURES.md" | grep '^| [a-z].*…')
check prices_are_found test $settings -ge 6
for option in quality budget-ms near-lossless; do
  while read -r figure; do
    check "price_of_${option}_$figure" grep -qF -- "$figure" "$sources/tests/accuracy/FIGURES.md"
  done < <("${run[@]}" help render $option 2>/dev/null | sed -n '/^  Price/,$p' | grep -oE '[0-9]+([.,][0-9]+)*')
done

finish

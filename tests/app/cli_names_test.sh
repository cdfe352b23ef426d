#!/usr/bin/env bash
# Names that a terminal would obey. Usage: cli_names_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: no name reaches the terminal with control characters in it. Method: files, folders and words that have some, of
# both kinds, in what is printed by every command that names them.
harmful=$'e\xc2\x9b31m\x1b[31m'
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$harmful.obj"
shows_none() { ! LC_ALL=C grep -q $'[\x01-\x08\x0b-\x1f\x7f]\|\xc2[\x80-\x9f]' told; }
while read -ra command; do
  "${run[@]}" "${command[@]//NAME/$harmful}" >told 2>&1
  check "shows_no_controls_${command[*]}" shows_none
done <<'END'
plan NAME.obj
bench NAME.obj --frames 1 --size 8x6 --no-prices
render cube --size 8x6 -o NAME.ppm
render cube --size 8x6 -o NAME.nothing
bake NAME.obj -o NAME.pray
keygen -o NAME.key
NAME
render --NAME
scenes --server NAME
END

finish

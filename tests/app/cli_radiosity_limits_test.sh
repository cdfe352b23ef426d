#!/usr/bin/env bash
# bake --radiosity without enough memory, and interrupted. Usage: cli_radiosity_limits_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

within() {  # KIBIBYTES of address space, words...
  (ulimit -v "$1" && shift && "${run[@]}" "$@" >told 2>&1 </dev/null)
}
if [ $# -eq 0 ] && "${run[@]}" bake --help 2>/dev/null | grep -q -- --radiosity; then  # not under an emulated CPU
  # Goal: where memory runs out, one line says for what, whatever the limit. Method: limits upwards from where the program
  # just starts; sanitizers, which reserve terabytes, never do.
  kib=16384 starting=0 stated=0 odd=
  while [ $kib -lt 4194304 ]; do
    if within $kib --version; then
      starting=$((starting + 1))
      within $kib bake cornell --radiosity -o limited.pray
      status=$?
      [ $status -eq 0 ] && break
      grep -qE 'form factors of [0-9]+ patches take [0-9]+ MiB' told && stated=$((stated + 1))
      [ $status -eq 1 ] && [ "$(grep -vc '[0-9] %\(, .* left\)\?$' told)" -eq 1 ] &&
        grep -qE 'not enough memory|cannot get .* memory' told || odd="$odd $kib: exit $status, $(head -c 200 told);"
      check "nothing_is_left_at_$kib" test ! -e limited.pray -a ! -e limited.pray.part
    fi
    kib=$((kib * 6 / 5))
  done
  if [ $starting -eq 0 ]; then
    echo "skipped: the program does not start within a limit of memory"
  else
    check "every_limit_ends_in_one_line:$odd" test -z "$odd"
    check some_limits_name_the_form_factors test $stated -gt 0
    check radiosity_fits_in_some_limit test $status -eq 0
  fi

  # Goal: Ctrl-C ends the solution with exit status 3, and leaves no file. Method: after ever longer times, until one falls
  # within it.
  interrupted=0
  for seconds in 0.1 0.2 0.4 0.8 1.6 3.2 6.4; do
    timeout --foreground --preserve-status -s INT -k 20 $seconds "${run[@]}" bake cornell --radiosity -o stopped.pray >told 2>&1
    status=$?
    [ $status -eq 0 ] && break
    [ $status -eq 3 ] && interrupted=$((interrupted + 1))
    check "interrupted_after_${seconds}_s" test $status -eq 3 -o $status -eq 130 -a $interrupted -eq 0  # 130: before it began
    check "nothing_is_left_after_${seconds}_s" test ! -e stopped.pray -a ! -e stopped.pray.part
  done
  check some_time_falls_within_the_solution test $interrupted -gt 0
fi

finish

#!/usr/bin/env bash
# speedup.sh PROGRAM [RANKS [ROUNDS]] : how much sooner several ranks of this machine are done than one program. Each has one
# thread. Runs alternate, so that other work on the machine burdens both alike; prints the median of the ratios of
# each round and their range, and how much CPU time all ranks take. PROGRAM is built with MPI. Whole commands are timed, from their start to the last file.
set -eu
program=$(realpath "$1") ranks=${2:-2} rounds=${3:-7}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export XDG_CACHE_HOME=$folder/cache
TIMEFORMAT='%R %U %S'
seconds() { { time "$@" >/dev/null 2>&1; } 2>&1; }  # COMMAND... : of the clock, of all CPUs in the program and in the system
# Linux shares a busy CPU among sessions, so several programs of one session get no more of it than one does.
apart=(setsid --wait "$program")
team=(mpirun --oversubscribe --bind-to none -n "$ranks")
[ "$(id -u)" != 0 ] || team+=(--allow-run-as-root)
compare() {  # NAME COMMAND... : of the program, with its output in a new folder
  local name=$1 one several
  shift
  : >runs
  for _ in $(seq "$rounds"); do
    rm -rf out && mkdir out && one=$(seconds "${apart[@]}" "$@" --threads 1)
    rm -rf out && mkdir out && several=$(seconds "${team[@]}" "${apart[@]}" "$@" --threads 1)
    awk '{ print $1 / $4, $1, $4, ($5 + $6) / ($2 + $3) }' <<<"$one $several" >>runs
  done
  sort -n runs | awk -v name="$name" -v ranks="$ranks" '{ r[NR] = $1; a[NR] = $2; b[NR] = $3; c[NR] = $4 } END {
    m = int((NR + 1) / 2)
    printf "%-36s %d ranks: %.2f times as fast (%.2f … %.2f; %.1f s instead of %.1f s), with %.2f times the CPU time\n",
      name, ranks, r[m], r[1], r[NR], b[m], a[m], c[m] }'
}
compare "reference, 32 samples of cornell" reference cornell --samples 32 -o out/r.pfm
compare "reference, until its error is 0.14" reference cornell --until 0.14 -o out/r.pfm
compare "render, 351 frames of seesaw" render seesaw --frames 0:350 -o out/o.png
compare "render, 120 frames around cornell" render cornell --turntable 120 --samples 4 -o out/o.png

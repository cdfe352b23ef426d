#!/usr/bin/env bash
# serve_speedup.sh PROGRAM [RANKS [ROUNDS]] : how much sooner a client has its frames from a server on several ranks of this
# machine than from one program. Each has one thread; the client renders nothing itself. Runs alternate, so that other work on
# the machine burdens both alike; prints the median of the ratios of each round and their range. PROGRAM is built with MPI.
set -eu
program=$(realpath "$1") ranks=${2:-2} rounds=${3:-7}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# As in speedup.sh: Linux shares a busy CPU among sessions.
apart=(setsid --wait "$program")
frame_ms() {  # RANKS COHERENCE ARGUMENT... : milliseconds per frame
  local n=$1 coherence=$2 server address
  shift 2
  local serve=("${apart[@]}" serve --listen 127.0.0.1:0 --threads 1 --coherence "$coherence")
  [ "$n" = 1 ] || serve=(mpirun -q --oversubscribe --bind-to none -n "$n" "${serve[@]}")
  rm -f serve.out
  "${serve[@]}" >serve.out 2>&1 &
  server=$!
  until grep -qs '^listening' serve.out; do sleep 0.05; done
  address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' serve.out)
  "${apart[@]}" render "$@" --memory 1500K --verify 0 --server "$address" -o f.ppm 2>&1 |
    sed -n 's/.* \([0-9.]*\) ms per frame.*/\1/p'
  pgrep -f "^$program serve --listen 127.0.0.1:0" | head -n 1 | xargs -r kill -INT
  wait $server || true
}
compare() {  # NAME COHERENCE ARGUMENT...
  local name=$1
  shift
  : >runs
  for _ in $(seq "$rounds"); do
    echo "$(frame_ms 1 "$@") $(frame_ms "$ranks" "$@")" >>runs
  done
  awk '{ print $1 / $2, $1, $2 }' runs | sort -n | awk -v name="$name" -v ranks="$ranks" '
    { r[NR] = $1; a[NR] = $2; b[NR] = $3 } END {
      m = int((NR + 1) / 2)
      printf "%-36s %d ranks: %.2f times as fast (%.2f … %.2f; %.1f ms instead of %.1f ms)\n", name, ranks, r[m], r[1], r[NR],
        b[m], a[m] }'
}
compare "cornell" off cornell --frames 0:199 --orbit 2
compare "cornell, 4 samples per pixel" off cornell --frames 0:39 --orbit 6 --samples 4
compare "seesaw, traced whole" off seesaw --frames 0:149
compare "seesaw, only what changes" auto seesaw --frames 0:299

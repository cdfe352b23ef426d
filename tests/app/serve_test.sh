#!/usr/bin/env bash
# A render server under outside trouble: too few descriptors, closed outputs, and folders with entries that are not files.
# Usage: serve_test.sh PROGRAM. A server must continue, or report in one line why it cannot; it must never hang. PROGRAM is
# built with the sealed heap.
set -u
program=$(realpath "$1")
folder=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill -9 "$server" 2>/dev/null; rm -rf "$folder"' EXIT
cd "$folder" || exit 1
passed=0 failed=0
check() {
  local name=$1
  shift
  if "$@"; then passed=$((passed + 1)); else echo "FAILED $name: $*" && failed=$((failed + 1)); fi
}
# The background server shows its address by its log, or else by its port.
wait_for() {  # PATTERN FILE
  local i
  for ((i = 0; i < 600; ++i)); do
    grep -q -- "$1" "$2" 2>/dev/null && return 0
    kill -0 "$server" 2>/dev/null || return 1
    sleep 0.1
  done
  return 1
}
address_in() { sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' "$1"; }
offers_scenes() { timeout 60 "$program" scenes --server "$1" 2>&1 | grep -q '^ *cornell '; }
end_server() {  # EXPECTED STATUS
  kill -INT "$server" 2>/dev/null
  wait "$server"
  local got=$?
  server=
  [ "$got" -eq "$1" ]
}
cpu_ticks() { awk '{ print $14 + $15 }' "/proc/$1/stat"; }
small=(--threads 1 --memory 8M)

# Goal: a server with few descriptors serves fewer clients and says so, survives more clients than descriptors, and does
# not spin. Method: sixteen descriptors, thirty open connections.
(ulimit -n 16 && exec "$program" serve --listen 127.0.0.1:0 "${small[@]}" >few.out 2>few.err) &
server=$!
check few_descriptors_listens wait_for '^listening' few.out
check few_descriptors_says_so grep -q 'limit on open files allows [1-7] clients, not 8' few.err
address=$(address_in few.out)
check few_descriptors_serves offers_scenes "$address"
held=()
for _ in $(seq 30); do
  exec {file}<>"/dev/tcp/${address%:*}/${address#*:}" && held+=("$file")
done 2>/dev/null
before=$(cpu_ticks $server)
sleep 1
after=$(cpu_ticks $server)
check few_descriptors_does_not_spin test $((after - before)) -lt 10
for file in "${held[@]}"; do exec {file}>&-; done
check few_descriptors_goes_on offers_scenes "$address"
check few_descriptors_ends end_server 3
check few_descriptors_log_is_short test "$(wc -l <few.out)" -lt 150
out=$( (ulimit -n 7 && exec timeout 60 "$program" serve --listen 127.0.0.1:0 "${small[@]}") 2>&1)
check too_few_descriptors_status test $? -eq 1
check too_few_descriptors_says_why grep -q 'raise `ulimit -n`' <<<"$out"

# Goal: closed standard streams are not replaced by sockets. Method: each of them and all; the system reports the port.
port_of() { # PID : its listening port, in decimal
  local inode
  for inode in $(ls -l "/proc/$1/fd" 2>/dev/null | sed -n 's/.*socket:\[\([0-9]*\)\]/\1/p'); do
    awk -v inode="$inode" '$10 == inode && $4 == "0A" { split($2, at, ":"); print at[2] }' /proc/net/tcp
  done | head -1 | xargs -I{} printf '%d\n' 0x{}
}
for closed in '>&-' '<&-' '2>&-' '<&- >&- 2>&-'; do
  if [ "$closed" = '2>&-' ] || [ "$closed" = '<&-' ]; then quiet=">closed.out"; else quiet=; fi
  eval "\"\$program\" serve --listen 127.0.0.1:0 \"\${small[@]}\" $quiet $closed &"
  server=$!
  port=
  for ((i = 0; i < 100; ++i)); do
    port=$(port_of $server)
    [ -n "$port" ] && break
    sleep 0.1
  done
  check "closed_streams_listens $closed" test -n "$port"
  check "closed_streams_serves $closed" offers_scenes "127.0.0.1:$port"
  check "closed_streams_ends $closed" end_server 3
done

# Goal: the server keeps going if its log reader exits or stalls. Method: a reader that exits after a line, one that
# never reads.
"$program" serve --listen 127.0.0.1:0 "${small[@]}" > >(head -1 >head.out) 2>piped.err &
server=$!
for ((i = 0; i < 100; ++i)); do
  port=$(port_of $server)
  [ -n "$port" ] && [ -s head.out ] && break
  sleep 0.1
done
for _ in 1 2 3; do check closed_log_serves offers_scenes "127.0.0.1:$port"; done
check closed_log_ends end_server 3

# Goal: entries of a scene folder that are not files are skipped without blocking. Method: a pipe, a loop of links, a
# folder and a device, each named like a scene; names with control characters.
mkdir scenes
mkfifo scenes/pipe.pray scenes/pipe.glb
ln -s loop.pray scenes/loop.pray
mkdir scenes/folder.pray
ln -s /dev/zero scenes/zero.pray
"$program" bake cube -o scenes/good.pray >/dev/null
cp scenes/good.pray "scenes/$(printf 'bad\033[31m\302\233\342\200\256').pray"
timeout 120 "$program" serve --listen 127.0.0.1:0 --scenes scenes "${small[@]}" >folder.out 2>folder.err &
server=$!
check folder_listens wait_for '^listening' folder.out
check folder_leaves_out test "$(grep -c 'is skipped' folder.err)" -ge 4
check folder_shows_no_controls test "$(cat folder.out folder.err | LC_ALL=C tr -d '\n\r\040-\176' | LC_ALL=C grep -c "$(printf '[\033\233]')")" = 0
"$program" scenes --server "$(address_in folder.out)" >listed.out 2>&1
check list_shows_no_controls test "$(LC_ALL=C tr -d '\n\r\040-\176' <listed.out | wc -c)" = 0
kill -INT "$(pgrep -P $server)" 2>/dev/null
wait "$server" 2>/dev/null
server=

# Goal: no command blocks on a pipe given as a file.
for words in 'render pipe.pray -o a.ppm' 'bake pipe.pray -o a.pray' 'plan pipe.pray' 'view pipe.pray --screen null --frames 1' \
  'render cube --size 8x8 --front pipe.pray -o a.ppm' 'compare pipe.pray pipe.pray'; do
  timeout 60 "$program" ${words//pipe.pray/scenes\/pipe.pray} >pipe.out 2>&1
  check "no_pipe: $words" test $? -ne 124
done
for words in nan inf 0 -1; do
  timeout 60 "$program" serve --listen 127.0.0.1:0 --idle=$words >idle.out 2>&1
  check "idle $words" test $? -eq 1
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]

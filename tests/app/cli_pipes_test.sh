#!/usr/bin/env bash
# Pipes that nobody reads, limits of file sizes, and signals. Usage: cli_pipes_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

tiny=(--size 8x6 --threads 1)
has() { "${run[@]}" --help | grep -q "^ *$1 "; }
# Runs a command in the background, sends it a signal after three seconds and kills it after ten more.
signalled() {  # signal words...
  timeout --foreground -s "$1" -k 10 3 "${run[@]}" "${@:2}" >told 2>&1
}

# Goal: a command that waits for a pipe's reader ends on the first Ctrl-C, and says what it waited for. Method: pipes that
# nobody reads, as each kind of output.
"${run[@]}" render cube "${tiny[@]}" -o lit.ppm >/dev/null 2>&1  # keeps its light, which takes seconds
for pair in "pipe.ppm render cube ${tiny[*]} -o" "pipe.json render cube ${tiny[*]} -o a.ppm --json" "pipe.pray bake cube --no-radiosity -o"; do
  read -ra command <<<"$pair"
  mkfifo "${command[0]}"
  signalled INT "${command[@]:1}" "${command[0]}"
  check "wait_ends_for_${command[0]}" grep -q 'is a pipe that nobody read' told
done
mkfifo log
expect log_to_a_pipe 1 'is a pipe that nobody reads: start its reader first' view cube "${tiny[@]}" --screen null --frames 1 --log log
cat log >piped &
reader=$!
sleep 0.3
expect log_to_a_reader 0 '' view cube "${tiny[@]}" --screen null --frames 1 --log log
kill $reader 2>/dev/null
wait $reader 2>/dev/null

# Goal: a pipe in the place of what is kept between runs hangs no command, and costs no result. Method: of each kind.
own_cache=$XDG_CACHE_HOME
export XDG_CACHE_HOME=$PWD/cache
expect prices_are_kept 0 '' render cube "${tiny[@]}" --budget-ms 5 -o a.ppm
kept=$(ls cache/pocketray/*.front)
rm "$kept" && mkfifo "$kept"
expect pipe_of_prices 0 'is a pipe or a device, where --front keeps what it measured: remove it' render cube "${tiny[@]}" --budget-ms 5 -o b.ppm
check picture_in_spite_of_it test -s b.ppm
expect pipe_of_prices_in_bench 1 'remove it' bench cube --frames 1 "${tiny[@]}" --front
for kept in cache/pocketray/*.light; do
  [ -e "$kept" ] || continue  # a build without the solver
  rm "$kept" && mkfifo "$kept"
  expect pipe_of_light 0 'the light of rooms keeps what it measured: remove it; solving' render cube "${tiny[@]}" -o c.ppm
  rm "$kept"
done
if has accuracy; then
  expect samples_are_kept 0 '' accuracy cube "${tiny[@]}" --rounds 1 --reference-samples 2 -o swept
  for kept in cache/pocketray/*.pfm; do rm "$kept" && mkfifo "$kept"; done
  expect pipe_of_samples 0 'where the cache keeps what it measured: remove it' accuracy cube "${tiny[@]}" --rounds 1 --reference-samples 2 -o again
fi
export XDG_CACHE_HOME=$own_cache

# Goal: a file that reaches the limit of sizes, and a terminal that closes, leave nothing behind. Method: a limit of one
# block; SIGHUP in a long sequence.
(ulimit -f 1 && "${run[@]}" render cube --size 320x240 -o large.ppm >told 2>&1)
check size_limit test $? -eq 1
check size_limit_is_told grep -q 'could not be written completely' told
signalled HUP render seesaw --size 640x480 --frames 0:350 -o long.gif
check nothing_is_left test -z "$(find . -name '*.part')" -a ! -e large.ppm

# Goal: a reader that leaves, or SIGPIPE by itself, costs no file that is finished and leaves nothing behind, whatever the
# command. Method: commands whose output nobody reads; the signal in a long sequence, of which the finished frames stay.
leaves() {  # name words...
  "${run[@]}" "${@:2}" 2>told | true
  local got=${PIPESTATUS[0]}
  check "reader_leaves_$1" test "$got" -eq 0 -o "$got" -eq 3  # as it had nothing more to tell, or was interrupted
}
leaves picture render cube "${tiny[@]}" -o left.png
leaves animation render seesaw "${tiny[@]}" --frames 0:9 -o left.gif
leaves bake bake cube -o left.pray
leaves plan plan cube
leaves bench bench cube --frames 1 "${tiny[@]}"
for file in left.png left.gif left.pray; do check "file_is_complete_$file" test -s $file; done
signalled PIPE render seesaw --size 640x480 --frames 0:350 -o long.gif
check nothing_is_left_by_sigpipe test -z "$(find . -name '*.part')"
[ $# -gt 0 ] || check frames_are_kept_after_sigpipe test -s long.gif

# Goal: a view at rest sleeps. Method: the CPU time of one on the null screen that is ended after three seconds.
if [ $# -eq 0 ]; then
  before=$(cut -d' ' -f16,17 /proc/$$/stat)
  signalled INT view cube "${tiny[@]}" --screen null
  after=$(cut -d' ' -f16,17 /proc/$$/stat)
  spent=$(awk -v a="$before" -v b="$after" -v hz="$(getconf CLK_TCK)" \
    'BEGIN { split(a, x); split(b, y); print int(1000 * (y[1] + y[2] - x[1] - x[2]) / hz) }')
  check "view_at_rest_sleeps (${spent} ms)" test "$spent" -lt 1200
fi

finish

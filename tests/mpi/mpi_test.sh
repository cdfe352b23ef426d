#!/usr/bin/env bash
# The program on several ranks, under mpirun. Usage: mpi_test.sh PROGRAM HAS_MPI
# Goal: files are those of one program, bit for bit, for any number of ranks; errors, interrupts and ranks that die end all
# ranks, with what is finished kept. A build without MPI says so. Skips, and says so, what needs MPI and finds none.
. "$(dirname "$0")/../app/cli.sh"
has_mpi=$1  # 1: the program is built with MPI; cli.sh has shifted PROGRAM away
run=("$program")

# A build without MPI, or one that has it but is told of one rank.
if [ "$has_mpi" != 1 ]; then
  export OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0
  expect launched_without_mpi 1 'mpirun started 2 programs.*no MPI.*POCKETRAY_MPI' plan cube
  OMPI_COMM_WORLD_RANK=1 "${run[@]}" plan cube >other.out 2>&1
  check launched_without_mpi_ends test $? -eq 1
  check launched_without_mpi_is_told_once test ! -s other.out
  OMPI_COMM_WORLD_SIZE=1 expect launched_alone 0 'effects' plan cube
  [ "$failed" = 0 ] || finish
  echo "skipped: this build has no MPI (cmake -DPOCKETRAY_MPI=ON)"
  exit 77
fi
command -v mpirun >/dev/null || { echo "skipped: no mpirun (Debian: openmpi-bin)"; exit 77; }

# As root in a container, on fewer cores than ranks, and without another machine's name.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
ranks() { run=(timeout 300 mpirun -q --oversubscribe --bind-to none -n "$1" "$program"); }
alone() { run=("$program"); }
ranks 2
"${run[@]}" --version >version.out 2>&1 || { echo "skipped: mpirun does not start: $(head -c 300 version.out)"; exit 77; }
check version_is_printed_once test "$(grep -c '^pocketray [0-9]' version.out)" -eq 1

tiny=(--size 16x12 --threads 1)
reference=(reference cube "${tiny[@]}")
alone
expect reference_alone 0 '80 samples' "${reference[@]}" --samples 80 -o alone.pfm
expect until_alone 0 'ꟻLIP' "${reference[@]}" --until 0.09 -o until.pfm
for n in 1 2 3; do
  ranks $n
  expect reference_of_$n 0 '80 samples' "${reference[@]}" --samples 80 -o of_$n.pfm
  check reference_of_${n}_is_that_of_one_program cmp alone.pfm of_$n.pfm
  expect until_of_$n 0 'ꟻLIP' "${reference[@]}" --until 0.09 -o until_$n.pfm
  check until_of_${n}_is_that_of_one_program cmp until.pfm until_$n.pfm
done
ranks 2
expect part_of_ranks 0 '80 samples' "${reference[@]}" --samples 160 --part 1/2 -o part.pfm
expect merged_by_ranks 0 '160 samples' "${reference[@]}" --samples 160 --part 2/2 --merge part.pfm -o merged.pfm
alone
expect reference_of_160 0 '160 samples' "${reference[@]}" --samples 160 -o long.pfm
check merged_is_that_of_one_program cmp long.pfm merged.pfm

# A run that is told to end, then one whose rank dies, go on with other numbers of ranks to the same file.
saved() { [ -s "$1" ]; }
start() {  # COMMAND... : in the background, with its own group; $! is mpirun
  "${run[@]:2}" "$@" >run.out 2>&1 &
  running=$!
}
helper() { pgrep -P "$running" -f "$program" | tail -n 1; }
wait_for() {  # SECONDS CONDITION...
  local left=$1
  shift
  until "$@"; do
    sleep 0.2
    left=$((left - 1))
    [ $left -gt 0 ] || return 1
  done
}
working() { [ "$(pgrep -c -P "$running" -f "$program")" -ge "$1" ]; }
ranks 2
start "${reference[@]}" --samples 2000000 -o killed.pfm
wait_for 300 working 2
sleep 2
kill -TERM "$running"
wait "$running"
check told_to_end test $? -ne 0
check told_to_end_keeps_samples saved killed.pfm
check told_to_end_says_so grep -q 'so far are in killed.pfm.*same command' run.out
ranks 3
start "${reference[@]}" --samples 2000000 -o killed.pfm
wait_for 300 working 3
sleep 2
kill -KILL "$(helper)"
wait "$running"
check death_of_a_rank test $? -ne 0
check death_of_a_rank_keeps_samples saved killed.pfm
count=$(sed -n 's/.*killed.pfm: physical reference, \([0-9]*\) samples.*/\1/p' run.out | head -n 1)
count=$(((${count:-800} / 8 + 2) * 16)) # some rows have more samples than that already
ranks 2
expect went_on 0 "$count samples" "${reference[@]}" --samples $count -o killed.pfm
alone
expect at_once 0 "$count samples" "${reference[@]}" --samples $count -o at_once.pfm
check went_on_to_the_same_file cmp killed.pfm at_once.pfm

# Sequences: the same files; finished frames are left out by another number of ranks.
mkdir one two three
alone
expect frames_alone 0 '' render seesaw "${tiny[@]}" --frames 0:30 -o one/o.png
for n in 2 3; do
  ranks $n
  folder_of_n=$([ $n = 2 ] && echo two || echo three)
  expect frames_of_$n 0 '31|…' render seesaw "${tiny[@]}" --frames 0:30 -o $folder_of_n/o.png --json $folder_of_n.json
  check frames_of_${n}_are_those_of_one_program diff -r one $folder_of_n
  check frames_of_${n}_are_counted grep -q '"frames": 31' $folder_of_n.json
done
ranks 3
expect turntable 0 '' render cube "${tiny[@]}" --turntable 8 --aov depth -o two/t.pfm
alone
expect turntable_alone 0 '' render cube "${tiny[@]}" --turntable 8 --aov depth -o one/t.pfm
check turntable_is_that_of_one_program diff -r one two
expect resumable 0 '' render seesaw "${tiny[@]}" --frames 0:30 -o three/o.png --resume
sed -i '12,$d' three/o.png.resume
ranks 2
expect resumed 0 '10 frames were finished before' render seesaw "${tiny[@]}" --frames 0:30 -o three/o.png --resume
check all_are_listed test "$(wc -l <three/o.png.resume)" -eq 32
expect resume_refused 1 'another scene' render seesaw --size 32x24 --frames 0:30 -o three/o.png --resume

# accuracy: references by all ranks, times of one.
export XDG_CACHE_HOME=$folder/cache_one
alone
expect accuracy_alone 0 'index.html' accuracy cube "${tiny[@]}" --rounds 1 --reference-samples 32 -o sweep_one
export XDG_CACHE_HOME=$folder/cache_two
ranks 2
expect accuracy_of_2 0 'index.html' accuracy cube "${tiny[@]}" --rounds 1 --reference-samples 32 -o sweep_two
check accuracy_reference cmp sweep_one/reference-model.pfm sweep_two/reference-model.pfm
check accuracy_other_reference cmp sweep_one/reference-physical.pfm sweep_two/reference-physical.pfm

# serve: a client's pictures are those of one program; ranks trace a part; they end together, and clients go on alone.
if "$program" --help | grep -q '^ *serve '; then
  serve() {  # RANKS OPTION... : in the background; $address is where
    ranks "$1"
    start serve --listen 127.0.0.1:0 --threads 1 "${@:2}"
    check "serve_on_$1_listens" wait_for 300 grep -q '^listening' run.out
    address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' run.out)
    ranks_running=$(pgrep -P "$running" -f "$program")
    alone
  }
  all_gone() {  # a process that has ended has no program file, even if nobody waits for it
    for rank in $ranks_running; do ! readlink "/proc/$rank/exe" >/dev/null || return 1; done
  }
  sequence=(seesaw --size 64x48 --threads 1 --frames 0:15)
  orbit=(seesaw --size 320x240 --threads 1 --frames 0:15 --orbit 7)  # long enough for other ranks to take a part
  alone
  expect served_alone 0 'per frame' render "${sequence[@]}" -o one/s.ppm
  expect orbit_alone 0 'per frame' render "${orbit[@]}" -o one/o.ppm
  for n in 2 3; do
    serve $n
    check serve_on_${n}_tells_its_ranks grep -q "^listening.*: [0-9]* scenes, $n ranks with $n threads" run.out
    expect_in_use "shared_with_$n" 'render servers: the device rendered' render "${sequence[@]}" --server "$address" -o two/s.ppm
    expect "thin_with_$n" 0 'per frame' render "${orbit[@]}" --memory 1500K --server "$address" -o two/o.ppm
    for i in 00 01 07 08 15; do
      check "shared_with_${n}_$i" cmp one/s-00$i.ppm two/s-00$i.ppm
      check "thin_with_${n}_$i" cmp one/o-00$i.ppm two/o-00$i.ppm
    done
    ranks 2
    expect "port_of_${n}_is_taken" 1 'another program is listening' serve --listen "$address"
    kill -INT "$running"
    wait "$running"
    check serve_on_${n}_ends_all_ranks wait_for 50 all_gone
    check serve_on_${n}_tells_what_others_traced grep -q '^[1-9].* clients, .*; ranks besides 0 traced [1-9]' run.out
  done
  many=(seesaw --size 160x120 --coherence off --frames 0:199)
  serve 2
  "$program" render "${many[@]}" --emulate miyoo-mini -o two/k.ppm --server "$address" >device.out 2>&1 &
  device=$!
  wait_for 300 saved two/k-0009.ppm
  kill -KILL "$(helper)"
  wait "$running"
  check serve_ends_with_a_rank test $? -ne 0
  check serve_ends_with_all_ranks wait_for 50 all_gone
  wait "$device"
  check device_goes_on test $? -eq 0
  check device_tells_the_loss grep -q "$address.* continuing without it" device.out
  expect kept_alone 0 '' render "${many[@]}" -o one/k.ppm
  check kept_frames diff <(cat one/k-*.ppm | md5sum) <(cat two/k-*.ppm | md5sum)
fi

# Errors: one line, exit status 1, no rank left behind.
ranks 3
expect refused 1 '`bench` does not run on several ranks' bench cube
expect refused_to_bake 1 '`bake` does not run' bake cube -o cube.pray
check nothing_baked test ! -e cube.pray
expect no_scene 1 'nowhere.glb' reference nowhere.glb -o nowhere.pfm
expect no_folder 1 'nofolder' "${reference[@]}" -o nofolder/r.pfm
expect other_size 1 'size "16x12"' reference cube --size 16x16 -o alone.pfm
expect one_file 1 'an animation is one file' render seesaw "${tiny[@]}" --frames 0:9 -o o.gif
expect one_picture 1 'one picture' render cube -o o.png
expect with_a_budget 1 'start without mpirun or drop --budget-ms' render seesaw "${tiny[@]}" --frames 0:9 --budget-ms 9 -o o.png
expect usage 2 'bogus' render seesaw --bogus
check accuracy_folder test ! -e nofolder
expect accuracy_no_scene 1 'nowhere.glb' accuracy nowhere.glb -o sweep_none
cat >odd.sh <<END
#!/bin/sh
case \$OMPI_COMM_WORLD_RANK in 1) shift 2; set -- "\$POCKETRAY_COMMAND" "\$POCKETRAY_ODD" "\$@" ;; esac
exec "$program" "\$@"
END
chmod +x odd.sh
odd() {  # COMMAND SCENE : rank 1 has that scene
  export POCKETRAY_COMMAND=$1 POCKETRAY_ODD=$2
  run=(timeout 300 mpirun -q --oversubscribe --bind-to none -n 2 ./odd.sh)
}
odd reference nowhere.glb
expect odd_without_scene 1 'rank 1: nowhere.glb' "${reference[@]}" --samples 2000000 -o odd.pfm
odd reference furnace
expect odd_scene 1 "rank 1: its scene or program differs from rank 0's" "${reference[@]}" --samples 2000000 -o odd.pfm
if "$program" --help | grep -q '^ *serve '; then
  odd serve --memory=32M
  expect odd_options 1 "rank 1: its program or options differ from rank 0's" serve --memory=64M --listen 127.0.0.1:0
fi
odd render cube
"${run[@]}" render seesaw "${tiny[@]}" --turntable 3600 -o one/odd.png >odd.out 2>&1
check odd_frames test $? -eq 1
check odd_frames_says_so grep -q "^pocketray: rank 1: its scene or program differs from rank 0's" odd.out

finish

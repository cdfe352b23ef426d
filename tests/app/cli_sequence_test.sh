#!/usr/bin/env bash
# Sequences of pictures. Usage: cli_sequence_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

render() { "${run[@]}" render "$1" "${small[@]}" -o "$2" "${@:3}" 2>&1; }

# Goal: a turntable goes once around while time stands still. Method: quarter turns equal those of --orbit, in a scene that
# does not move; the first picture is the still; in a scene that moves, each shows the time asked for.
expect turntable 0 'per frame' render cube "${small[@]}" --turntable 4 -o turn.ppm
render cube orbit.ppm --frames 0:3 --orbit 90 >/dev/null
render cube still.ppm >/dev/null
for n in 0 1 2 3; do check "turntable_is_an_orbit_$n" cmp -s turn-000$n.ppm orbit-000$n.ppm; done
check turntable_turns bash -c '! cmp -s turn-0000.ppm turn-0002.ppm'
check turntable_ends_before_its_begin test ! -e turn-0004.ppm
render seesaw moving.ppm --turntable 2 --time 4 >/dev/null
render seesaw then.ppm --time 4 >/dev/null
render seesaw begin.ppm >/dev/null
check turntable_begins_at_the_scenes_camera cmp -s moving-0000.ppm then.ppm
check time_is_seen bash -c '! cmp -s then.ppm begin.ppm'
render seesaw round.ppm --time 4 --frames 0:1 --orbit 180 >/dev/null
check turntable_time_stands_still bash -c '! cmp -s moving-0001.ppm round-0001.ppm'

# Goal: an animation has every frame. Method: its size, its number of frames where a program can tell, and the pixels of the
# animated PNG; the GIF of a scene with few colours is exact too.
count_frames() { ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 "$1"; }
render seesaw frame.ppm --frames 0:5 >/dev/null
expect gif 0 'clip.gif: 6 frames at 30 per second, 32×24' render seesaw "${small[@]}" --frames 0:5 -o clip.gif
expect apng 0 'clip.apng: 6 frames at 12.5 per second' render seesaw "${small[@]}" --frames 0:5 --fps 12.5 -o clip.apng
expect gif_report 0 '"frames": 6' render seesaw "${small[@]}" --frames 0:5 -o clip.gif --json -
render seesaw slow.ppm --frames 0:1 --fps 1 >/dev/null
render seesaw second.ppm --time 1 >/dev/null
check fps_is_of_the_scene_too cmp -s slow-0001.ppm second.ppm
render cube turn.gif --turntable 4 --fps 4 >/dev/null
render seesaw clip30.apng --frames 0:5 >/dev/null
check gif_magic test "$(head -c 6 clip.gif)" = GIF89a
check apng_magic test "$(head -c 8 clip.apng | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a
if command -v identify >/dev/null; then
  check gif_frames test "$(identify clip.gif | wc -l)" = 6
  check gif_delays test "$(identify -format '%T,' clip.gif)" = 3,4,3,3,4,3,
  check turn_delays test "$(identify -format '%T,' turn.gif)" = 25,25,25,25,
else
  echo "skipped: no ImageMagick to read the GIF"
fi
if command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null; then
  check gif_frames_by_ffprobe test "$(count_frames clip.gif)" = 6
  check apng_frames test "$(count_frames clip.apng)" = 6
  ffmpeg -loglevel error -i clip30.apng -start_number 0 read-%04d.ppm
  for n in 0 1 2 3 4 5; do check "apng_is_exact_$n" cmp -s read-000$n.ppm frame-000$n.ppm; done
  expect mp4 0 'clip.mp4: 6 frames at 30 per second' render seesaw "${small[@]}" --frames 0:5 -o clip.mp4
  check mp4_frames test "$(count_frames clip.mp4)" = 6
else
  echo "skipped: no ffmpeg to read the animations"
fi

# Goal: a video that ffmpeg cannot write is told with its last line, and leaves no file. Method: programs of that name that
# fail at once, and at the end; none.
mkdir bin none
printf '#!/bin/sh\necho one >&2\necho "no such codec" >&2\nexit 1\n' >bin/ffmpeg && chmod +x bin/ffmpeg
path=$PATH
PATH=$folder/bin:$path expect mp4_fails 1 'ffmpeg could not write refused.mp4: no such codec' \
  render cube "${small[@]}" --turntable 3 -o refused.mp4
printf '#!/bin/sh\ncat >/dev/null\necho "disk full" >&2\nexit 1\n' >bin/ffmpeg
PATH=$folder/bin:$path expect mp4_fails_late 1 'refused.mp4: disk full' render cube "${small[@]}" --turntable 3 -o refused.mp4
if [ $# -eq 0 ]; then
  told=$(PATH=$folder/none "$program" render cube "${small[@]}" --turntable 3 -o refused.mp4 2>&1)
  check mp4_without_ffmpeg grep -q 'ffmpeg, which is not in the path' <<<"$told"
fi

# Goal: an interrupted animation keeps the frames that are finished. Method: Ctrl-C during a long one.
for kind in gif apng; do
  for seconds in 2 8 32; do  # a busy machine may not have finished a frame
    timeout -s INT $seconds "${run[@]}" render seesaw "${small[@]}" --frames 0:99999 -o long.$kind >told 2>&1
    interrupted=$?
    [ ! -s long.$kind ] || break
  done
  check "interrupted_$kind" test $interrupted -ne 0 -a -s long.$kind
  check "interrupted_${kind}_told" grep -q 'interrupted; .* kept' told
  ! command -v ffprobe >/dev/null ||
    check "interrupted_${kind}_is_whole" test "$(count_frames long.$kind)" = "$(sed -n 's/.*interrupted; \([0-9]*\) .*/\1/p' told)"
done

# Goal: an interrupted sequence is continued: what is finished stays as it is, the rest is rendered, and all equal those of one
# run. Method: Ctrl-C; a picture deleted; one replaced by another, to see that it is left alone; other options.
render seesaw all.ppm --frames 0:5 >/dev/null
check no_list_is_left test ! -e all.ppm.resume
"${run[@]}" render seesaw "${small[@]}" --frames 0:9999 -o cut.ppm >told 2>&1 &
for _ in $(seq 600); do [ -e cut-0003.ppm ] && break; sleep 0.1; done
kill -TERM $!  # as a shell's background job ignores Ctrl-C
wait $!
check interrupted_sequence test $? -eq 3
check resume_is_offered grep -q 'add --resume' told
finished=$(find . -name 'cut-*.ppm' | wc -l)
check list_has_all test "$(($(wc -l <cut.ppm.resume) - 1))" = "$finished"
echo kept >cut-0001.ppm
rm cut-0002.ppm
finished=$(find . -name 'cut-000[0-5].ppm' | wc -l)
expect resume 0 "^$finished frames were finished before" render seesaw "${small[@]}" --frames 0:5 --resume -o cut.ppm
check finished_is_left_alone test "$(cat cut-0001.ppm)" = kept
for n in 0 2 3 4 5; do check "resumed_$n" cmp -s cut-000$n.ppm all-000$n.ppm; done
expect resume_again 0 '^6 frames were finished before' render seesaw "${small[@]}" --frames 0:5 --resume -o cut.ppm
expect resume_with_more_threads 0 '^6 frames' render seesaw --size 32x24 --threads 1 --frames 0:5 --resume -o cut.ppm
cp cut.ppm.resume kept.resume
for options in '--samples 2' '--effects auto,-shadow' '--aov depth' '--fps 10' '--exposure 1' '--camera-index 0 --camera 1,2,3~0,0,0~0,1,0~40' '--crop 0,0,8x8' '--orbit 3'; do
  read -ra more <<<"$options"
  expect "resume_$options" 1 'another scene, version or options' render seesaw --size 32x24 --threads 2 --frames 0:5 --resume -o cut.ppm "${more[@]//\~/ }"
done
check refused_list_is_kept cmp -s cut.ppm.resume kept.resume
expect resume_another_size 1 'another scene' render seesaw --size 24x32 --frames 0:5 --resume -o cut.ppm
expect resume_another_scene 1 'another scene' render cube "${small[@]}" --frames 0:5 --resume -o cut.ppm
"${run[@]}" bake seesaw -o other.pray >/dev/null
expect resume_a_file 1 'another scene' render other.pray "${small[@]}" --frames 0:5 --resume -o cut.ppm
expect resume_from_the_begin 0 '^new-0000.ppm … new-0005.ppm' render other.pray "${small[@]}" --frames 0:5 --resume -o new.ppm
"${run[@]}" bake cube -o other.pray >/dev/null
expect resume_a_changed_file 1 'another scene' render other.pray "${small[@]}" --frames 0:5 --resume -o new.ppm
echo nonsense >bad.ppm.resume
expect resume_nonsense 1 'not a list of finished frames' render cube "${small[@]}" --frames 0:5 --resume -o bad.ppm
mkdir taken.ppm.resume
expect resume_taken 1 'taken.ppm.resume is a folder' render cube "${small[@]}" --frames 0:5 -o taken.ppm
echo precious >diary
for kind in diary_as_list linked_list list_to_nothing; do
  case $kind in diary_as_list) cp diary $kind.ppm.resume ;; linked_list) ln -s diary $kind.ppm.resume ;; *) ln -s absent $kind.ppm.resume ;; esac
  expect $kind 1 "$kind.ppm.resume is not a list of finished frames" render cube "${small[@]}" --frames 0:5 -o $kind.ppm
  check ${kind}_nothing_is_rendered test ! -e $kind-0000.ppm
done
check diary_is_kept test "$(cat diary diary_as_list.ppm.resume)" = "$(printf 'precious\nprecious')" -a ! -e absent
expect resume_a_still 1 'for sequences of numbered pictures' render cube "${small[@]}" --resume -o refused.ppm
expect resume_a_gif 1 'for sequences of numbered pictures' render cube "${small[@]}" --turntable 3 --resume -o refused.gif
expect resume_a_budget 1 'drop --resume or --budget-ms' render seesaw "${small[@]}" --frames 0:3 --budget-ms 100 --resume -o refused.ppm

# Goal: combinations that make no sense are refused in one line.
expect turntable_and_frames 2 'excludes' render cube "${small[@]}" --turntable 4 --frames 0:3 -o refused.ppm
expect turntable_and_orbit 2 'excludes' render cube "${small[@]}" --turntable 4 --orbit 3 -o refused.ppm
for count in 0 1 -4 3601 2.5 many; do
  expect "turntable_$count" 1 'turntable' render cube "${small[@]}" "--turntable=$count" -o refused.ppm
done
expect turntable_is_not_coherent 1 'drop --coherence' render cube "${small[@]}" --turntable 4 --coherence on -o refused.ppm
for kind in gif apng mp4; do expect "still_$kind" 1 'add --frames' render cube "${small[@]}" -o refused.$kind; done
expect gif_too_fast 1 'at most 50 .* --fps 50' render cube "${small[@]}" --turntable 4 --fps 60 -o refused.gif
expect mp4_of_odd_size 1 'even .* try 34x24' render cube --size 33x24 --turntable 4 -o refused.mp4
expect fps_of_a_still 1 'for sequences' render cube "${small[@]}" --fps 10 -o refused.ppm
expect fps_of_pictures 1 'has no effect on numbered pictures' render cube "${small[@]}" --turntable 4 --fps 10 -o refused.ppm
for rate in 0 -1 241 nan fast; do expect "fps_$rate" 1 'fps' render cube "${small[@]}" --turntable 4 "--fps=$rate" -o refused.gif; done
mkdir folder.gif
expect gif_is_a_folder 1 'is a folder' render seesaw "${small[@]}" --frames 0:99999 -o folder.gif
expect gif_nowhere 1 'cannot be written' render seesaw "${small[@]}" --frames 0:99999 -o no/such/a.gif
check nothing_refused_is_written test -z "$(find . -name 'refused*')"

finish

#!/usr/bin/env bash
# Output files: writing and overwriting. Usage: cli_output_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

tiny=(--size 8x6 --threads 1)
has() { "${run[@]}" --help | grep -q "^ *$1 "; }
quality="samples=1 depth=1 area-lights=1 cut-off=0 texture-filter=nearest normals=flat indirect=auto reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32"
mode_of() { stat -c %a "$1"; }

# Goal: replacing a file keeps its permissions and a link to it, and a pipe stays a pipe. Method: each of them, with each kind
# of output.
"${run[@]}" bake cube -o seen.pray >/dev/null
commands=("render cube --size 8x6 -o" "render cube --size 8x6 -o probe.ppm --json" "bake cube -o" "plan cube --json"
  "bench cube --size 8x6 --frames 1 --no-prices --json" "bench cube --size 8x6 --frames 1 --front")
names=(a.ppm a.json a.pray b.json c.json a.front)
for i in "${!commands[@]}"; do
  read -ra command <<<"${commands[i]}"
  name=${names[i]}
  mkdir -p real
  (umask 077 && : >"real/$name")
  case $name in *.front) printf 'pocketray-front 2\n%s flip=0.25 ns=1\n' "$quality" >"real/$name" ;; esac
  ln -s "real/$name" "$name"
  expect "replaces_$name" 0 '' "${command[@]}" "$name"
  check "keeps_the_link_$name" test -L "$name" -a -s "real/$name"
  check "keeps_the_mode_$name" test "$(mode_of "real/$name")" = 600
done
for pair in "pipe.ppm render cube --size 8x6 -o" "pipe.json plan cube --json" "pipe bake cube -o"; do
  read -ra command <<<"$pair"
  mkfifo "${command[0]}"
  cat "${command[0]}" >piped &
  reader=$!
  expect "writes_${command[0]}" 0 '' "${command[@]:1}" "${command[0]}"
  wait $reader
  check "pipe_stays_${command[0]}" test -p "${command[0]}" -a -s piped
done
check nothing_is_left test -z "$(find . -name '*.part')"

# Goal: standard output may be named, and receives text and figures in order. Method: redirected to a file, by each
# name.
for name in - /dev/stdout /dev/fd/1; do
  "${run[@]}" plan cube --json "$name" >both.txt
  check "figures_to_$name" grep -q '"total_bytes"' both.txt
  [ "$name" = - ] || check "text_before_them_$name" test "$(grep -nm1 '^effects' both.txt | cut -d: -f1)" -lt "$(grep -nm1 '"scene"' both.txt | cut -d: -f1)"
done
"${run[@]}" bake cube -o - >piped.pray 2>told
check baked_to_stdout cmp -s piped.pray seen.pray
check bake_tells_elsewhere grep -q 'standard output: .* triangles' told

# Goal: a picture goes to standard output alone, in the format asked for; everything printed goes to standard error. Method:
# the same bytes as the file's, through a pipe; a reader that leaves early; a terminal where there is a program that makes one.
for format in png ppm pfm raw; do
  "${run[@]}" render cube --size 8x6 -o file.$format >/dev/null 2>&1
  "${run[@]}" render cube --size 8x6 -o - --format $format --plan 2>told | cat >piped.$format
  check "picture_to_stdout_$format" cmp -s file.$format piped.$format
  check "picture_tells_elsewhere_$format" grep -q '^standard output: 8×6' told
done
if "${run[@]}" render cube --size 8x6 -o file.jpg >/dev/null 2>&1; then
  "${run[@]}" render cube --size 8x6 -o - --format jpg 2>/dev/null >piped.jpg
  check jpeg_to_stdout cmp -s file.jpg piped.jpg
  check jpeg_magic test "$(head -c 3 file.jpg | od -An -tx1 | tr -d ' \n')" = ffd8ff
fi
# OpenEXR: the floats of .pfm, bit for bit, as another program decodes them. The first three lines of .pfm are text, rows go up.
if ! "${run[@]}" render cube --size 37x29 -o file.exr >told 2>&1; then
  check exr_is_refused_plainly grep -q 'no OpenEXR support: write .pfm' told
elif command -v ffmpeg >/dev/null; then
  "${run[@]}" render cube --size 37x29 -o - --format exr 2>/dev/null >piped.exr
  check exr_to_stdout cmp -s file.exr piped.exr
  for kind in "" "--crop 3,5,21x18" "--aov depth"; do
    "${run[@]}" render cube --size 37x29 $kind -o file.pfm >/dev/null
    "${run[@]}" render cube --size 37x29 $kind -o file.exr >/dev/null
    ffmpeg -v error -y -i file.exr -pix_fmt gbrpf32le -f rawvideo planes.raw </dev/null
    check "exr_has_every_bit$kind" python3 -c '
import struct
head, size, scale, rows = open("file.pfm", "rb").read().split(b"\n", 3)
width, height = map(int, size.split())
pixels = list(struct.iter_unpack("<3I", rows))
planes = [i[0] for i in struct.iter_unpack("<I", open("planes.raw", "rb").read())]
assert len(planes) == 3 * len(pixels) and len(set(pixels)) > 9
for y in range(height):
    for x in range(width):
        r, g, b = pixels[(height - 1 - y) * width + x]
        assert [planes[(c * height + y) * width + x] for c in range(3)] == [g, b, r], (x, y)'
  done
fi
"${run[@]}" render cube --size 8x6 -o - 2>/dev/null >piped && check png_is_usual cmp -s piped file.png
"${run[@]}" render cube --size 8x6 -o file.gif --turntable 3 >/dev/null
"${run[@]}" render cube --size 8x6 -o - --turntable 3 --format gif 2>/dev/null >piped && check gif_to_stdout cmp -s piped file.gif
"${run[@]}" render cube --size 8x6 -o - 2>&- >piped && check picture_without_stderr cmp -s piped file.png
leave_early() { "${run[@]}" render cube --size 320x240 -o - --format pfm 2>told | true; return "${PIPESTATUS[0]}"; }
leave_early
check closed_pipe test $? -eq 1
check closed_pipe_is_told_once test "$(grep -c 'did not take all' told)" = 1 -a "$(grep -c '^pocketray: ' told)" = 1
if command -v script >/dev/null; then
  check terminal_is_refused grep -q 'standard output is a terminal' <<<"$(script -qec "${run[*]} render cube -o -" /dev/null)"
  check terminal_is_refused_by_bake grep -q 'is a terminal' <<<"$(script -qec "${run[*]} bake cube -o -" /dev/null)"
fi
expect sequence_to_stdout 1 'add --format gif' render cube --size 8x6 --frames 0:3 -o -
expect format_of_a_file 1 'is for -o -' render cube --size 8x6 --format ppm -o refused.png
expect format_name 1 'format' render cube --size 8x6 --format bmp -o -
expect nowhere 0 'effects' plan cube --json /dev/null

# Goal: a failed write to standard output is reported and breaks nothing else. Method: a full device and a closed output, with
# every command that prints.
printing=("--help" "--version" "render --help-all" "plan cube" "plan cube --json -" "render cube --size 8x6 -o full.ppm" "bake cube -o full.pray"
  "render cube --size 8x6 -o full.ppm --json -" "bench cube --size 8x6 --frames 1 --no-prices"
  "bench cube --size 8x6 --frames 1 --no-prices --json -" "bake cube -o -" "render cube --size 8x6 -o -")
! has split-report || printing+=("split-report cube --size 64x48 --steps 2 --frames 2 --device-ns 5000 --server-ns 500 --no-paper")
[ $# -gt 0 ] || ! has accuracy || printing+=("accuracy cube --size 8x6 --threads 1 --reference-samples 2 --rounds 1 -o swept")
! has coherence-report || printing+=("coherence-report seesaw --size 8x6 --threads 1 --frames 0:1 --no-paper")
for line in "${printing[@]}"; do
  read -ra command <<<"$line"
  told=$("${run[@]}" "${command[@]}" 2>&1 >/dev/full)
  check "full_$line" test $? -eq 1
  check "full_is_told_once_$line" test "$(grep -cE 'could not write all|did not take all' <<<"$told")" = 1
  told=$("${run[@]}" "${command[@]}" 2>&1 >&-)
  check "closed_$line" test $? -eq 1
done
cmp -s full.ppm a.ppm || check picture_is_whole false
check scene_is_whole cmp -s full.pray seen.pray

# Goal: no option accepts an empty text. Method: every option of every command that takes a text or a number.
for command in $("${run[@]}" --help | sed -n '/^Help/,$d; s/^  \([a-z][a-z-]*\)  .*/\1/p'); do
  for option in $("${run[@]}" "$command" --help-all | grep -oE '^ +(-[a-z], )?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
    expect "empty_${command}_$option" 2 "$option has an empty value" "$command" cube "$option" ''
  done
  expect "empty_${command}_scene" 2 'argument 2 is empty' "$command" ''
done
expect empty_command 2 'argument 1 is empty' ''
expect empty_short 2 '-o has an empty value' bake cube -o ''

# Goal: sizes and sequences are plain numbers. Method: signs, which would wrap around; numbers too large; trailing text.
for size in -1x3 3x-1 +3x3 ' 3x3' 3x3x 3x 0x3 3x0 99999x1 3x3.5 1e1x3; do
  expect "size_$size" 1 '320x240|width|height' render cube --size "$size" -o refused.ppm
done
for frames in 0:-1 -1:3 +0:1 1: :1 2 ' 0:1' 0:1:2 0x1; do
  expect "frames_$frames" 1 'first:last' render seesaw "${tiny[@]}" --frames "$frames" -o refused.ppm
done

# Goal: no command overwrites its own input. Method: the scene and the front as every output, by their names and through
# links of both kinds; the files stay as they are, and no output is another.
cp seen.pray kept.pray
ln seen.pray hard.pray
ln -s seen.pray soft.pray
ln seen.pray hard.ppm
mkdir within && ln -s ../seen.pray within/soft.json
quick=(--size 8x6 --threads 1)
for name in seen.pray ./seen.pray "$PWD/seen.pray" hard.pray soft.pray; do
  expect "bake_over_$name" 1 "would overwrite the input seen.pray|must end|cannot be read|no reader" bake seen.pray -o "$name"
  expect "plan_over_$name" 1 'would overwrite the input seen.pray of SCENE' plan seen.pray --json "$name"
  expect "bench_over_$name" 1 'would overwrite' bench seen.pray "${quick[@]}" --frames 1 --json "$name"
  expect "bench_front_over_$name" 1 'would overwrite' bench seen.pray "${quick[@]}" --frames 1 --front "$name"
  expect "render_json_over_$name" 1 'would overwrite' render seen.pray "${quick[@]}" -o refused.ppm --json "$name"
done
expect render_over_the_scene 1 '-o hard.ppm would overwrite the input seen.pray' render seen.pray "${quick[@]}" -o hard.ppm
cp real/a.front front.ppm && ln -f front.ppm the.front
expect render_over_the_front 1 'of --front' \
  render cube "${quick[@]}" --budget-ms 1000000 --front the.front -o front.ppm
touch the.key && ln the.key key.ppm
! has scenes || expect render_over_the_key 1 'key.ppm would overwrite the input the.key of --key' \
  render cube "${quick[@]}" --server :1 --key the.key -o key.ppm
! has scenes || expect scenes_over_the_key 1 'of --key' scenes --server :1 --key the.key --json key.ppm
ln -s front.ppm flight-0001.ppm
expect sequence_over_the_front 1 'flight-0001.ppm would overwrite the input the.front' \
  render seesaw "${quick[@]}" --frames 0:2 --budget-ms 1000000 --front the.front -o flight.ppm
check sequence_has_not_begun test ! -e flight-0000.ppm
! has split-report || expect split_report_over 1 'would overwrite' split-report seen.pray "${quick[@]}" --json within/soft.json
! has accuracy || expect accuracy_over 1 'would overwrite' accuracy seen.pray "${quick[@]}" -o swept_other --json within/soft.json
! has coherence-report || expect coherence_over 1 'would overwrite' coherence-report seen.pray "${quick[@]}" --json within/soft.json
expect one_file_of_two 1 '-o and --json name the same file' render cube "${quick[@]}" -o one.ppm --json ./one.ppm
expect one_output_of_two 1 '-o and --json name the same file' bake cube -o - --json -
expect bake_ending 1 'must end in .pray' bake cube -o cube.glb
expect bake_no_name 1 'must end in .pray' bake cube -o .pray
check inputs_are_as_they_were cmp -s seen.pray kept.pray
if "${run[@]}" render --help | grep -q glTF; then
  printf 'mtllib house.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wall\nf 1 2 3\n' >house.obj
  printf 'newmtl wall\nKd 1 0 0\n' >house.mtl
  cp house.obj kept.obj && cp house.mtl kept.mtl
  cp house.obj again.pray && ln again.pray other.obj
  expect bake_over_a_model 1 'must end in .pray' bake house.obj -o house.obj
  expect bake_over_a_linked_model 1 'would overwrite the input other.obj of IN' bake other.obj -o again.pray
  check model_is_as_it_was cmp -s house.obj kept.obj
  check linked_model_is_as_it_was cmp -s other.obj kept.obj
fi

# Goal: no command overwrites a file that its model or environment was read from, besides the one named: materials,
# textures and buffers. Method: each as an output, by their names and through links of both kinds; all stay as they are.
if "${run[@]}" render --help | grep -q glTF; then
  mkdir shed && cd shed || exit 1
  "${run[@]}" render cube --size 8x8 -o tile.png >/dev/null
  printf 'mtllib shed.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wall\nf 1/1 2/2 3/3\n' >shed.obj
  printf 'newmtl wall\nKd 1 0 0\nmap_Kd Tile.PNG\n' >shed.mtl
  printf '\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0' >shed.bin
  printf '%s' '{"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"shed.bin"}],"bufferViews":[{"buffer":0,
    "byteLength":36}],"accessors":[{"bufferView":0,"count":3,"type":"VEC3","componentType":5126}],"meshes":[{"primitives":
    [{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}' >shed.gltf
  mkdir ../kept && cp * ../kept
  ln tile.png hard.png && ln -s tile.png soft.png && ln tile.png walk-0001.png && ln tile.png walk.gif && ln tile.png hard.pfm
  ln shed.mtl hard.pray
  read_from='which the scene is read from'
  for name in tile.png ./tile.png "$PWD/tile.png" hard.png soft.png; do
    expect "render_over_a_texture_$name" 1 "^pocketray: -o $name would overwrite .*tile.png, $read_from: name another file" \
      render shed.obj "${quick[@]}" -o "$name"
    expect "plan_over_a_texture_$name" 1 "$read_from" plan shed.obj --json "$name"
  done
  expect render_json_over_materials 1 "$read_from" render shed.obj "${quick[@]}" -o refused.ppm --json shed.mtl
  expect sequence_over_a_texture 1 "-o walk-0001.png would overwrite" render shed.obj "${quick[@]}" --turntable 3 -o walk.png
  expect gif_over_a_texture 1 "$read_from" render shed.obj "${quick[@]}" --turntable 3 -o walk.gif
  expect bench_over_a_texture 1 "$read_from" bench shed.obj "${quick[@]}" --frames 1 --json tile.png
  expect bench_front_over_a_texture 1 "$read_from|not a" bench shed.obj "${quick[@]}" --frames 1 --front tile.png
  expect bake_over_materials 1 "-o hard.pray would overwrite shed.mtl, $read_from" bake shed.obj -o hard.pray
  expect bake_json_over_a_texture 1 "$read_from" bake shed.obj -o refused.pray --json tile.png
  expect render_over_a_buffer 1 "$read_from" render shed.gltf "${quick[@]}" -o refused.ppm --json shed.bin
  expect render_over_the_environment 1 "$read_from" render cube "${quick[@]}" --environment tile.png -o hard.png
  expect bake_over_the_environment 1 "$read_from" bake cube --environment tile.png -o refused.pray --json hard.png
  ! has view || expect log_over_the_scene 1 '--log shed.obj would overwrite the input shed.obj of SCENE' \
    view shed.obj "${quick[@]}" --screen null --frames 1 --log shed.obj
  for name in shed.mtl soft.png; do
    ! has view || expect "log_over_$name" 1 "--log $name would overwrite .* $read_from" \
      view shed.obj "${quick[@]}" --screen null --frames 1 --log "$name"
  done
  ! has reference || expect reference_over_a_texture 1 "--output hard.pfm .* $read_from" reference shed.obj "${quick[@]}" -o hard.pfm
  for command in accuracy split-report coherence-report; do
    has $command || continue
    expect "${command}_over_materials" 1 "$read_from" $command shed.obj "${quick[@]}" -o ../swept_other --json shed.mtl
    expect "${command}_among_textures" 1 "-o . has tile.png, $read_from: name another folder" $command shed.obj "${quick[@]}" -o .
  done
  for file in ../kept/*; do check "${file##*/}_is_as_it_was" cmp -s "$file" "${file##*/}"; done
  check nothing_over_files_read_is_written test ! -e refused.ppm -a ! -e refused.pray -a ! -e walk-0000.png
  expect beside_files_read 0 'refused' render shed.obj "${quick[@]}" -o not_refused.png
  cd .. || exit 1
fi

# Goal: an output that cannot be written is reported before the work starts, and a folder for results is made. Method: work
# that takes far too long to wait for.
ages=(--size 2048x2048 --samples 16 --threads 1 --memory 512M)
slow=(--size 2048x2048 --threads 1 --memory 512M)
mkdir folder.ppm folder.json
: >file
for output in no/such/a.ppm folder.ppm file/a.ppm "$(printf 'n%.0s' {1..2000}).ppm"; do
  expect "told_at_once_${output:0:20}" 1 'cannot be written|is a folder|path is longer' \
    render statue "${ages[@]}" -o "$output"
done
for kind in gif apng; do
  mkdir folder.$kind
  for output in folder.$kind no/such/a.$kind file/a.$kind; do
    expect "animation_told_$output" 1 'cannot be written|is a folder' render seesaw "${ages[@]}" --frames 0:999 -o "$output"
  done
done
if has reference; then
  mkdir folder.pfm
  "${run[@]}" render cube --size 8x6 -o one.png >/dev/null
  for output in folder no/such/a file/a; do
    expect "reference_told_$output" 1 'cannot be written|is a folder' reference statue --size 2048x2048 --samples 64 -o $output.pfm
    expect "reference_json_told_$output" 1 'cannot be written|is a folder' reference statue --size 2048x2048 --samples 64 -o r.pfm --json $output.json
    expect "compare_json_told_$output" 1 'cannot be written|is a folder' compare one.png one.png --json $output.json
  done
  expect compare_told 1 'cannot be written' compare one.png one.png -o no/such/a.png
fi
for output in no/such/a.json folder.json; do
  expect "render_json_told_$output" 1 'cannot be written|is a folder' render statue "${ages[@]}" -o refused.ppm --json "$output"
  expect "bench_json_told_$output" 1 'cannot be written|is a folder' bench statue "${ages[@]}" --frames 1000 --json "$output"
  expect "plan_json_told_$output" 1 'cannot be written|is a folder' plan cube --prices --json "$output"
  expect "bake_json_told_$output" 1 'cannot be written|is a folder' bake cube -o told.pray --json "$output"
done
expect bench_front_told 1 'cannot be written' bench statue "${slow[@]}" --frames 1000 --front file/a.front
XDG_CACHE_HOME=/dev/null expect bench_cache_told 1 '/dev/null.*(cannot be|is no|Not a directory)' bench statue "${slow[@]}" --frames 1000 --front
expect bake_told 1 'no/such/a.pray' bake cube -o no/such/a.pray
mkdir "$folder/blocked" && : >"$folder/blocked/flight-0003.ppm" && mkdir "$folder/blocked/flight-0004.ppm"
expect sequence_told 1 'flight-0004.ppm is a folder' render seesaw "${tiny[@]}" --frames 0:5 -o blocked/flight.ppm
check sequence_told_before_the_first test ! -e blocked/flight-0000.ppm
for command in split-report accuracy coherence-report; do
  has $command || continue
  expect "${command}_file_as_folder" 1 'file ' $command statue "${ages[@]}" -o file
  expect "${command}_folder_in_none" 1 'no/such' $command statue "${ages[@]}" -o no/such
  expect "${command}_json_told" 1 'no/such' $command statue "${ages[@]}" -o made --json no/such/a.json
done
if has split-report; then
  expect split_report_new_folder 0 'chosen' split-report cube --size 64x48 --steps 2 --frames 2 --device-ns 5000 \
    --server-ns 500 --no-paper -o made_by_report
  check split_report_is_there test -s made_by_report/split.csv
fi
check nothing_refused_is_written test ! -e refused.ppm -a ! -e told.pray

finish

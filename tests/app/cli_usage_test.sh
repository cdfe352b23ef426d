#!/usr/bin/env bash
# Exit statuses, one-line errors and reports. Usage: cli_usage_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

# Goal: help is helpful, and usage errors differ from bad input.
expect help 0 'render +render a frame' --help
expect last_before_first 1 'the last frame comes before the first' render cube "${small[@]}" --frames 5:3 -o refused.ppm
expect no_such_camera 1 'counted from 0' render cube "${small[@]}" --camera-index 7 -o refused.ppm
expect rotated_picture 1 '--rotate is for .raw' render cube "${small[@]}" --rotate 90 -o refused.ppm
expect dithered_picture 1 '--dither is for .raw' render cube "${small[@]}" --dither -o refused.ppm
expect bake_baked 1 'pray' bake refused.pray -o again.pray
expect coherence_of_neighbours 0 'coherence on has no effect: ' \
  render seesaw "${small[@]}" --frames 0:1 --coherence on --selective .2 -o ignored.ppm
expect selective_is_ignored 0 'selective has no effect: selective is off .instant radiosity' \
  render cornell "${small[@]}" --selective .2 --indirect instant-radiosity -o ignored.ppm
expect plan_counts_lamps 0 '1 emitting material;' plan cornell "${small[@]}"
if "${run[@]}" view --help >/dev/null 2>&1; then
  expect nothing_to_choose 1 'name a SCENE' view --screen null --frames 1
fi
expect unknown_scene 1 'no_such_scene' render no_such_scene -o a.ppm
expect size_with_another_cross 0 '16×12' render cube --size 16X12 -o a.ppm
for memory in 24M 24MB 24MiB 24576K 24576KiB; do
  expect "memory_$memory" 0 'of 24.0 MiB' plan cube "${small[@]}" --memory $memory
done
expect bad_size 1 '320x240' render cube --size 0y3 -o a.ppm
expect bad_size_zero 1 'width' render cube --size 0x3 -o a.ppm
expect bad_ending 1 '\.png' render cube "${small[@]}" -o a.bmp
expect bad_folder 1 'cannot be written' render cube "${small[@]}" -o no/such/folder/a.ppm
expect bad_depth 1 'depth' render cube "${small[@]}" --depth 99 -o a.ppm
expect bad_effect 1 "no effect 'sparkle'" render cube "${small[@]}" --effects auto,-sparkle -o a.ppm
expect bad_camera 1 'VFOV' render cube "${small[@]}" --camera "1 2" -o a.ppm
expect camera_at_its_target 1 'same point' render cube "${small[@]}" --camera "1,1,1 1,1,1 0,1,0 40" -o a.ppm
expect camera_index 1 'no camera 7' render cube "${small[@]}" --camera-index 7 -o a.ppm
expect too_little_memory 1 'memory .*try' render statue --memory 1M -o a.ppm
expect aov_name 1 'depth, normal' render cube "${small[@]}" --aov colour -o a.ppm
expect unknown_device 1 'gp2x' render cube "${small[@]}" --device toaster -o a.ppm
expect device_memory 0 'of 16.0 MiB' plan cornell --device gp2x
expect emulate_unknown 1 "emulate.*gp2x, miyoo" render cube "${small[@]}" --emulate toaster -o a.ppm
expect emulate_and_another_device 1 'give only one of them' render cube "${small[@]}" --emulate tablet --device gp2x -o a.ppm
expect emulate_memory 0 'of 16.0 MiB' plan cube --emulate gp2x
expect isa_name 1 'this CPU has baseline' render cube "${small[@]}" --isa sse9 -o a.ppm
expect isa_in_report 0 '2 threads, baseline' bench cube "${small[@]}" --frames 1 --no-prices --isa baseline
expect frames_format 1 'last frame comes before' render seesaw "${small[@]}" --frames 9:3 -o a.ppm

# Goal: a corrupt file is refused in one line.
"${run[@]}" bake "$subject" -o c.pray >/dev/null
head -c 5000 c.pray >cut.pray
expect truncated_scene 1 'cut.pray' render cut.pray -o b.ppm
: >empty.pray
expect empty_scene 1 'empty' render empty.pray -o b.ppm
mkdir folder.pray
expect folder_as_scene 1 "regular file" render folder.pray -o b.ppm
if "${run[@]}" render --help | grep -q glTF; then
  printf 'v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n' >nan.obj
  expect number_that_is_none 1 "nan.obj: line 2: 'nan' .*export" render nan.obj --strict -o b.ppm
  expect no_face_left 1 "nan.obj: no triangles .*1 face is left out.*--strict" render nan.obj -o b.ppm
  # A tetrahedron of glass without a volume.
  printf '%s' '{"asset":{"version":"2.0"},"buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,AAAAAAAAA' \
    'AAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAACAAEAAAABAAMAAAADAAIAAQACAAMA"}],"bufferViews":[{"buffer":0,' \
    '"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[{"bufferView":0,"count":4,"type":"VEC3",' \
    '"componentType":5126},{"bufferView":1,"count":12,"type":"SCALAR","componentType":5123}],"meshes":[{"primitives":[{' \
    '"attributes":{"POSITION":0},"indices":1,"material":0}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,' \
    '"materials":[{"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_transmission":{' \
    '"transmissionFactor":1}}}]}' >glass.gltf
  expect glass_is_told 0 'glass without a volume: 1 closed, taken as solid .--glass' bake glass.gltf -o glass.pray
  expect glass_as_told 0 '4 triangles' bake glass.gltf --glass solid -o told.pray
  check glass_is_solid cmp glass.pray told.pray
  "${run[@]}" bake glass.gltf --glass thin -o thin.pray >thin.txt 2>&1
  check glass_said_thin eval '! cmp -s glass.pray thin.pray && ! grep -q volume thin.txt'
  expect glass_of_another_kind 1 'auto, thin or solid' plan glass.gltf --glass milk
fi
check nothing_was_written test ! -e b.ppm

# Goal: reports.
expect plan 0 'shadow +on' plan "$subject"
expect plan_map 0 'persistent +accelerator' plan "$subject"
expect plan_json 0 '"total_bytes"' plan "$subject" --json -
expect bench 0 'per pixel' bench cube "${small[@]}" --frames 2
expect bench_coherence 0 "pixels traced" bench seesaw "${small[@]}" --frames 2 --no-prices --coherence on
expect bench_coherence_is_off 0 '"coherence": null' bench seesaw "${small[@]}" --frames 2 --no-prices --json -
expect bench_coherence_json 0 '"whole_frames": 0' bench seesaw "${small[@]}" --frames 2 --no-prices --coherence on --json -
expect bench_without_coherence 0 'traced whole +all +\(nothing moves' bench cornell "${small[@]}" --frames 2 --no-prices \
  --coherence auto
expect bench_coherence_or_front 2 "excludes|--front" bench seesaw "${small[@]}" --coherence on --front
expect bench_json 0 '"scanline_ns_per_pixel"' bench cube "${small[@]}" --frames 2 --json -
expect bench_sparse 0 ' 10 % of pixels' bench cube "${small[@]}" --frames 2 --no-prices --sparse
expect bench_sparse_json 0 '"patch_ns_per_pixel"' bench cube "${small[@]}" --frames 2 --no-prices --sparse --json -

# Goal: failing to create threads costs time but not the picture. Method: thread stacks of 60 TB, if the shell may
# request them.
huge_stacks() { (ulimit -s 60000000000 && "$program" "$@") 2>&1; }
if [ ${#run[@]} -eq 1 ] && huge_stacks --version >/dev/null; then
  check few_threads_are_told grep -q 'allows only 1 of 2 threads' <<<"$(huge_stacks render cube "${small[@]}" -o few.ppm)"
  expect all_threads 0 few render cube "${small[@]}" -o all_but_few.ppm
  check few_threads_render_the_same cmp few.ppm all_but_few.ppm
fi

finish

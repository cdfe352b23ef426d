#!/usr/bin/env bash
# Textures in baked scenes: mip maps and blocks. Usage: cli_texture_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

expect textures_name 1 'textures.*small' bake cube -o refused.pray --textures small
expect filter_names 1 'trilinear or anisotropic' render cube "${small[@]}" --texture-filter fine -o refused.ppm
"${run[@]}" bake --help | grep -q 'glTF' || { finish; }
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >probe.obj
"${run[@]}" bake probe.obj -o probe.pray >/dev/null 2>&1 || { echo "skipped: this build has no importers"; finish; }

size() { stat -c %s "$1"; }
# A floor with a texture of 128 × 128 texels, repeated towards the horizon.
{
  printf '\0\0\2\0\0\0\0\0\0\0\0\0\200\0\200\0\030\040'
  for row in {0..127}; do
    for column in {0..15}; do
      [ $(((row / 8 + column) % 2)) = 0 ] && printf '\040\140\320%.0s' {1..8} || printf '\220\060\020%.0s' {1..8}
    done
  done
} >floor.tga
printf 'newmtl floor\nKd 1 1 1\nmap_Kd floor.tga\n' >floor.mtl
printf '%s\n' 'mtllib floor.mtl' 'usemtl floor' 'v -9 0 9' 'v 9 0 9' 'v 9 0 -9' 'v -9 0 -9' 'vt 0 0' 'vt 5 0' 'vt 5 5' \
  'vt 0 5' 'f 1/1 2/2 3/3 4/4' >floor.obj
view=(--size 64x48 --threads 2 --camera "0,1.5,9 0,0,0 0,1,0 50")

# Goal: mip maps are stored unless told otherwise, and add a third; the picture shows them, and the plan says so.
expect bake_levels 0 '1 texture,' bake floor.obj -o levels.pray
expect bake_no_levels 0 '1 texture,' bake floor.obj -o plain.pray --no-mip-maps
expect bake_tells_that_it_halves 0 '1 texture halved to at most 64 texels a side .--texture-max' bake floor.obj -o coarse.pray --texture-max 64
check bake_does_not_tell_otherwise test "$("${run[@]}" bake floor.obj -o levels.pray 2>&1 | grep -c halved)" = 0
check render_does_not_tell test "$("${run[@]}" render floor.obj "${view[@]}" -o seen.ppm 2>&1 | grep -c halved)" = 0
check levels_take_a_third [ $(($(size levels.pray) - $(size plain.pray))) -ge 21000 ]
check levels_take_no_more [ $(($(size levels.pray) - $(size plain.pray))) -le 22000 ]
expect plan_levels 0 'mip-map +on +1 of 1 materials' plan levels.pray
expect plan_no_levels 0 'mip-map +- +none of 1 materials' plan plain.pray
expect plan_filter 0 'mip-map +- +--texture-filter bilinear' plan levels.pray --texture-filter bilinear
for filter in scene bilinear trilinear anisotropic; do
  expect "render_$filter" 0 'ns per pixel' render levels.pray "${view[@]}" --texture-filter $filter -o $filter.ppm
done
expect render_plain 0 'ns per pixel' render plain.pray "${view[@]}" -o plain.ppm
check scene_is_trilinear cmp -s scene.ppm trilinear.ppm
check anisotropic_is_seen bash -c '! cmp -s anisotropic.ppm trilinear.ppm && ! cmp -s anisotropic.ppm bilinear.ppm'
check bilinear_is_without_levels cmp -s bilinear.ppm plain.ppm
check levels_are_seen bash -c '! cmp -s scene.ppm plain.ppm'

# Goal: a device without room for all levels leaves out the largest, says so, and shows what a file baked without them
# shows; so does one that is told to.
expect render_limited 0 'ns per pixel' render levels.pray "${view[@]}" --texture-max 64 -o limited.ppm
expect render_coarse 0 'ns per pixel' render coarse.pray "${view[@]}" -o coarse.ppm
check limited_is_as_baked cmp -s limited.ppm coarse.ppm
expect render_limited_model 0 'ns per pixel' render floor.obj "${view[@]}" --texture-max 64 -o model.ppm
check limited_model_is_as_baked cmp -s model.ppm coarse.ppm
"${run[@]}" render levels.pray "${view[@]}" --texture-max 4 -o blurred.ppm >/dev/null
check limit_is_seen bash -c '! cmp -s blurred.ppm scene.ppm'
expect render_in_little_memory 0 '^pocketray: textures up to [0-9]+ texels: the block has no room for more; --memory 1M has' \
  render levels.pray "${view[@]}" --memory 200K -o little.ppm
expect plan_in_little_memory 0 'textures up to [0-9]+ texels' plan levels.pray --size 64x48 --threads 2 --memory 200K
side=$("${run[@]}" render levels.pray "${view[@]}" --memory 200K -o little.ppm 2>&1 | sed -n 's/.*textures up to \([0-9]*\) texels.*/\1/p')
expect render_as_in_little_memory 0 'ns per pixel' render levels.pray "${view[@]}" --texture-max "${side:-0}" -o asked.ppm
check little_memory_shows_smaller_textures cmp -s little.ppm asked.ppm
expect too_little_memory 1 'the scene needs .* MiB of memory but' render levels.pray "${view[@]}" --memory 64K -o refused.ppm
expect textures_are_no_larger 0 '--texture-max has no effect: no texture has more texels a side' render levels.pray "${view[@]}" --texture-max 2048 -o whole.ppm
expect textures_absent 0 '--texture-max has no effect: the scene has no textures' render cube "${view[@]}" --texture-max 64 -o cube.ppm
expect textures_of_no_texels 1 '--texture-max is 0' render levels.pray --texture-max 0 -o refused.ppm
if [ ${#run[@]} = 1 ] && "${run[@]}" --help | grep -q '^ *serve '; then
  mkdir scenes && cp levels.pray floor.obj floor.mtl floor.tga scenes/
  "${run[@]}" serve --listen 127.0.0.1:0 --scenes scenes --threads 2 >serve.out 2>serve.err &
  server=$!
  wait_for $server grep -q '^listening' serve.out
  address=$(sed -n 's/^listening on \([0-9.:]*\): .*/\1/p' serve.out)
  for scene in levels.pray floor.obj; do
    share=(render $scene "${view[@]}" --texture-max 64 --server "$address" --frames 0:2 -o "shared_$scene.ppm")
    expect "share_$scene" 0 'render servers: the device rendered' "${share[@]}"
    check "share_${scene}_is_known" test "$("${run[@]}" "${share[@]}" 2>&1 | grep -cE 'wrong pixels|does not have|unreachable')" = 0
    for frame in 0 1 2; do
      check "shared_${scene}_${frame}_is_as_alone" cmp -s coarse.ppm "shared_$scene-000$frame.ppm"
    done
  done
  kill -INT $server && wait $server
fi

# Goal: compressed textures are smaller, look alike, and bake says what they cost.
expect bake_compressed 0 '128×128: colour, 4 bits, PSNR [34][0-9]' bake floor.obj -o blocks.pray --textures compressed
check blocks_take_an_eighth [ $(($(size plain.pray) - $(size blocks.pray))) -ge 50000 ]
expect render_blocks 0 'ns per pixel' render blocks.pray "${view[@]}" -o blocks.ppm
if "${run[@]}" compare --help >/dev/null 2>&1; then
  expect blocks_look_alike 0 'LIP' compare scene.ppm blocks.ppm --fail-above 0.03
fi

# Goal: Khronos' DamagedHelmet fits a small device: textures of at most 1.5 MiB that look like the exact ones.
helmet=${POCKETRAY_SHARED:-}/scenes/gltf/DamagedHelmet.glb
if [ -f "$helmet" ] && [ ${#run[@]} = 1 ] && "${run[@]}" compare --help >/dev/null 2>&1; then
  "${run[@]}" bake "$helmet" -o exact.pray --texture-max 512 >/dev/null
  "${run[@]}" bake "$helmet" -o small.pray --texture-max 512 --textures compressed --json small.json >/dev/null
  bytes=$(sed -n 's/.*"texture_bytes": \([0-9]*\).*/\1/p' small.json)
  check helmet_takes_at_most [ "${bytes:-9999999}" -le $((3 << 19)) ]
  for kind in exact small; do "${run[@]}" render $kind.pray --threads 2 -o helmet_$kind.ppm >/dev/null 2>&1; done
  expect helmet_looks_alike 0 'LIP' compare helmet_exact.ppm helmet_small.ppm --fail-above 0.02
fi
finish

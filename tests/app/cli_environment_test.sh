#!/usr/bin/env bash
# Environments from the command line. Usage: cli_environment_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

render() { "${run[@]}" render "$1" "${small[@]}" -o "$2" "${@:3}" 2>&1 >/dev/null; }
first_pixel() { tail -c $((32 * 24 * 3)) "$1" | head -c 3 | od -An -tx1 | tr -d ' \n'; }

if ! "${run[@]}" render --help | grep -q glTF; then
  expect needs_importers 1 'bake the scene with it on a desktop' render cube "${small[@]}" --environment sky -o refused.ppm
  finish
fi

# Goal: bad names are refused in one line, and nothing is written.
expect no_file 1 'missing.hdr' render cube "${small[@]}" --environment missing.hdr -o refused.ppm
expect bad_sky 1 'sky:ELEVATION,TURBIDITY' render cube "${small[@]}" --environment sky:high -o refused.ppm
expect high_sun 1 'must lie in 0 … 90' render cube "${small[@]}" --environment sky:95 -o refused.ppm
expect haze 1 'must lie in 2 … 10' render cube "${small[@]}" --environment sky:30,1 -o refused.ppm
expect environment_or_background 2 'excludes' render cube "${small[@]}" --environment sky --background 1,1,1 -o refused.ppm
expect environment_or_budget 2 'excludes' render cube "${small[@]}" --environment sky --budget-ms 100 -o refused.ppm
expect view_has_it 1 'missing.png' view cube "${small[@]}" --screen null --frames 1 --environment missing.png
expect bake_has_it 1 'missing.png' bake cube -o refused.pray --environment missing.png
printf '#?RADIANCE\n\n-Y 9000 +X 9000\n' >huge.hdr
expect huge 1 'huge.hdr has 9000 × 9000 pixels' render cube "${small[@]}" --environment huge.hdr -o refused.ppm
printf '#?RADIANCE\n\n-Y 8000 +X 8000\n' >short.hdr
expect short 1 'short.hdr is cut short' render cube "${small[@]}" --environment short.hdr -o refused.ppm
check nothing_refused_is_written test ! -e refused.ppm -a ! -e refused.pray
if "${run[@]}" render --help | grep -q -- '--server'; then
  expect environment_of_servers 1 'drop --server' render cube "${small[@]}" --environment sky --server 127.0.0.1:1 -o refused.ppm
fi

# Goal: an environment is seen and lights the scene; baked, it gives the same picture; --background takes its place. Method: a
# red picture of 8 × 4 pixels, whose even radiance the corner shows; a grey triangle without any light of its own.
printf '#?RADIANCE\n\n-Y 4 +X 8\n' >red.hdr
for _ in $(seq 32); do printf '\177\000\000\201'; done >>red.hdr
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >model.obj
told=$(render model.obj red.ppm --environment red.hdr)
check no_lights_are_added bash -c '! grep -q "adding" <<<"$1"' - "$told"
check background_is_red test "$(first_pixel red.ppm | cut -c1-2)" = ff
check background_is_nothing_else bash -c '[[ "$1" == ff0[0-9a-f]0[0-9a-f] || "$1" == ff1[0-9a-f]1[0-9a-f] ]]' - "$(first_pixel red.ppm)"
check whole_picture_is_red test "$(tail -c $((32 * 24 * 3)) red.ppm | od -An -v -tx1 -w3 | grep -vc ' [4-9a-f][0-9a-f] [012][0-9a-f] [012][0-9a-f]')" = 0
"${run[@]}" bake model.obj -o model.pray --environment red.hdr >/dev/null
render model.pray baked.ppm >/dev/null
check baked_is_the_same cmp -s red.ppm baked.ppm
render model.pray own.ppm --background '#0000ff' >/dev/null
check background_takes_its_place test "$(first_pixel own.ppm)" = 0000ff
render model.pray off.ppm --effects auto,-environment >/dev/null
check without_it_its_mean_is_seen test "$(first_pixel off.ppm | cut -c1-2)" = ff
check plan_tells_it grep -Eq 'environment +on.*64×64 texels' <<<"$("${run[@]}" plan model.pray "${small[@]}" 2>&1)"
check plan_tells_its_memory grep -Eq 'scene +environment +[0-9.]+ KiB' <<<"$("${run[@]}" plan model.pray "${small[@]}" 2>&1)"
check plan_takes_it grep -Eq 'environment +on.*64×64 texels' <<<"$("${run[@]}" plan model.obj "${small[@]}" --environment red.hdr 2>&1)"
expect bench_takes_it 0 '"environment"' bench model.obj "${small[@]}" --frames 1 --no-prices --environment red.hdr --json -
expect bench_front_has_none 2 'excludes' bench model.obj --environment red.hdr --front refused.front
if "${run[@]}" --help | grep -q '^ *reference '; then
  expect reference_takes_it 0 'model reference' reference model.obj "${small[@]}" --kind model --samples 2 --environment red.hdr -o red.pfm
  check reference_is_of_it grep -q 'red.pfm is a reference with scene' <<<"$("${run[@]}" reference model.obj "${small[@]}" --kind model --samples 2 -o red.pfm 2>&1)"
fi
check plan_tells_its_absence grep -Eq 'environment.*no environment' <<<"$("${run[@]}" plan cube "${small[@]}" 2>&1)"
render model.obj sky.ppm --environment sky >/dev/null
render model.obj low.ppm --environment sky:5,6 >/dev/null
check sky_is_seen bash -c '! cmp -s sky.ppm red.ppm && ! cmp -s sky.ppm low.ppm'
expect too_little_memory 1 'MiB' render cube "${small[@]}" --memory 256K --environment sky -o refused.ppm
expect in_view 0 '' view model.obj "${small[@]}" --screen null --frames 2 --environment sky

# Goal: a metal without light stands in a studio, which one line tells, as baked and as read; --environment none leaves it
# out, where it takes no bytes. A diffuse model gets it when asked for.
printf 'newmtl metal\nKd 0.8 0.8 0.8\nPm 1\nPr 0.2\n' >metal.mtl
printf 'mtllib metal.mtl\nusemtl metal\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >metal.obj
lines_of_studio() { grep -c 'studio' <<<"$1"; }
check studio_is_told test "$(lines_of_studio "$(render metal.obj studio.ppm)")" = 1
check diffuse_has_none test "$(lines_of_studio "$(render model.obj plain.ppm)")" = 0
check studio_is_told_in_bake test "$(lines_of_studio "$("${run[@]}" bake metal.obj -o metal.pray 2>&1)")" = 1
render metal.pray baked.ppm >/dev/null
check studio_baked_is_the_same cmp -s studio.ppm baked.ppm
plan=$("${run[@]}" plan metal.pray "${small[@]}" 2>&1)
check plan_tells_the_studio grep -Eq 'environment +on.*a studio, 128×128 texels' <<<"$plan"
check plan_tells_its_bytes grep -Eq 'scene +environment +0\.1 MiB' <<<"$plan"
check plan_tells_who_casts_shadows grep -Eq 'environment-shadow +- .*the default lights cast shadows' <<<"$plan"
check no_studio_is_told test "$(lines_of_studio "$(render metal.pray none.ppm --environment none)")" = 0
check no_studio_is_seen bash -c '! cmp -s studio.ppm none.ppm'
check no_studio_is_baked test "$(lines_of_studio "$("${run[@]}" bake metal.obj -o none.pray --environment none 2>&1)")" = 0
check no_studio_takes_no_bytes test $(($(stat -c %s metal.pray) - $(stat -c %s none.pray))) -gt 100000
for scene in metal.obj none.pray; do
  render $scene again.ppm --environment none >/dev/null
  check "no_studio_in_$scene" cmp -s none.ppm again.ppm
done
check studio_on_demand test "$(lines_of_studio "$(render model.obj asked.ppm --environment studio)")" = 1
check studio_lights_diffuse bash -c '! cmp -s plain.ppm asked.ppm'
check studio_lights_alone grep -q 'only the light of a studio' <<<"$(render metal.pray alone.ppm --light none)"

# Goal: a background in place of a sky leaves the sky's light, besides its sun. Method: without indirect light it is gone.
"${run[@]}" bake model.obj -o sky.pray --environment sky >/dev/null
render sky.pray kept.ppm --background '#0000ff' --exposure fixed >/dev/null
render sky.pray gone.ppm --background '#0000ff' --exposure fixed --indirect none >/dev/null
check sky_light_is_kept bash -c '! cmp -s kept.ppm gone.ppm'

# Goal: a sequence under another sky, or of another file, is not continued. Method: --resume with each changed.
"${run[@]}" bake cube -o resumed.pray >/dev/null
list=(render resumed.pray "${small[@]}" --frames 0:2 -o resumed.ppm)
"${run[@]}" render resumed.pray "${small[@]}" --frames 0:99999 -o resumed.ppm --environment sky:30 >told 2>&1 &
for _ in $(seq 600); do [ -e resumed-0000.ppm ] && break; sleep 0.1; done
kill -TERM $!
wait $!
expect resume_under_the_same_sky 0 'finished before' "${list[@]}" --environment sky:30 --resume
expect resume_under_another_sky 1 'another scene' "${list[@]}" --environment sky:31 --resume
expect resume_under_no_sky 1 'another scene' "${list[@]}" --resume
"${run[@]}" bake furnace -o resumed.pray >/dev/null
expect resume_another_scene_under_it 1 'another scene' "${list[@]}" --environment sky:30 --resume

finish

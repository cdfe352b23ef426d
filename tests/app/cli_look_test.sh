#!/usr/bin/env bash
# Background, lights and field of view from the command line; black pictures. Usage: cli_look_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

render() { "${run[@]}" render "$1" "${small[@]}" -o "$2" "${@:3}" 2>&1 >/dev/null; }
first_pixel() { tail -c $((32 * 24 * 3)) "$1" | head -c 3 | od -An -tx1 | tr -d ' \n'; }

# Goal: bad values are refused in one line.
for color in '#ff80' '#ff80gg' red 1,2 1,2,3,4 -1,0,0 nan,0,0 1e38,0,0 '#'; do
  expect "background_$color" 1 'background' render cube "${small[@]}" "--background=$color" -o refused.ppm
done
for exposure in fixed, fixed1 fixedly fixed,61 fixed,fixed auto,1 nan; do
  expect "exposure_$exposure" 1 "exposure is '$exposure': write stops" render cube "${small[@]}" --exposure $exposure -o refused.ppm
done
expect light_name 1 'light.*moon' render cube "${small[@]}" --light moon -o refused.ppm
for degrees in 0 -5 180 nan inf 40x wide; do
  expect "fov_$degrees" 1 "fov is '$degrees': it must lie in 0.001 … 179" render cube "${small[@]}" "--fov=$degrees" -o refused.ppm
done
expect fov_or_camera 2 'excludes' render cube "${small[@]}" --fov 30 --camera "0,0,5 0,0,0 0,1,0 40" -o refused.ppm
expect background_or_budget 2 'excludes' render cube "${small[@]}" --background 1,1,1 --budget-ms 100 -o refused.ppm
expect view_has_them 1 'background' view cube "${small[@]}" --screen null --frames 1 --background red
check nothing_refused_is_written test ! -e refused.ppm
if "${run[@]}" render --help | grep -q -- '--server'; then
  expect light_of_servers 1 'drop --server' render cube "${small[@]}" --light sun --server 127.0.0.1:1 -o refused.ppm
  expect background_of_servers 1 'drop --server' render cube "${small[@]}" --background 1,1,1 --server 127.0.0.1:1 -o refused.ppm
fi

# Goal: a scene's own light and camera: --light says that it changes nothing, --fov changes the picture.
render "$subject" own.ppm >/dev/null
check light_is_not_needed grep -q 'has light' <<<"$(render "$subject" lit.ppm --light sun)"
check own_light_stays cmp -s own.ppm lit.ppm
render "$subject" wide.ppm --fov 70 >/dev/null
check fov_is_seen bash -c '! cmp -s own.ppm wide.ppm'

# Goal: a model without light and camera gets those asked for, and without options the usual ones. Method: a triangle; the
# corner of the picture shows the background, as levels and as radiance.
if "${run[@]}" render --help | grep -q glTF; then
  printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >model.obj
  render model.obj usual.ppm >/dev/null
  check key_is_usual grep -q 'adding a key and a fill light' <<<"$(render model.obj key.ppm --light key)"
  check key_gives_the_usual_picture cmp -s usual.ppm key.ppm
  check sun_is_told grep -q 'adding a sun' <<<"$(render model.obj sun.ppm --light sun)"
  check none_is_told grep -q 'only ambient light' <<<"$(render model.obj none.ppm --light none)"
  check sun_is_seen bash -c '! cmp -s usual.ppm sun.ppm && ! cmp -s sun.ppm none.ppm && ! cmp -s usual.ppm none.ppm'
  render model.obj levels.ppm --background '#Ff8000' >/dev/null
  check background_as_levels test "$(first_pixel levels.ppm)" = ff8000
  render model.obj linear.ppm --background 1,0.2158605,0 >/dev/null
  check background_as_radiance test "$(first_pixel linear.ppm)" = ff8000
  # A model with a lamp is measured, unless told otherwise.
  printf 'newmtl lamp\nKe 90 90 90\n' >lamp.mtl
  printf 'mtllib lamp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl lamp\nf 1 2 3\n' >lit.obj
  grey=0.2158605,0.2158605,0.2158605
  render lit.obj measured.ppm --background $grey >/dev/null
  check exposure_is_measured test "$(first_pixel measured.ppm)" != 808080
  render lit.obj fixed.ppm --background $grey --exposure fixed >/dev/null
  check exposure_is_fixed test "$(first_pixel fixed.ppm)" = 808080
  render lit.obj stop.ppm --background 0.431721,0.431721,0.431721 --exposure fixed,-1 >/dev/null
  check exposure_is_fixed_a_stop_lower test "$(first_pixel stop.ppm)" = 808080
  render model.obj fov.ppm --fov 40 >/dev/null
  check usual_field_of_view cmp -s usual.ppm fov.ppm
  render model.obj narrow.ppm --fov 5 >/dev/null
  check narrow_field_of_view bash -c '! cmp -s usual.ppm narrow.ppm'

  # Goal: the film tone shows light beyond white; pictures of other quantities and linear light stay. Method: a background of
  # twice white, which clips to level 255 and becomes 1 − .04/1.4, level 252; depth and radiance of the same scene.
  expect tone_name 1 'tone.*sepia.*clip.*film' render model.obj "${small[@]}" --tone sepia -o refused.ppm
  bright=(--background 2,2,2 --exposure fixed)
  for tone in clip film; do
    render model.obj $tone.ppm "${bright[@]}" --tone $tone >/dev/null
    render model.obj $tone.pfm "${bright[@]}" --tone $tone >radiance_$tone.txt
    render model.obj depth_$tone.ppm "${bright[@]}" --tone $tone --aov depth >depth_$tone.txt
  done
  check clip_is_white test "$(first_pixel clip.ppm)" = ffffff
  check film_is_not test "$(first_pixel film.ppm)" = fcfcfc
  check radiance_has_no_tone cmp -s clip.pfm film.pfm
  check depth_has_no_tone cmp -s depth_clip.ppm depth_film.ppm
  for what in radiance depth; do
    check ${what}_says_so grep -q -e '--tone has no effect' ${what}_film.txt
    check ${what}_says_nothing_of_the_default bash -c "! grep -e --tone ${what}_clip.txt"
  done

  # Goal: a level of quality asks for nothing that the scene ignores. Method: a model without lights, whose default lights
  # cast the shadows; no note of a request without effect.
  render model.obj high.ppm --quality high --environment studio >high.txt
  check level_asks_for_nothing_in_vain bash -c '! grep "no effect" high.txt'

  # Goal: a black picture is explained in one line, which names the material where the file does. Method: a black triangle in
  # render, of a model, of what it bakes to and of a sequence; in view; not in a depth picture, nor the same in grey.
  printf 'newmtl Body\nKd 0 0 0\n' >black.mtl
  printf 'mtllib black.mtl\nusemtl Body\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >black.obj
  black_lines() { grep -c 'exactly black: '"$1" <<<"$2"; }
  check black_is_told test "$(black_lines "material 'Body' reflects nothing" "$(render black.obj black.ppm)")" = 1
  check black_is_told_once test "$(black_lines '' "$(render black.obj black.ppm --frames 0:2)")" = 1
  "${run[@]}" bake black.obj -o black.pray >/dev/null
  check black_baked test "$(black_lines 'material 1 of 1 ' "$(render black.pray black.ppm)")" = 1
  check black_in_view test "$(black_lines "material 'Body'" "$("${run[@]}" view black.obj "${small[@]}" --screen null --frames 3 2>&1)")" = 1
  check depth_is_not_black test "$(black_lines '' "$(render black.obj depth.ppm --aov depth)")" = 0
  check grey_is_not_black test "$(black_lines '' "$(render model.obj grey.ppm)")" = 0

  # Goal: --focus fills the picture with a part of the model, in render and view, and a wrong name is told. Method: two
  # triangles far apart, as objects; the background, on most of the whole picture.
  printf 'o near\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no far\nv 99 0 0\nv 100 0 0\nv 99 1 0\nf 4 5 6\n' >two.obj
  background_pixels() { tail -c $((32 * 24 * 3)) "$1" | od -An -v -tx1 -w3 | grep -c 'ff 00 ff'; }
  render two.obj both.ppm --background '#ff00ff' >/dev/null
  for part in near far; do render two.obj $part.ppm --background '#ff00ff' --focus $part >/dev/null; done
  check whole_is_small test "$(background_pixels both.ppm)" -gt 700
  for part in near far; do check "focus_fills_$part" test "$(background_pixels $part.ppm)" -lt 650; done
  check focus_turntable test -z "$(render two.obj turn.ppm --focus far --turntable 4 --background '#ff00ff' | grep -v 'no camera')"
  check turntable_stays_on_it test "$(background_pixels turn-0002.ppm)" -lt 650
  expect focus_in_view 0 '' view two.obj "${small[@]}" --screen null --frames 1 --focus far
  expect focus_on_nothing 1 "no part 'fat'; similar ones: 'far', 'near'" render two.obj "${small[@]}" --focus fat -o refused.ppm
  expect focus_in_view_on_nothing 1 "no part 'fat'" view two.obj "${small[@]}" --screen null --frames 1 --focus fat
  expect focus_or_camera 2 'excludes' render two.obj "${small[@]}" --focus far --camera "0,0,5 0,0,0 0,1,0 40" -o refused.ppm
  "${run[@]}" bake two.obj -o two.pray >/dev/null
  expect focus_of_baked 1 'a .pray file keeps no names' render two.pray "${small[@]}" --focus far -o refused.ppm
  check nothing_refused_is_written_either test ! -e refused.ppm
fi

finish

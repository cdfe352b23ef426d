#!/usr/bin/env bash
# Background, lights and field of view from the command line. Usage: cli_look_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

render() { "${run[@]}" render "$1" "${small[@]}" -o "$2" "${@:3}" 2>&1 >/dev/null; }
first_pixel() { tail -c $((32 * 24 * 3)) "$1" | head -c 3 | od -An -tx1 | tr -d ' \n'; }

# Goal: bad values are refused in one line.
for color in '#ff80' '#ff80gg' red 1,2 1,2,3,4 -1,0,0 nan,0,0 1e38,0,0 '#'; do
  expect "background_$color" 1 'background' render cube "${small[@]}" "--background=$color" -o refused.ppm
done
expect light_name 2 'light.*moon' render cube "${small[@]}" --light moon -o refused.ppm
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
check light_is_not_needed grep -q 'has light of its own' <<<"$(render "$subject" lit.ppm --light sun)"
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
  check none_is_told grep -q 'ambient light alone' <<<"$(render model.obj none.ppm --light none)"
  check sun_is_seen bash -c '! cmp -s usual.ppm sun.ppm && ! cmp -s sun.ppm none.ppm && ! cmp -s usual.ppm none.ppm'
  render model.obj levels.ppm --background '#Ff8000' >/dev/null
  check background_as_levels test "$(first_pixel levels.ppm)" = ff8000
  render model.obj linear.ppm --background 1,0.2158605,0 >/dev/null
  check background_as_radiance test "$(first_pixel linear.ppm)" = ff8000
  render model.obj fov.ppm --fov 40 >/dev/null
  check usual_field_of_view cmp -s usual.ppm fov.ppm
  render model.obj narrow.ppm --fov 5 >/dev/null
  check narrow_field_of_view bash -c '! cmp -s usual.ppm narrow.ppm'
fi

finish

#!/usr/bin/env bash
# blender_test.sh ROOT POCKETRAY : platform/blender/pocketray.py exports what Blender shows, and refuses in one line. Method:
# makes scenes whose pictures are known, exports and renders them, and compares with closed forms and with Cycles.
set -u
root=$(realpath "$1") program=$(realpath "$2")
here=$root/tests/blender
for tool in blender python3; do
  command -v $tool >/dev/null || { echo "skipped: this system has no $tool"; exit 77; }
done
"$program" render --help | grep -q glTF || { echo "skipped: this build reads no glTF"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/tmp"
ln -s "$program" "$work/bin/pocketray"
export TMPDIR=$work/tmp BLENDER_USER_CONFIG=$work/config BLENDER_USER_SCRIPTS=$work/scripts XDG_CACHE_HOME=$work/cache
plain_path=$PATH PATH=$work/bin:$PATH
cd "$work" || exit 1
failures=0
check() {  # NAME COMMAND...
  local name=$1
  shift
  "$@" >"$work/out" 2>&1 && return
  echo "FAILED $name: $*"
  tail -n 3 "$work/out"
  failures=$((failures + 1))
}
in_blender() { blender --background --factory-startup "$@"; }
export_scene() {  # SCENE [OPTIONS OF BAKE...]
  in_blender "$1.blend" --python-exit-code 3 --python "$root/platform/blender/pocketray.py" -- "$1.pray" "${@:2}"
}
render() { pocketray render "$1.pray" --size "$2" -o "$3.pfm" --effects all --cut-off 0 "${@:4}"; }
cycles() { in_blender "$1.blend" --python-exit-code 3 --python "$here/cycles.py" -- "$2" "$1-cycles.pfm"; }
pictures() { check "pictures_$1" python3 "$here/pictures.py" "$@"; }

check scenes in_blender --python-exit-code 3 --python "$here/scenes.py" -- "$work"
for scene in stage lamps area ellipse surroundings no_camera; do check "export_$scene" export_scene $scene; done

for t in 0 0.5 0.999; do check stage_$t render stage 160x120 stage-$t --time $t; done
pictures stage stage-0.pfm stage-0.5.pfm stage-0.999.pfm

for scene in lamps area ellipse; do
  check render_$scene render $scene 8x8 $scene --area-lights 256
  check cycles_$scene cycles $scene 8x8
done
pictures lamps lamps.pfm lamps-cycles.pfm
for scene in area ellipse; do
  check below_the_$scene render $scene 8x8 $scene-below --camera "0,0.5,0 0,4,0 0,0,-1 2"
done
check above_the_area render area 8x8 above --camera "0,8,0 0,0,0 0,0,-1 2" --area-lights 256
pictures area area.pfm area-cycles.pfm area-below.pfm above.pfm
pictures ellipse ellipse.pfm ellipse-cycles.pfm ellipse-below.pfm

check render_surroundings render surroundings 64x48 surroundings
check cycles_surroundings cycles surroundings 64x48
pictures surroundings surroundings.pfm surroundings-cycles.pfm

# What is not carried over is told, one line each. Without a camera, the scene is framed.
export_scene no_camera >said 2>&1
check no_camera_is_told grep -q 'no active camera.*frames the scene' said
check shape_keys_are_told grep -q "^'Cube': its shape keys do not move" said
check strips_are_told grep -q "^'Cube': its NLA strips are not" said
check pictures_are_told grep -q 'cannot be read are left out: gone$' said
check materials_are_told grep -q 'without a Principled BSDF become white: toon$' said
check no_camera_renders render no_camera 8x8 framed

# Options of bake, which also take the world's place.
export_scene stage --textures compressed --environment sky >said 2>&1
check options_reach_bake grep -q 'PSNR\|without error' said
check the_sky_is_larger test "$(stat -c %s stage.pray)" -gt 200000

# Errors: status 1, one line, nothing left behind, and a file from before stays as it was.
refused() {  # NAME PATTERN COMMAND...
  local name=$1 pattern=$2
  shift 2
  "$@" >said 2>told
  check "${name}_status" test $? -eq 1
  check "${name}_is_one_line" test "$(wc -l <told)" = 1
  check "${name}_says" grep -qE "^pocketray: .*$pattern" told
}
for scene in empty gone; do echo before >$scene.pray; done
run() { in_blender "$1.blend" --python "$root/platform/blender/pocketray.py" -- "${@:2}"; }
refused no_output 'say where to write' run stage
refused no_suffix "its name must end in .pray" run stage stage.glb
refused no_folder "does not exist: create it" run stage nowhere/stage.pray
mkdir sealed
chmod a-w sealed
[ -w sealed ] || refused sealed_folder 'not writable: choose another' run stage sealed/stage.pray
mkdir taken.pray
refused output_is_a_folder 'taken.pray is a folder' run stage taken.pray
PATH=$plain_path refused no_program 'add its folder to PATH' run stage stage.pray
refused empty_scene 'bake: empty.blend: no triangles' run empty empty.pray
refused bad_option 'bake: --accel' run stage stage.pray --accel none
refused no_picture "world's picture '//gone.png' cannot be read" run gone gone.pray
for scene in empty gone; do check "${scene}_is_kept" test "$(cat $scene.pray)" = before; done

check addon in_blender area.blend --python "$here/addon.py" -- "$root/platform/blender/pocketray.py" "$program" addon.pray
check nothing_is_left_behind test -z "$(ls "$work/tmp")"
others='\.(blend|pray|pfm)$|^(bin|tmp|config|scripts|cache|out|said|told|sealed)$'
check nothing_is_left_beside test -z "$(ls | grep -vE "$others")"
[ $failures = 0 ] && echo "blender: passed"
exit $((failures > 0))

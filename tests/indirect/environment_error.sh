#!/usr/bin/env bash
# Usage: environment_error.sh POCKETRAY SCENES FOLDER [options]. For five scenes under a sky and under a picture with a
# sun: ꟻLIP against 1,024 directions and 16 points of the sun, at the centres of the same pixels.
set -euo pipefail
pocketray=$1 scenes=$2 folder=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$folder"
[ -f "$folder/sun.hdr" ] || python3 "$here/environment_scenes.py" "$folder"

one() { # NAME MODEL OPTIONS of the view
  local name=$1 model=$2 environment truth
  shift 2
  for environment in sky:60,3 "$folder/sun.hdr"; do
    truth=$folder/$name-$(basename "${environment%%:*}").png
    if [ ! -f "$truth" ]; then
      "$pocketray" render "$model" "$@" --indirect ambient --environment "$environment" --environment-shadows 256 \
        --area-lights 16 --size 1600x1200 -o "$folder/large.png" > /dev/null 2>&1
      convert "$folder/large.png" -sample 320x240 "$truth"
    fi
    "$pocketray" render "$model" "$@" --indirect ambient --environment "$environment" "${options[@]}" \
      -o "$folder/picture.png" > /dev/null 2>&1
    printf '%s %s %s\n' "$name" "$(basename "$environment")" "$("$pocketray" compare "$folder/picture.png" "$truth" 2> /dev/null | cut -d' ' -f2)"
  done
}

options=("$@")
one hall "$folder/hall.obj" --camera "-9,1.7,-6 8,2.5,1 0,1,0 60"
one cornell cornell
one CornellBox-Empty-CO "$scenes/cornell/mcguire/CornellBox-Empty-CO.obj"
one nefertiti "$scenes/mesh/nefertiti_lowres.obj"
one CesiumMilkTruck "$scenes/gltf/CesiumMilkTruck.glb"

#!/usr/bin/env bash
# Glass: what is left out of trees of rays is not seen. Usage: cli_glass_test.sh PROGRAM [EMULATOR...]
. "$(dirname "$0")/cli.sh"

scenes=${POCKETRAY_SHARED:-}/scenes/gltf
if [ ! -f "$scenes/TransmissionTest.glb" ] || [ ${#run[@]} != 1 ] || ! "${run[@]}" compare --help >/dev/null 2>&1; then
  echo "skipped: the models are absent, or too slow here"
  finish
fi

secondary() {  # JSON : rays by mirrors and glass
  awk -F'[:,]' '/"(mirror|refraction)":/ { sum += $2 } END { print sum + 0 }' "$1"
}

# Goal: at the default depth, the picture is the same to the eye as without the cut-off, with few rays.
for model in TransmissionTest:300000 AttenuationTest:66000; do
  name=${model%:*} most=${model#*:}
  "${run[@]}" render "$scenes/$name.glb" --depth 8 --threads 2 -o $name.ppm --json $name.json >/dev/null 2>&1
  "${run[@]}" render "$scenes/$name.glb" --depth 8 --threads 2 --cut-off 0 -o exact.ppm --json exact.json >/dev/null 2>&1
  expect "${name}_looks_alike" 0 'LIP' compare exact.ppm $name.ppm --fail-above 0.002
  rays=$(secondary $name.json) all=$(secondary exact.json)
  echo "$name: $rays secondary rays, $all without the cut-off"
  check "${name}_takes_few_rays" [ "${rays:-0}" -gt 1000 -a "${rays:-0}" -le "$most" ]
  check "${name}_leaves_rays_out" [ "$rays" -lt "$all" ]
done
finish

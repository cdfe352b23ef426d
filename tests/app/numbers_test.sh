#!/usr/bin/env bash
# Every numeric option of every command with unexpected numbers: exit status 1 or 2 and one line, or 0 if the number is valid;
# never an abort. Usage: numbers_test.sh PROGRAM
# Commands that would run for long also get an argument that they must refuse after reading the number.
set -u
program=$(realpath "$1")
folder=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf "$folder"' EXIT
cd "$folder" || exit 1
passed=0 failed=0

# try MEANINGLESS COMMAND... : exit status 0 is allowed only if the value is meaningful.
try() {
  local meaningless=$1 out status
  shift
  out=$(timeout 60 "$program" "$@" 2>&1 </dev/null)
  status=$?
  if [ "$status" -gt 2 ]; then
    echo "FAILED exit $status: $*: $out" && failed=$((failed + 1))
  elif [ "$status" -eq 0 ] && [ "$meaningless" = 1 ]; then
    echo "FAILED accepted: $*" && failed=$((failed + 1))
  elif [ "$status" -ne 0 ] && [ "$(grep -vc '[0-9] %, .* left$' <<<"$out")" -ne 1 ]; then
    echo "FAILED an error must be one line: $*: $out" && failed=$((failed + 1))
  else
    passed=$((passed + 1))
  fi
}
# sweep "OPTIONS" COMMAND... : tries each option with each value.
sweep() {
  local options=$1 option
  shift
  for option in $options; do
    for value in nan inf -inf ''; do try 1 "$@" "$option=$value"; done
    for value in -1 0 1e30 2e9 4294967296 99999999999999999999; do try 0 "$@" "$option=$value"; done
  done
}

scene="--samples --depth --area-lights --cut-off --texture-max --threads --camera-index --exposure --memory --size"
small=(--size 8x6 --threads 1 --memory 4M)
sweep "${scene/ --size/} --time --orbit --turntable --rotate --frames --budget-ms" render cube "${small[@]}" -o a.ppm
sweep "--size" render cube --memory 4M -o a.ppm
sweep "$scene" plan cube
sweep "--frames" bench cube "${small[@]}" --no-prices --json nowhere/a.json
sweep "--texture-max --patches" bake cube -o nowhere/a.pray
sweep "--scale --frames --rotate" view cube "${small[@]}" --screen none
for place in 0 1 2 3 4 5 6 7 8 9; do
  for value in nan inf -inf 1e19 1e39 -1e300 ''; do
    camera=(0 0 5 0 0 0 0 1 0 40)
    camera[place]=$value
    try 1 render cube "${small[@]}" --camera "${camera[*]}" -o a.ppm
  done
done
for value in 0x0 -1x5 nanxnan 1e3x5 99999999x1 8193x1 5x; do try 1 plan cube --size "$value"; done
if "$program" --help | grep -q ' accuracy '; then
  sweep "--rounds --ppd --time --price-limit --reference-samples" accuracy cube "${small[@]}" -o /dev/null/a
  sweep "--samples --until --part --ppd --time" reference cube "${small[@]}" -o /dev/null/a.pfm
  sweep "--table" coherence-report cube "${small[@]}" -o /dev/null/a
fi

if "$program" --help | grep -q ' serve '; then
  sweep "--threads --clients --memory --scene-memory --size-max --idle" serve --listen 127.0.0.1:0 --scenes nowhere
  ! "$program" --help | grep -q ' split-report ' ||
    sweep "--steps --frames --orbit --device-ns --server-ns --servers" split-report nothing "${small[@]}"
  sweep "--share --price --energy-pixel --energy-byte --cost-weight --cost-cap" \
    render nothing "${small[@]}" --server 127.0.0.1:1 -o a.ppm
  # Options of a device without room for the scene reach the server as typed.
  "$program" serve --listen 127.0.0.1:0 --threads 1 >log 2>&1 </dev/null &
  server=$!
  for _ in $(seq 600); do
    grep -q '^listening' log && break
    sleep 0.1
  done
  address=$(sed -n 's/^listening on \([^:]*:[0-9]*\):.*/\1/p' log)
  thin=(render cornell --size 8x6 --threads 1 --memory 500K --server "$address" -o a.ppm)
  try 0 "${thin[@]}" && [ -s a.ppm ] || { echo "FAILED no frame from $address: $(cat log)"; failed=$((failed + 1)); }
  sweep "--time --exposure --camera-index --cut-off --samples --depth --area-lights" "${thin[@]}"
  try 1 "${thin[@]}" --exposure 61
  try 1 "${thin[@]}" --camera "1e19,0,0 0,0,0 0,1,0 40"
  kill -0 "$server" 2>/dev/null || { echo "FAILED the server died: $(cat log)"; failed=$((failed + 1)); }
fi
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 100 ]

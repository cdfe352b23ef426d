# Shared by the tests of the program: source it with the test's own arguments. PROGRAM [EMULATOR...] PROGRAM is built
# with the sealed heap, so every command also proves that nothing allocates after the seal. A test ends with `finish`.
set -u
program=$(realpath "$1")
shift
run=("$@" "$program")
subject=cornell
[ $# -eq 0 ] || subject=seesaw  # sculpting the statue takes an emulated CPU without FPU ten seconds
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
export XDG_CACHE_HOME=$folder/cache/of_its_own
passed=0 failed=0
news='[0-9] %\(, .* left\)\?$\|^pocketray: \(solved the light\|leaving out the scene.s stored light\) between surfaces'  # of what takes time before an error

# expect NAME STATUS PATTERN COMMAND...: checks the exit status, and a pattern in the output.
expect() {
  local name=$1 status=$2 pattern=$3
  shift 3
  local out got
  out=$("${run[@]}" "$@" 2>&1 </dev/null)
  got=$?
  if [ "$got" -ne "$status" ]; then
    echo "FAILED $name: exit $got, expected $status: $out" && failed=$((failed + 1))
  elif ! grep -qE -- "$pattern" <<<"$out"; then
    echo "FAILED $name: '$pattern' is not in: $out" && failed=$((failed + 1))
  elif [ "$status" -eq 1 ] && [ "$(grep -vc "$news" <<<"$out")" -ne 1 ]; then
    echo "FAILED $name: an error must be one line: $out" && failed=$((failed + 1))
  else
    passed=$((passed + 1))
  fi
}
# Retries, since on a busy machine a server may not come into use within these few frames.
expect_in_use() {
  local name=$1 pattern=$2
  shift 2
  for _ in 1 2 3 4 5 6 7 8 9; do
    "${run[@]}" "$@" 2>&1 </dev/null | grep -E -- "$pattern" >/dev/null && passed=$((passed + 1)) && return
  done
  expect "$name" 0 "$pattern" "$@"
}
check() {
  local name=$1
  shift
  if "$@"; then passed=$((passed + 1)); else echo "FAILED $name: $*" && failed=$((failed + 1)); fi
}
# Waits until a command succeeds, the process ends or 60 s have passed; the checks that follow tell which.
wait_for() {  # PROCESS COMMAND...
  local end=$((SECONDS + 60))
  until "${@:2}" || ! kill -0 "$1" 2>/dev/null || [ $SECONDS -ge $end ]; do sleep 0.05; done
}
small=(--size 32x24 --threads 2)

finish() {  # ends the test
  echo "$passed passed, $failed failed"
  exit $((failed > 0))
}

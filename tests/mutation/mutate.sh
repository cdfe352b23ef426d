#!/usr/bin/env bash
# mutate.sh [--check | --list] [--only FAULT]... [--jobs N] [--build DIR]
# Applies the faults of faults/*.txt one at a time to a copy of the sources, builds and runs test programs until one fails,
# and prints a table and the kill rate. Exit status 1 if a fault survives, is not found in the sources or does not compile;
# 2 for wrong usage.
#   --check      only check that every fault's old text is in its file exactly once
#   --list       print the faults
#   --only FAULT apply only this fault; may be repeated
#   --jobs N     number of copies tested in parallel (default: one per core)
#   --build DIR  folder of the copies (default: build-mutants); removed at the start and at the end
# JSON=FILE in the environment also writes the table as JSON (- is stdout). Needs cmake; uses ninja and ccache if installed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
all_suites="base scene effect brdf indirect accel hard shade reference present plan golden pipeline temporal split wire remote split_report
  accuracy radiosity session app budget sweep coherence_report viewer platform api"
all_suites=${all_suites//$'\n'/ }
import_suites="import fuzz"  # need the importers, which take longer to build: only for faults that name one
seconds_max=240  # anything longer counts as a hang
jobs=$(nproc 2>/dev/null || echo 2) build=$root/build-mutants mode=run
only=() name=() file=() suites=() why=() old=() new=()

usage() {
  echo "mutate.sh: $1" >&2
  sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
fail() {
  echo "mutate.sh: $*" >&2
  exit 1
}

# Reads the faults: one per block, "key: value" lines, blank lines between blocks, comments start with #.
#   name    name of the fault
#   file    file that it is applied to
#   suites  test programs to run first; the others follow
#   why     description of the fault
#   old     text that occurs in the file exactly once; white space matches any white space
#   new     its replacement, may be empty
# Keep the old texts short, so that they outlive changes around them. Do not add faults that no test can notice, such as
# one that only costs time.
read_faults() {
  local line key value n=-1 first=1
  local keys=" name file suites why old new "
  while IFS= read -r line || [ -n "$line" ]; do
    case $line in '#'*) continue ;; '') first=1 && continue ;; esac
    if [ $first = 1 ]; then
      first=0 n=$((n + 1))
      for key in $keys; do printf -v "${key}[$n]" ''; done
    fi
    key=${line%%:*} value=${line#*:} value=${value# }
    case $keys in *" $key "*) printf -v "${key}[$n]" %s "$value" ;; *) fail "faults: no key '$key': $line" ;; esac
  done < <(cat "$here"/faults/*.txt)
}

# Turns a text into a regular expression in which white space matches any white space: clang-format may rewrap its lines.
pattern_of() {
  sed 's/[][\\.*^$(){}?+|]/\\&/g; s/[[:space:]]\{1,\}/[[:space:]]+/g' <<<"$1"
}

# Sets `matched` to the text in the sources under $1 that matches a fault's old text; fails with a message unless there is
# exactly one match.
find_fault() {
  local tree=$1 i=$2 content pattern
  [ -f "$tree/${file[i]}" ] || { echo "${name[i]}: no such file ${file[i]}" && return 1; }
  content=$(<"$tree/${file[i]}")
  pattern=$(pattern_of "${old[i]}")
  [[ $content =~ $pattern ]] || { echo "${name[i]}: ${file[i]} has no text: ${old[i]}" && return 1; }
  matched=${BASH_REMATCH[0]}
  [[ ${content#*"$matched"} =~ $pattern ]] || return 0
  echo "${name[i]}: ${file[i]} has more than once: ${old[i]}" && return 1
}

check_faults() {
  local i suite errors=0 matched
  for i in "${!name[@]}"; do
    if [ -z "${name[i]}" ] || [ -z "${old[i]}" ] || [ -z "${why[i]}" ] || [ -z "${suites[i]}" ]; then
      echo "${name[i]:-fault $((i + 1))}: needs name, file, suites, why and old" && errors=$((errors + 1))
      continue
    fi
    [ "${old[i]}" != "${new[i]}" ] || { echo "${name[i]}: changes nothing" && errors=$((errors + 1)); }
    for suite in ${suites[i]}; do
      case " $all_suites $import_suites " in *" $suite "*) ;; *) echo "${name[i]}: no suite $suite" && errors=$((errors + 1)) ;; esac
    done
    find_fault "$root" "$i" || errors=$((errors + 1))
  done
  for i in $(printf '%s\n' "${name[@]}" | sort | uniq -d); do
    echo "$i: the name of more than one fault" && errors=$((errors + 1))
  done
  [ ${#name[@]} -ge 30 ] || { echo "fewer than thirty faults" && errors=$((errors + 1)); }
  [ $errors = 0 ]
}

# Makes a copy of the sources with its own build folder. No debug information and -O1, to compile faster.
make_copy() {
  local copy=$1 generator=() launcher=()
  mkdir -p "$copy/tree"
  cp -a "$root"/{CMakeLists.txt,src,platform,tests,toolchains,README.md,LICENSE} "$copy/tree"
  ! command -v ninja >/dev/null || generator=(-G Ninja)
  ! command -v ccache >/dev/null || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache)
  cmake -S "$copy/tree" -B "$copy/build" ${generator[@]+"${generator[@]}"} ${launcher[@]+"${launcher[@]}"} \
    -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1 -DPOCKETRAY_WERROR=OFF -DPOCKETRAY_IMPORT=$import \
    -DPOCKETRAY_SHARED="$root/../shared" >"$copy/log" 2>&1 || { cat "$copy/log" >&2; return 1; }
}
build_suites() {  # COPY JOBS SUITE... ; a fixed folder name lets the compiler cache find a copy's objects
  local copy=$1 count=$2
  shift 2
  CCACHE_BASEDIR=$copy CCACHE_NOHASHDIR=1 \
    cmake --build "$copy/build" "-j$count" --target "${@/#/test_}" >"$copy/log" 2>&1
}
run_suite() {  # COPY SUITE : leaves its first failing test in $copy/log
  (cd "$1/build" && timeout $seconds_max "./test_$2" --abort-after=1 --no-colors >"$1/log" 2>&1) 2>/dev/null
}

# Applies a fault to a copy, runs the test programs and reverts the fault. Prints verdict, suite and test.
try_fault() {
  local copy=$1 i=$2 suite test verdict=survived content matched path=$1/tree/${file[$2]}
  find_fault "$copy/tree" "$i" >/dev/null || { printf 'error\t\tnot found' && return; }
  content=$(<"$path")
  printf '%s\n' "${content/"$matched"/"${new[i]}"}" >"$path"
  for suite in ${suites[i]} $all_suites; do
    build_suites "$copy" 1 "$suite" || { cp "$copy/log" "$build/error-${name[i]}.log" && verdict=error test="does not compile" && break; }
    run_suite "$copy" "$suite"
    case $? in
      0) continue ;;
      124) test="(hangs)" ;;
      *) test=$(sed -n 's/^TEST CASE:  *//p' "$copy/log" | head -1) && test=${test:-(crashes)} ;;
    esac
    verdict=killed && break
  done
  [ $verdict != survived ] || suite='' test=''
  printf '%s\n' "$content" >"$path"
  printf '%s\t%s\t%s' "$verdict" "$suite" "$test"
}

# Works on faults that no other job has taken yet.
work() {
  local copy=$1 i start result finished
  for i in "${chosen[@]}"; do
    mkdir "$build/taken/$i" 2>/dev/null || continue
    start=$SECONDS
    result=$(try_fault "$copy" "$i")
    printf '%s\t%s\t%s\t%d\n' "${name[i]}" "${file[i]}" "$result" $((SECONDS - start)) >"$build/result-$i"
    finished=("$build"/result-*)
    printf '%3d of %d  %-34s %s (%d s)\n' ${#finished[@]} ${#chosen[@]} "${name[i]}" \
      "$(tr '\t' ' ' <<<"$result")" $((SECONDS - start)) >&2
  done
}

print_table() {
  awk -F'\t' '
    BEGIN { printf "%-34s %-26s %-9s %-9s %5s  %s\n", "fault", "file", "verdict", "suite", "s", "test" }
    { printf "%-34s %-26s %-9s %-9s %5d  %s\n", $1, $2, $3, $4, $6, $5; ++count[$3] }
    END {
      printf "%d of %d faults killed: %.1f %%", count["killed"], NR, 100 * count["killed"] / NR
      if (count["survived"]) printf ", %d survived", count["survived"]
      if (count["error"]) printf ", %d errors of the list", count["error"]
      print ""
      exit count["killed"] != NR
    }'
}
print_json() {
  awk -F'\t' '
    BEGIN { printf "[" }
    { gsub(/["\\]/, "\\\\&", $5)
      printf "%s\n  {\"fault\": \"%s\", \"file\": \"%s\", \"verdict\": \"%s\", \"suite\": \"%s\", \"test\": \"%s\", \"seconds\": %d}",
        (NR > 1 ? "," : ""), $1, $2, $3, $4, $5, $6 }
    END { print "\n]" }'
}

while [ $# -gt 0 ]; do
  case $1 in
    --check | --list) mode=${1#--} ;;
    --only | --jobs | --build)
      [ $# -ge 2 ] || usage "$1 needs a value"
      case $1 in --only) only+=("$2") ;; --jobs) jobs=$2 ;; --build) build=$2 ;; esac
      shift
      ;;
    *) usage "no option $1" ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || usage "--jobs $jobs: needs a number above 0"

read_faults
check_faults || fail "the faults do not fit the sources"
case $mode in
  check) echo "${#name[@]} faults, each found once" && exit 0 ;;
  list)
    for i in "${!name[@]}"; do printf '%-34s %-26s %s\n' "${name[i]}" "${file[i]}" "${why[i]}"; done
    exit 0
    ;;
esac
chosen=()
for i in "${!name[@]}"; do
  [ ${#only[@]} = 0 ] && chosen+=("$i") && continue
  for wanted in "${only[@]}"; do [ "$wanted" != "${name[i]}" ] || chosen+=("$i"); done
done
[ ${#chosen[@]} -ge ${#only[@]} ] || usage "--only ${only[*]}: --list prints the faults there are"

trap 'kill $(jobs -p) 2>/dev/null; exit 130' INT TERM
[ ! -e "$build" ] || [ -d "$build/taken" ] || fail "$build is not a folder of this script's: remove it"
rm -rf "$build" && mkdir -p "$build/taken" || exit 1
build=$(cd "$build" && pwd)
started=$SECONDS
first_suites=$(for i in "${chosen[@]}"; do printf '%s\n' ${suites[i]}; done | sort -u)
import=OFF
for suite in $import_suites; do [[ $'\n'$first_suites$'\n' != *$'\n'$suite$'\n'* ]] || import=ON; done
echo "building the sources as they are; then ${#chosen[@]} faults, $jobs at a time" >&2
[ "$jobs" -le ${#chosen[@]} ] || jobs=${#chosen[@]}
for ((k = 1; k <= jobs; ++k)); do make_copy "$build/$k" || exit 1; done
build_suites "$build/1" "$jobs" $first_suites || { cat "$build/1/log" >&2; fail "the sources do not build"; }
for suite in $first_suites; do
  run_suite "$build/1" "$suite" || { cat "$build/1/log" >&2; fail "test_$suite fails without any fault"; }
done
for ((k = 1; k <= jobs; ++k)); do
  { [ $k = 1 ] || build_suites "$build/$k" 1 $first_suites; } && work "$build/$k" &
done
wait
results=$(for i in "${chosen[@]}"; do cat "$build/result-$i"; done)
[ -z "${JSON:-}" ] || print_json <<<"$results" >"${JSON/#-//dev/stdout}"
print_table <<<"$results"
status=$?
echo "$((SECONDS - started)) s"
for log in "$build"/error-*.log; do [ ! -f "$log" ] || { echo "---- $log" && grep -m5 error "$log"; } >&2; done
rm -rf "$build"
exit $status

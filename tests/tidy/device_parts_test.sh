#!/usr/bin/env bash
# device_parts_test.sh SOURCES SYMBOLS NM : checks that a device's program has nothing of the desktop's rooms.
# Goal: instruments, importers and the oracle take no room on a device. Method: one function of each room, which must be
# declared there and absent from the program's symbols; functions of a device's rooms are found.
set -eu
sources=$1 symbols=$2 nm=$3
desktop="desktop/reference/decode_accumulation desktop/accuracy/unbiased_rmse desktop/import/import_gltf
  desktop/sweep/load_accumulation desktop/split_report/measure_split desktop/coherence_report/badt_frame
  desktop/radiosity/polygon_form_factor"
device="engine/trace_frame remote/client/make_client"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
names=$("$nm" -C --defined-only "$symbols") || exit 1
has_function() { grep -q " pocketray::$1(" <<<"$names"; }
for function in $desktop $device; do
  grep -qE "\b${function##*/}\(" "$sources/${function%/*}"/*.h || fail "src/${function%/*} declares no ${function##*/}()"
done
for function in $desktop; do ! has_function "${function##*/}" || fail "the program has ${function##*/}() of src/${function%/*}"; done
for function in $device; do has_function "${function##*/}" || fail "the program has no ${function##*/}() of src/${function%/*}"; done
[ $failures = 0 ]

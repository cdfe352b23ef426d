#!/usr/bin/env bash
# targets.sh FOLDER EXPRESSION : prints what must be built for the tests of a build folder that match a regular expression.
set -eu
[ "$2" != . ] || { echo all; exit 0; }
names=$(cd "$1" && ctest -N -R "$2" | sed -n 's/^ *Test *#[0-9]*: //p')
[ -n "$names" ] || { echo "no test matches TESTS='$2'" >&2; exit 1; }
for name in $names; do
  case $name in
    absence | bench_embree | install | documents | source_rules | assertions | mutation_list) echo all ;;
    cli_* | serve | conformance | reconnects | numbers | packages | blender) echo pocketray_sealed ;;
    objects | turns | hard_page | device_profiles | toolchains) echo pocketray_core ;;
    mpi | wrong_cpu | device_parts | pages) echo pocketray ;;
    progressive_cost) echo progressive_cost ;;
    *) echo "test_$name" ;;
  esac
done | sort -u

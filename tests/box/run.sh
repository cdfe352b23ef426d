#!/usr/bin/env bash
# run.sh POCKETRAY MACHINE... : builds the static program for each machine, and tests it there with box_test.py. POCKETRAY is
# this machine's program. Status 77: this system cannot run the machines.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
desktop=$(realpath "$1")
shift
for program in qemu-system-arm qemu-system-aarch64 python3; do
  command -v $program >/dev/null || { echo "test-box: skipped: no $program here" >&2; exit 77; }
done
kernels=$("$here/prepare.sh" "$@") || exit $?
machines=()
for machine in "$@"; do
  case $machine in
    arm926) class=armel ;;
    cortex-a7) class=armhf ;;
    aarch64) class=aarch64 ;;
    *) echo "test-box: no machine '$machine': choose from arm926 cortex-a7 aarch64" >&2; exit 2 ;;
  esac
  make -s -C "$root" DEVICE=$class
  machines+=("$machine=$root/build-$class/pocketray")
done
exec python3 "$here/box_test.py" "$desktop" "$kernels" "${POCKETRAY_MODELS:-$root/../shared/scenes}" "${machines[@]}"

#!/usr/bin/env bash
# device.sh NAME : prints the CPU class to build for, or desktop for this machine. NAME is a device in platform/devices, a class,
# or a target of package.sh.
set -eu
cd "$(dirname "$0")/.."
classes="armhf armel aarch64 armv4t armv6 armv7 mips32 desktop"
for class in $classes; do
  [ "$1" != "$class" ] || { echo "$class"; exit 0; }
done
[ "$1" != portmaster ] || { echo aarch64; exit 0; }  # packages for many devices
name=${1//-/_}
file=platform/devices/$name.h
if grep -qsE 'Device k\w+ =' "$file"; then
  class=$(grep -oE '"(armhf|armel|aarch64|armv4t|armv6|armv7|mips32)"' "$file" | head -n 1 | tr -d '"' || true)
  echo "${class:-desktop}"
  exit 0
fi
devices=$(grep -l 'Device k' platform/devices/*.h 2>/dev/null | grep -v '/device_list\.h' | sed 's|.*/||; s|\.h$||; s|_|-|g' | tr '\n' ' ')
echo "unknown device or CPU class '$1'; choose from: armhf armel aarch64 armv4t armv6 armv7 mips32 portmaster $devices" >&2
exit 1

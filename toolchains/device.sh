#!/usr/bin/env bash
# device.sh NAME : prints the CPU class (armhf, armel, aarch64) to build for a device of platform/devices or for a class itself.
set -eu
cd "$(dirname "$0")/.."
classes="armhf armel aarch64"
for class in $classes; do
  [ "$1" != "$class" ] || { echo "$class"; exit 0; }
done
name=${1//-/_}
file=platform/devices/$name.h
if [ -f "$file" ]; then
  class=$(grep -oE '"(armhf|armel|aarch64)"' "$file" | head -n 1 | tr -d '"')
  [ -z "$class" ] || { echo "$class"; exit 0; }
  echo "$1 has no ARM CPU: build for it without DEVICE=" >&2
  exit 1
fi
devices=$(grep -lE '"(armhf|armel|aarch64)"' platform/devices/*.h 2>/dev/null | sed 's|.*/||; s|\.h$||; s|_|-|g' | tr '\n' ' ')
echo "no device or CPU class '$1'; there are: $classes $devices" >&2
exit 1

#!/usr/bin/env bash
# tidy.sh CLANG-TIDY BUILD : runs clang-tidy with .clang-tidy on every source of src/ and platform/ that BUILD compiles.
set -eu
sed -n 's/^ *"file": *"\(.*\)",\{0,1\}$/\1/p' "$2/compile_commands.json" | grep -E "^$PWD/(src|platform)/" | sort -u |
  xargs -P "$(nproc)" -n 4 "$1" -p "$2" --quiet

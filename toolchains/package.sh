#!/usr/bin/env bash
# package.sh DEVICE PROGRAM DESKTOP FOLDER [SDL2-PROGRAM] : writes the packages of a device's launchers to FOLDER: the static
# PROGRAM, scenes baked by this machine's program DESKTOP, since building them takes an ARM926 a minute, and their thumbnails.
# Devices:
#   miyoo-mini  OnionUI (App/Pocketray) and MinUI (Tools/miyoomini/Pocketray.pak), zip files to unpack on the memory card
#   rg350       OpenDingux, pocketray.opk
#   portmaster  PortMaster, a port in pocketray.zip, also with SDL2-PROGRAM, for screens without a framebuffer
set -eu
device=$1 program=$(realpath "$2") desktop=$(realpath "$3") with_sdl2=${5:+$(realpath "$5")}
mkdir -p "$4"
out=$(realpath "$4")
root=$(cd "$(dirname "$0")/.." && pwd)
title=Pocketray
about="Ray tracer: shadows, mirrors and glass"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
scenes="cornell statue seesaw cube"

# The program, its scenes and its licence; FOLDER PROGRAM-NAME.
fill() {
  mkdir -p "$1/scenes"
  cp "$program" "$1/$2"
  chmod 755 "$1/$2"
  cp "$root/LICENSE" "$1/"
  for scene in $scenes; do
    "$desktop" bake "$scene" -o "$1/scenes/$scene.pray" >/dev/null
    "$desktop" render "$scene" --size 96x72 -o "$1/scenes/$scene.ppm" >/dev/null
  done
}

# Reads the script from standard input.
write_script() { cat >"$1"; chmod 755 "$1"; }

pack() {  # ZIP FOLDER
  rm -f "$out/$1"
  (cd "$2" && zip -q -r -X "$out/$1" .)
  echo "$out/$1"
}

package_onion() {
  local app=$work/onion/App/$title
  fill "$app" pocketray
  "$desktop" render cornell --size 64x64 -o "$app/icon.png" >/dev/null
  cat >"$app/config.json" <<C
{
  "label": "$title",
  "icon": "icon.png",
  "launch": "launch.sh",
  "description": "$about (Start+Select to exit)"
}
C
  write_script "$app/launch.sh" <<'C'
#!/bin/sh
cd "$(dirname "$0")" || exit 1
HOME=. ./pocketray view --device miyoo-mini --scenes scenes --log pocketray.log "$@"
C
  pack pocketray-miyoo-mini-onion.zip "$work/onion"
}

package_minui() {
  local pak=$work/minui/Tools/miyoomini/$title.pak
  fill "$pak" pocketray
  write_script "$pak/launch.sh" <<'C'
#!/bin/sh
cd "$(dirname "$0")" || exit 1
HOME=. ./pocketray view --device miyoo-mini --scenes scenes --log "${LOGS_PATH:-.}/pocketray.txt" "$@"
C
  pack pocketray-miyoo-mini-minui.zip "$work/minui"
}

# The package is mounted read-only: the log goes to the user's folder.
package_opk() {
  fill "$work/opk" pocketray
  "$desktop" render cornell --size 32x32 -o "$work/opk/pocketray.png" >/dev/null
  cat >"$work/opk/default.gcw0.desktop" <<C
[Desktop Entry]
Type=Application
Name=$title
Comment=$about
Exec=launch.sh
Icon=pocketray
Terminal=false
Categories=applications;
C
  write_script "$work/opk/launch.sh" <<'C'
#!/bin/sh
cd "$(dirname "$0")" || exit 1
mkdir -p "$HOME/.pocketray"
exec ./pocketray view --device rg350 --scenes scenes --log "$HOME/.pocketray/pocketray.log" \
  --screenshots "$HOME/.pocketray" "$@"
C
  rm -f "$out/pocketray.opk"
  mksquashfs "$work/opk" "$out/pocketray.opk" -noappend -all-root -comp gzip -quiet -no-progress >/dev/null
  echo "$out/pocketray.opk"
}

package_portmaster() {
  local port=$work/port files
  files=$port/pocketray
  fill "$files" pocketray.aarch64
  [ -z "$with_sdl2" ] || install -m 755 "$with_sdl2" "$files/pocketray-sdl2.aarch64"
  mkdir "$files/licenses"
  mv "$files/LICENSE" "$files/licenses/LICENSE.pocketray.txt"
  "$desktop" render cornell --size 640x480 -o "$port/screenshot.png" >/dev/null
  cat >"$port/port.json" <<C
{
  "version": 2,
  "name": "pocketray.zip",
  "items": ["$title.sh", "pocketray"],
  "items_opt": null,
  "attr": {
    "title": "$title",
    "desc": "$about, in scenes to walk through.",
    "inst": "Ready to run.",
    "genres": ["other"],
    "porter": [],
    "image": {},
    "rtr": true,
    "runtime": null,
    "reqs": [],
    "arch": ["aarch64"]
  }
}
C
  cat >"$port/gameinfo.xml" <<C
<?xml version="1.0" encoding="utf-8"?>
<gameList>
  <game>
    <path>./$title.sh</path>
    <name>$title</name>
    <desc>$about, in scenes to walk through.</desc>
    <image>./pocketray/screenshot.png</image>
  </game>
</gameList>
C
  cat >"$port/README.md" <<C
# $title

$about. Choose a scene with the pad and A.

| Button | Action |
|---|---|
| pad | turn the camera |
| A, B | move nearer, farther |
| L1, R1 | move left, right |
| X | pause |
| Y | show what a frame costs |
| Start | go back to the scene's own view |
| Start + Select | quit |
C
  # The keys that the viewer understands without a device's file.
  cat >"$files/pocketray.gptk" <<C
up = up
down = down
left = left
right = right
a = x
b = z
x = s
y = a
l1 = q
r1 = w
start = enter
back = rightshift
C
  write_script "$port/$title.sh" <<'C'
#!/bin/bash
XDG_DATA_HOME=${XDG_DATA_HOME:-$HOME/.local/share}
for controlfolder in /opt/system/Tools/PortMaster /opt/tools/PortMaster "$XDG_DATA_HOME/PortMaster" /roms/ports/PortMaster; do
  [ -d "$controlfolder" ] && break
done
source "$controlfolder/control.txt"
get_controls
cd "/$directory/ports/pocketray" || exit 1
# With the system's SDL2 if it and the C library suit; otherwise alone on the framebuffer.
program=pocketray.aarch64
./pocketray-sdl2.aarch64 --version >/dev/null 2>&1 && program=pocketray-sdl2.aarch64
$GPTOKEYB "$program" -c "./pocketray.gptk" &
"./$program" view --scenes scenes --log log.txt "$@"
pm_finish
C
  pack pocketray.zip "$port"
}

case $device in
  miyoo-mini) package_onion && package_minui ;;
  rg350) package_opk ;;
  portmaster) package_portmaster ;;
  *) echo "package.sh: no launcher is known for '$device': choose from miyoo-mini rg350 portmaster" >&2; exit 1 ;;
esac

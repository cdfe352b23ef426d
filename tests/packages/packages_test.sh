#!/usr/bin/env bash
# packages_test.sh ROOT POCKETRAY : the packages of toolchains/package.sh have what their launchers look for, and start. Method:
# makes them with this machine's program in place of a device's, unpacks them, compares with the launchers' documentation and
# runs their scripts. The launchers are OnionUI (github.com/OnionUI/Onion, static/packages/App), MinUI (github.com/shauninman/
# MinUI, skeleton/EXTRAS/Tools), OpenDingux (github.com/gcwnow/buildroot/wiki/Package-file-format) and PortMaster
# (portmaster.games/packaging.html, and tools/build_release.py of PortsMaster/PortMaster-New).
set -u
root=$1 program=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
check() {  # NAME COMMAND...
  local name=$1
  shift
  "$@" >"$work/out" 2>&1 && return
  echo "FAILED $name: $*"
  tail -n 3 "$work/out"
  failures=$((failures + 1))
}
missing=
for tool in zip unzip mksquashfs unsquashfs python3; do command -v $tool >/dev/null || missing+=" $tool"; done
[ -z "$missing" ] || { echo "skipped: this system has no$missing"; exit 77; }

package() {  # DEVICE [SDL2-PROGRAM]
  check "package_$1" bash "$root/toolchains/package.sh" "$1" "$program" "$program" "$work/packages" ${2:+"$2"}
}

# The program, runnable, and scenes with thumbnails that the viewer takes.
has_program() {  # FOLDER NAME
  check program_is_executable test -x "$1/$2"
  for scene in cornell statue seesaw cube; do
    check "scene_$scene" "$program" render "$1/scenes/$scene.pray" --size 16x12 -o "$work/a.ppm"
    check "thumbnail_$scene" grep -aqx '96 72' <(head -n 2 "$1/scenes/$scene.ppm")
  done
}
# Runs a launch script on no screen, as a launcher would: from elsewhere, by its absolute path.
starts() {  # LOG SCRIPT [VARIABLE=VALUE...]
  local log=$1 script=$2
  shift 2
  check "$(basename "$script")_is_executable" test -x "$script"
  (cd / && env "$@" "$script" scenes/cube.pray --size 16x12 --screen null --frames 1) >"$work/said" 2>&1
  check "$(basename "$script")_starts" test $? -eq 0
  check the_console_stays_empty test ! -s "$work/said"
  check the_log_is_there test -f "$log"
}
# A launch script names the device whose keys are those that the launcher's system sends, from up to select.
has_keys() {  # SCRIPT DEVICE CODES
  check "$2_is_named_by_$(basename "$1")" grep -qE " view .*--device $2( |$)" "$1"
  check "$2_keys" python3 - "$root/platform/devices" "$2" "$3" <<'P'
import re, sys
folder, device, codes = sys.argv[1:]
def read(name):
    return open(f"{folder}/{name}.h").read()
value = dict(re.findall(r"\b(k[A-Z]\w*) = (\d+)", read("device")))
file = device.replace("-", "_")
table = re.search(r"\bkeys = (k\w+);", read(file))[1]
for name in [file] + re.findall(r'"platform/devices/(\w+)\.h"', read(file)):
    keys = re.search(table + r"\[\] = {(.*?)}", read(name), re.S)
    if keys:
        found = [value[key] for key in re.findall(r"key::(k\w+)", keys[1])]
assert found == codes.split(), f"{found}, not {codes}"
P
}
is_png() { [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ]; }

package miyoo-mini
check onion_unpacks unzip -q "$work/packages/pocketray-miyoo-mini-onion.zip" -d "$work/sd"
app=$work/sd/App/Pocketray
check onion_config python3 - "$app" <<'P'
import json, os, sys
config = json.load(open(os.path.join(sys.argv[1], "config.json")))
assert set(config) == {"label", "icon", "launch", "description"}, config
for key in ("icon", "launch"):
    assert os.path.isfile(os.path.join(sys.argv[1], config[key])), config[key]
P
check onion_icon is_png "$app/icon.png"
has_program "$app" pocketray
starts "$app/pocketray.log" "$app/launch.sh"
mini_keys="103 108 105 106 57 29 42 56 18 20 28 97"  # Onion's src/common/system/keymap_hw.h
has_keys "$app/launch.sh" miyoo-mini "$mini_keys"
check minui_unpacks unzip -q "$work/packages/pocketray-miyoo-mini-minui.zip" -d "$work/sd"
pak=$work/sd/Tools/miyoomini/Pocketray.pak
has_program "$pak" pocketray
mkdir -p "$work/logs"
starts "$work/logs/pocketray.txt" "$pak/launch.sh" LOGS_PATH="$work/logs"
has_keys "$pak/launch.sh" miyoo-mini "$mini_keys"

package rg350
check opk_is_squashfs unsquashfs -q -n -d "$work/opk" "$work/packages/pocketray.opk"
desktop=$work/opk/default.gcw0.desktop
for field in Type=Application Name=Pocketray Exec=launch.sh Icon=pocketray Terminal=false; do
  check "opk_$field" grep -qx "$field" "$desktop"
done
check opk_begins head -n 1 "$desktop"
check opk_section test "$(head -n 1 "$desktop")" = '[Desktop Entry]'
check opk_categories grep -qxE 'Categories=[a-z]+;' "$desktop"
check opk_comment grep -qE '^Comment=.{10,80}$' "$desktop"
check opk_has_unix_lines bash -c '! grep -q $'"'\\r'"' "$1"' - "$desktop"
check opk_icon is_png "$work/opk/pocketray.png"
has_program "$work/opk" pocketray
mkdir -p "$work/home"
chmod -R a-w "$work/opk"
starts "$work/home/.pocketray/pocketray.log" "$work/opk/launch.sh" HOME="$work/home"
chmod -R u+w "$work/opk"
# Its kernel's arch/mips/boot/dts/ingenic/bits/gcw0-base.dtsi: Ctrl, Alt, Space, Shift, Tab, Backspace, Enter, Esc.
has_keys "$work/opk/launch.sh" rg350 "103 108 105 106 29 56 57 42 15 14 28 1"

# In place of the program for SDL2, one that says it ran.
cat >"$work/sdl2" <<'C'
#!/bin/sh
echo "$1" >>sdl2-ran
[ ! -e broken ] && exec ./pocketray.aarch64 "$@"
C
package portmaster "$work/sdl2"
mkdir -p "$work/roms/ports"
check port_unpacks unzip -q "$work/packages/pocketray.zip" -d "$work/roms/ports"
ports=$work/roms/ports
check port_files python3 - "$ports" <<'P'
import json, os, re, sys, xml.etree.ElementTree as tree
folder = sys.argv[1]
port = json.load(open(os.path.join(folder, "port.json")))
assert set(port) == {"version", "name", "items", "items_opt", "attr"}, port
assert port["version"] == 2 and re.fullmatch(r"[a-z0-9][a-z0-9._]*\.zip", port["name"]), port
kinds = {"title": str, "desc": str, "inst": str, "genres": list, "porter": list, "image": dict, "rtr": bool,
         "runtime": type(None), "reqs": list, "arch": list}
assert {key: type(value) for key, value in port["attr"].items()} == kinds, port["attr"]
assert set(port["attr"]["arch"]) <= {"aarch64", "armhf", "x86_64"}
for item in port["items"]:
    assert os.path.exists(os.path.join(folder, item)), item
scripts = [item for item in port["items"] if item.endswith(".sh")]
assert len(scripts) == 1 and scripts[0][0].isupper()
assert os.path.isdir(os.path.join(folder, port["name"][:-4]))
assert os.path.isdir(os.path.join(folder, port["name"][:-4], "licenses"))
for name in ("README.md", "screenshot.png", "gameinfo.xml"):
    assert os.path.isfile(os.path.join(folder, name)), name
game = tree.parse(os.path.join(folder, "gameinfo.xml")).getroot().find("game")
assert game.find("path").text == "./" + scripts[0]
P
check port_screenshot is_png "$ports/screenshot.png"
has_program "$ports/pocketray" pocketray.aarch64
check port_keys bash -c '! grep -vE "^(up|down|left|right|a|b|x|y|l1|r1|start|back) = [a-z]+$" "$1"' - "$ports/pocketray/pocketray.gptk"
# gptokeyb presses the keys that the viewer takes without a device's file: those of evdev.cpp's keyboard.
check port_keys_are_the_keyboards python3 - "$root/platform/linux/evdev.cpp" "$ports/pocketray/pocketray.gptk" <<'P'
import re, sys
keyboard = re.findall(r"KEY_(\w+)", re.search(r"kKeyboard\[.*?\] = {(.*?)}", open(sys.argv[1]).read(), re.S)[1])
pressed = dict(line.split(" = ") for line in open(sys.argv[2]).read().upper().splitlines())
buttons = "UP DOWN LEFT RIGHT A B X Y L1 R1 START BACK".split()
assert [pressed[button] for button in buttons] == keyboard, (pressed, keyboard)
P
# PortMaster's own part of the script, recorded: it sets `directory` and GPTOKEYB.
mkdir -p "$work/data/PortMaster"
cat >"$work/data/PortMaster/control.txt" <<C
directory=${work#/}/roms
GPTOKEYB=true
get_controls() { :; }
pm_finish() { :; }
C
starts "$ports/pocketray/log.txt" "$ports/Pocketray.sh" XDG_DATA_HOME="$work/data"
check port_uses_sdl2 test "$(tr '\n' ' ' <"$ports/pocketray/sdl2-ran")" = "--version view "
touch "$ports/pocketray/broken"
rm "$ports/pocketray/log.txt" "$ports/pocketray/sdl2-ran"
starts "$ports/pocketray/log.txt" "$ports/Pocketray.sh" XDG_DATA_HOME="$work/data"
check port_falls_back_to_the_framebuffer test "$(cat "$ports/pocketray/sdl2-ran")" = "--version"
rm "$ports/pocketray/pocketray-sdl2.aarch64"
starts "$ports/pocketray/log.txt" "$ports/Pocketray.sh" XDG_DATA_HOME="$work/data"

check unknown_launchers_are_refused bash -c '! bash "$1/toolchains/package.sh" gp2x "$2" "$2" "$3" 2>&1 | grep -v "choose from"' - \
  "$root" "$program" "$work/packages"
[ $failures = 0 ] && echo "packages: passed"
exit $((failures > 0))

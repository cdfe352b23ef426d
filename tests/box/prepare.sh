#!/usr/bin/env bash
# prepare.sh MACHINE... : makes what the machines boot, once, and prints the folder with it: Debian's kernels and busybox for
# ARMv7 and 64-bit ARM; for an ARM926 busybox, a kernel of Debian's source and a device tree with a screen of 320×240.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. /etc/os-release
[ "$ID" = debian ] || { echo "test-box: skipped: the kernels come from Debian's packages, and this is $ID" >&2; exit 77; }
folder=${XDG_CACHE_HOME:-${HOME:-$PWD/build}/.cache}/pocketray/box-$VERSION_CODENAME
mkdir -p "$folder"
exec 9>"$folder/lock"
flock 9

unpack() {  # ARCH PACKAGE...
  [ -d "$folder/$1" ] && return
  rm -rf "$folder/$1.part"
  "$here/../../toolchains/unpack_packages.sh" "$1" "$folder/$1.part" "${@:2}"
  mv "$folder/$1.part" "$folder/$1"
}
wanted() { case " $machines " in *" $1 "*) ;; *) return 1 ;; esac; }
machines=$*
if wanted cortex-a7; then unpack armhf busybox-static @linux-image-armmp; fi
if wanted aarch64; then unpack arm64 busybox-static @linux-image-arm64; fi
if ! wanted arm926; then
  echo "$folder"
  exit
fi
unpack armel busybox-static

build_kernel() {
  local source build=$folder/build
  source=$(ls /usr/src/linux-source-*.tar.xz | sort -V | tail -n 1)
  rm -rf "$folder/linux" "$build"
  mkdir "$folder/linux" && tar xJf "$source" -C "$folder/linux" --strip-components 1 || return 1
  export ARCH=arm CROSS_COMPILE=arm-linux-gnueabi-
  make -C "$folder/linux" O="$build" KCONFIG_ALLCONFIG="$here/arm926.config" allnoconfig || return 1
  ! grep -v '^#' "$here/arm926.config" | grep -vxFf "$build/.config" || { echo "the kernel refuses these options"; return 1; }
  make -C "$folder/linux" O="$build" "-j$(nproc)" zImage dtbs
}

# The board's monitor becomes a panel of 320×240 whose bandwidth suffices for 16 bits per pixel. The emulated PL110 shows
# RGB565, but the driver offers it only for a PL111, which has the same registers here: the device tree says it is one.
describe_panel() {  # DTB
  local display=/amba/display@10120000 end=port@0/endpoint@0 monitor pair
  monitor=$(fdtget -t x "$1" $display/$end phandle 2>/dev/null || echo f1)
  fdtput -t x "$1" $display/$end phandle "$monitor"
  fdtput -p -t s "$1" /box-panel compatible panel-dpi
  for pair in clock-frequency:5000000 hactive:320 vactive:240 hback-porch:20 hfront-porch:20 hsync-len:20 vback-porch:6 \
    vfront-porch:6 vsync-len:6 hsync-active:0 vsync-active:0 de-active:1 pixelclk-active:0; do
    fdtput -p -t u "$1" /box-panel/panel-timing "${pair%%:*}" "${pair##*:}"
  done
  fdtput -p -t x "$1" /box-panel/port/endpoint phandle f0
  fdtput -t x "$1" /box-panel/port/endpoint remote-endpoint "$monitor"
  fdtput -t x "$1" $display/$end remote-endpoint f0
  fdtput -t u "$1" $display max-memory-bandwidth 15000000
  fdtput -t x "$1" $display arm,primecell-periphid 00041111
}

kernel=$folder/arm926-$(sha256sum <"$here/arm926.config" | cut -c 1-16)
if [ ! -f "$kernel/zImage" ]; then
  echo "test-box: building a kernel for the ARM926, some minutes, this time only" >&2
  if ! build_kernel >"$folder/kernel.log" 2>&1; then
    tail -n 20 "$folder/kernel.log" >&2
    echo "test-box: the kernel cannot be built; see $folder/kernel.log" >&2
    exit 1
  fi
  mkdir -p "$kernel"
  cp "$folder/build/arch/arm/boot/dts/versatile-pb.dtb" "$folder/build/arch/arm/boot/zImage" "$kernel"
  rm -rf "$folder/linux" "$folder/build"
fi
cp "$kernel/versatile-pb.dtb" "$folder/arm926.dtb"
describe_panel "$folder/arm926.dtb"
ln -sfn "$kernel/zImage" "$folder/arm926-kernel"
echo "$folder"

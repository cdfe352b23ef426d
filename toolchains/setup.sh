#!/usr/bin/env bash
# setup.sh GROUP... : installs the packages that a build needs and this machine lacks. Silent if none is missing.
# Groups: desktop tests ci box box-kernel bench-embree bench-povray contact-sheet pages mpi clang format tidy package x86-32, and the CPU classes. Run by the Makefile and by .ci/run.
set -eu

# Required packages of each group. "command=package" is installed if the command exists; a plain name is a Debian package.
required() {
  local common="cmake=cmake make=make doctest-dev libcli11-dev nlohmann-json3-dev"
  case $1 in
    desktop) echo $common c++=g++ pkg-config=pkg-config zlib1g-dev ;;
    tests | ci) ;;
    box) echo qemu-system-arm=qemu-system-arm python3=python3 ;;
    # The kernel for an ARM926 is built, as Debian has none for a machine that qemu emulates.
    box-kernel) echo fdtput=device-tree-compiler bc=bc flex=flex bison=bison linux-source ;;
    bench-embree) echo libembree-dev unzip=unzip ;;
    bench-povray) echo povray=povray ;;
    contact-sheet) echo blender=blender montage=imagemagick python3=python3 python3-numpy fonts-dejavu-core ;;
    pages) echo chromium=chromium gnuplot=gnuplot-nox python3=python3 fonts-dejavu-core ;;
    mpi) echo mpirun=openmpi-bin libopenmpi-dev ;;
    clang) echo clang++=clang ;;
    format) echo clang-format=clang-format ;;
    tidy) echo clang-tidy=clang-tidy ;;
    armhf | armv7) echo $common arm-linux-gnueabihf-g++=g++-arm-linux-gnueabihf qemu-arm=qemu-user ;;
    armel | armv6) echo $common arm-linux-gnueabi-g++=g++-arm-linux-gnueabi qemu-arm=qemu-user ;;
    mips32) echo $common mipsel-linux-gnu-g++=g++-mipsel-linux-gnu qemu-mipsel=qemu-user ;;
    armv4t | cross) echo $common ;; # the compiler is the user's
    package) echo zip=zip mksquashfs=squashfs-tools ;;
    # Not g++-multilib: that package and the cross compilers exclude each other.
    x86-32) echo $common c++=g++ "g++-$(c++ -dumpversion 2>/dev/null | cut -d. -f1 || echo 12)-multilib" lib32z1-dev qemu-i386=qemu-user ;;
    aarch64) echo $common aarch64-linux-gnu-g++=g++-aarch64-linux-gnu qemu-aarch64=qemu-user ;;
    *) echo "setup.sh: unknown group '$1'" >&2; exit 2 ;;
  esac
}
# Optional packages: the emulator window, model formats, encryption, a faster build.
optional() {
  case $1 in
    armhf | armel | aarch64 | armv6 | armv7 | mips32 | armv4t | cross) echo ninja=ninja-build ;;
    tests) echo openssl=openssl libembree-dev valgrind=valgrind libpng-dev zip=zip unzip=unzip mksquashfs=squashfs-tools ;; # to compare TLS and depth, count instructions, read pictures
    ci) echo ccache=ccache identify=imagemagick ffmpeg=ffmpeg ;; # to build again, and to read animations
    desktop) echo ninja=ninja-build libsdl2-dev libtinygltf-dev libassimp-dev libstb-dev libwebp-dev libdraco-dev libmeshoptimizer-dev libopenexr-dev libmbedtls-dev ;;
  esac
}

# Prints the missing packages among "command=package" and "package" entries.
missing_packages() {
  local entry packages=()
  for entry in "$@"; do
    case $entry in
      *=*) command -v "${entry%%=*}" >/dev/null || echo "${entry#*=}" ;;
      *) packages+=("$entry") ;;
    esac
  done
  [ ${#packages[@]} -gt 0 ] || return 0
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Abbrev}|${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^ii *|//p' || true)
  for entry in "${packages[@]}"; do
    grep -qx "$entry" <<<"$installed" || echo "$entry"
  done
}

needs=() extras=()
for group in "$@"; do
  list=$(required "$group")
  read -ra words <<<"$list"; needs+=("${words[@]}")
  read -ra words <<<"$(optional "$group")"; extras+=(${words[@]+"${words[@]}"})
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  # Another package manager: check the commands; CMake finds and names missing libraries.
  absent=()
  for entry in "${needs[@]}"; do
    case $entry in *=*) command -v "${entry%%=*}" >/dev/null || absent+=("${entry%%=*}") ;; esac
  done
  [ ${#absent[@]} -gt 0 ] || exit 0
  echo "pocketray: these commands are missing: ${absent[*]}" >&2
  echo "Automatic set-up supports only apt-get. Install the equivalents of these Debian packages with your package manager:" >&2
  echo "  needed:    ${needs[*]#*=}" >&2
  echo "  optional:  ${extras[*]#*=}" >&2
  exit 1
fi

mapfile -t needed < <(missing_packages "${needs[@]}")
mapfile -t wanted < <([ ${#extras[@]} -eq 0 ] || missing_packages "${extras[@]}")
# Look only once for optional packages that this system does not offer, not at every build.
stamp=build/.not-available
if [ ${#wanted[@]} -gt 0 ] && [ -f $stamp ]; then
  mapfile -t wanted < <(printf '%s\n' "${wanted[@]}" | grep -vxFf $stamp)
fi
[ ${#needed[@]} -gt 0 ] || [ ${#wanted[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  if command -v sudo >/dev/null; then
    as_root=(sudo)
  elif [ ${#needed[@]} -eq 0 ]; then
    exit 0
  else
    echo "pocketray: run as root: apt-get install ${needed[*]} ${wanted[*]}" >&2
    exit 1
  fi
fi
export DEBIAN_FRONTEND=noninteractive
echo "pocketray: installing what is missing: ${needed[*]} ${wanted[*]}"
${as_root[@]+"${as_root[@]}"} apt-get -q update >/dev/null || echo "pocketray: apt-get update failed; trying with the existing package lists" >&2

available=()
for package in ${wanted[@]+"${wanted[@]}"}; do
  if apt-cache policy "$package" | grep -q 'Candidate: [^(]'; then
    available+=("$package")
  else
    echo "pocketray: this system has no $package; building without it"
    mkdir -p build && echo "$package" >>$stamp
  fi
done
[ ${#needed[@]} -gt 0 ] || [ ${#available[@]} -gt 0 ] || exit 0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! ${as_root[@]+"${as_root[@]}"} apt-get -q install -y --no-install-recommends \
  ${needed[@]+"${needed[@]}"} ${available[@]+"${available[@]}"} >"$log" 2>&1 </dev/null; then
  tail -n 15 "$log" >&2
  echo "pocketray: apt-get failed; see the lines above" >&2
  exit 1
fi

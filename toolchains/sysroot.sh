#!/usr/bin/env bash
# sysroot.sh CLASS : prints a folder with zlib for the target CPU (include/, lib/libz.a) and links to this machine's header-only
# libraries; makes the folder if needed. Installs nothing: it fetches the package into a private apt root, from the mirror that
# this machine already uses, and unpacks it. Adding a foreign architecture to the machine's own package manager does not work
# everywhere.
set -eu
case $1 in
  armhf) arch=armhf ;;
  armel) arch=armel ;;
  aarch64) arch=arm64 ;;
  *) echo "sysroot.sh: unknown CPU class '$1'" >&2; exit 2 ;;
esac
. /etc/os-release
cache=${XDG_CACHE_HOME:-${HOME:-$PWD/build}/.cache}/pocketray
sysroot=$cache/sysroot-${ID:-linux}-${VERSION_CODENAME:-any}-$1
work=$cache/apt-$arch.$$
fail() { echo "pocketray: $*" >&2; echo "Alternatively, put zlib.h, zconf.h and a static libz.a for $1 into $sysroot/include and /lib." >&2; exit 1; }

# Mirror and signature key of the distribution, as /etc/apt has them (one-line and deb822 files alike).
find_mirror() {
  local files
  files=$(find /etc/apt/sources.list /etc/apt/sources.list.d -type f \( -name '*.list' -o -name '*.sources' \) 2>/dev/null || true)
  [ -n "$files" ] || return 0
  # shellcheck disable=SC2086
  grep -hv '^ *#' $files | grep -oE '(https?|file|mirror[^ ]*|ftp)://?[^ ]+/'"$1"'/?( |$)' | tr -d ' ' | head -n 1
}

fetch_zlib() {
  local mirror keyring
  mirror=$(find_mirror "$ID")
  keyring=/usr/share/keyrings/$ID-archive-keyring.gpg
  [ -n "$mirror" ] || fail "found no $ID mirror under /etc/apt to fetch zlib1g-dev:$arch from"
  if [ "$ID" = ubuntu ]; then
    [ "$arch" != armel ] || fail "Ubuntu has no packages for armel"
    # ARM packages are on the ports mirror, whose name derives from the main one's.
    mirror=$(sed -E 's#//([a-z.]*\.)?(archive|security)\.#//ports.#; s#/ubuntu/?$#/ubuntu-ports#' <<<"$mirror")
  fi
  mkdir -p "$work"/etc/{apt.conf.d,preferences.d,sources.list.d} "$work"/state/lists/partial "$work"/cache/archives/partial
  echo "deb [signed-by=$keyring] $mirror $VERSION_CODENAME main" >"$work/etc/sources.list"
  : >"$work/state/status"
  cat >"$work/apt.conf" <<C
Dir::Etc "$work/etc"; Dir::Etc::sourcelist "sources.list"; Dir::Etc::sourceparts "sources.list.d"; Dir::Etc::parts "apt.conf.d";
Dir::State "$work/state"; Dir::State::status "$work/state/status"; Dir::Cache "$work/cache";
APT::Architecture "$arch"; APT::Architectures { "$arch"; }; APT::Sandbox::User "$(id -un)"; Acquire::Languages "none";
C
  # Use this machine's proxy here, too.
  apt-config dump 2>/dev/null | grep -i '^Acquire::https\?::' >>"$work/apt.conf" || true
  export APT_CONFIG=$work/apt.conf
  apt-get -q update >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "cannot read the package list for $arch"; }
  (cd "$work" && apt-get -q download zlib1g-dev >"$work/log" 2>&1) || { cat "$work/log" >&2; fail "cannot fetch zlib1g-dev:$arch"; }
  dpkg -x "$work"/zlib1g-dev_*.deb "$work/unpacked"
  mkdir -p "$work/sysroot/include" "$work/sysroot/lib"
  find "$work/unpacked" -name 'z*.h' -path '*/include/*' -exec cp {} "$work/sysroot/include/" \;
  find "$work/unpacked" -name libz.a -exec cp {} "$work/sysroot/lib/" \;
  [ -f "$work/sysroot/lib/libz.a" ] && [ -f "$work/sysroot/include/zconf.h" ] || fail "zlib1g-dev:$arch has no static library"
  mkdir -p "$cache"
  rm -rf "$sysroot"
  mv "$work/sysroot" "$sysroot"
}

if [ ! -f "$sysroot/lib/libz.a" ]; then
  trap 'rm -rf "$work"' EXIT
  echo "pocketray: fetching zlib for $1" >&2
  fetch_zlib
fi
for library in doctest CLI nlohmann; do
  [ ! -d /usr/include/$library ] || ln -sfn /usr/include/$library "$sysroot/include/$library"
done
echo "$sysroot"

#!/usr/bin/env bash
# unpack_packages.sh ARCH FOLDER PACKAGE... : unpacks packages of another Debian architecture into FOLDER; "@NAME" stands for the
# package that the metapackage NAME depends on first. Installs nothing: it uses a private apt root and the mirror that this
# machine already uses, since adding a foreign architecture to the machine's own package manager does not work everywhere.
set -eu
arch=$1 folder=$2
shift 2
. /etc/os-release
cache=${XDG_CACHE_HOME:-${HOME:-$PWD/build}/.cache}/pocketray
work=$cache/apt-$arch.$$
trap 'rm -rf "$work"' EXIT
fail() { [ ! -f "$work/log" ] || cat "$work/log" >&2; echo "pocketray: $*" >&2; exit 1; }

# Mirror of the distribution, as /etc/apt has it (one-line and deb822 files alike).
find_mirror() {
  local files
  files=$(find /etc/apt/sources.list /etc/apt/sources.list.d -type f \( -name '*.list' -o -name '*.sources' \) 2>/dev/null || true)
  [ -n "$files" ] || return 0
  # shellcheck disable=SC2086
  grep -hv '^ *#' $files | grep -oE '(https?|file|mirror[^ ]*|ftp)://?[^ ]+/'"$1"'/?( |$)' | tr -d ' ' | head -n 1
}

keyring=/usr/share/keyrings/$ID-archive-keyring.gpg
mirror=$(find_mirror "$ID")
[ -n "$mirror" ] || fail "found no $ID mirror under /etc/apt to fetch $*:$arch from"
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
apt-get -q update >"$work/log" 2>&1 || fail "cannot read the package list for $arch"
cd "$work"
for package in "$@"; do
  case $package in @*) package=$(apt-cache depends "${package#@}" | sed -n 's/.*Depends: //p' | head -n 1) ;; esac
  apt-get -q download "$package" >"$work/log" 2>&1 || fail "cannot fetch $package:$arch"
done
mkdir -p "$folder"
for package in "$work"/*.deb; do dpkg -x "$package" "$folder"; done

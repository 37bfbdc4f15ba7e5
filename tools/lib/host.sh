# Where the project is built and run: here, when this is Debian 13 or newer (or an Ubuntu with the same packages), else
# in a Debian 13 root under build/debian13, which leaves the host as it is. Sourced by the scripts in tools/ and .ci/.
#
#   prepare_platform            installs what is missing, or makes the root; quick when nothing is
#   in_platform CMD…            runs CMD there; directory names, stdin, stdout and the exit status are those of here
#   build PRESET TARGET…        configures and builds there
#   parse_common_option ARGS…   --bind DIR; sets SHIFT to the number of words it took
#
# Everything said goes to stderr. A set-up that fails ends the script with status 125, so that it is not taken for
# CMD's own.

set -euo pipefail
[ -e /proc/self/fd/0 ] || exec </dev/null   # a closed stdin would be reused by the next file opened

REPO=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
BUILD=$REPO/build
PACKAGE_LIST=$REPO/tools/debian13-packages.txt
D13=$BUILD/debian13
D13_ROOT=${D13_ROOT:-$D13/root}
BINDS=()
SETUP_FAILED=125

say() { printf 'probewalk: %s\n' "$*" >&2; }
fail() { say "$*"; exit "$SETUP_FAILED"; }
bad_usage() { say "$*"; exit 2; }

packages() { grep -v '^ *\(#\|$\)' "$PACKAGE_LIST"; }

# One set-up at a time in a clone; the others wait.
lock_setup() {
  mkdir -p "$BUILD" || fail "cannot write $BUILD; clone the repository to a place you own"
  exec {SETUP_LOCK}>"$BUILD/.setup.lock"
  flock --nonblock "$SETUP_LOCK" || { say "waiting for another set-up of this clone"; flock "$SETUP_LOCK"; }
}
unlock_setup() { exec {SETUP_LOCK}>&-; }

# ---- which platform

os_field() { sed -n "s/^$1=//p" /etc/os-release 2>/dev/null | tr -d '"'; }

# "native" or "root". Debian without a version is testing or unstable, hence newer than 13.
platform_kind() {
  local version; version=$(os_field VERSION_ID); version=${version%%.*}
  case $(os_field ID) in
    debian) [ "${version:-99}" -ge 13 ] && echo native || echo root ;;
    ubuntu) [ "${version:-0}" -ge 25 ] && packages_known && echo native || echo root ;;
    *) echo root ;;
  esac
}

packages_missing() {  # of the packages given
  comm -23 <(printf '%s\n' "$@" | LC_ALL=C sort -u) \
    <(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null | sed -n 's/ installed$//p' | LC_ALL=C sort -u)
}

packages_known() {
  local names; mapfile -t names < <(packages_missing $(packages))
  [ ${#names[@]} = 0 ] || apt-cache show --no-all-versions "${names[@]}" >/dev/null 2>&1
}

# ---- packages of the host

apt_install() {  # PACKAGE…
  local command=(apt-get install -y --no-install-recommends "$@") log=$BUILD/apt.log become=()
  if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null || { ! sudo -n true 2>/dev/null && ! { [ -t 0 ] && [ -t 2 ]; }; }; then
      say "packages are missing and this user cannot install them. As root, run:"
      fail "  apt-get update && ${command[*]}"
    fi
    become=(sudo)
  fi
  say "installing $# packages from the archive (log: $log)"
  "${become[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update >"$log" 2>&1 </dev/null &&
    "${become[@]}" env DEBIAN_FRONTEND=noninteractive "${command[@]}" >>"$log" 2>&1 </dev/null ||
    { grep '^E:' "$log" >&2 || tail -n 3 "$log" >&2; fail "apt-get failed; see $log"; }
}

need_packages() {  # PACKAGE…
  local missing; mapfile -t missing < <(packages_missing "$@")
  [ ${#missing[@]} = 0 ] || apt_install "${missing[@]}"
}

# ---- the Debian 13 root

# The namespaces of a command in the root: its own mounts, which vanish with it; an ordinary user becomes root there.
namespaces() {
  echo --mount
  [ "$(id -u)" = 0 ] || printf '%s\n' --user --map-root-user
}

root_key() { packages | sha256sum | cut -c1-16; }

remove_root() {  # DIR: nothing is mounted in it, but --one-file-system costs nothing
  [ ! -e "$1" ] || rm -rf --one-file-system "$1"
}

# Makes a Debian 13 root with every package of the list in DIR. About 80 s; .deb files are kept for the next time.
# In a subshell: its clean-up on exit must not take the place of the caller's.
make_root() (  # DIR
  local dir=$1 new=$1.new.$$ log=$D13/root.log cache=$D13/apt-cache include key
  command -v unshare >/dev/null || fail "unshare is missing; install util-linux"
  if ! command -v mmdebstrap >/dev/null; then
    command -v apt-get >/dev/null ||
      fail "this system is older than Debian 13 and has no mmdebstrap to make a Debian 13 root with; install mmdebstrap, or build natively on Debian 13"
    need_packages mmdebstrap debian-archive-keyring
  fi
  unshare $(namespaces) true 2>/dev/null ||
    fail "this system does not let $(id -un) make a mount namespace; run as root, or build natively on Debian 13"
  key=$(root_key)
  include=$(packages | paste -sd, -)
  mkdir -p "$cache" "$(dirname "$dir")"
  say "making a Debian 13 root in ${dir#"$REPO/"}, about two minutes, once; the host stays as it is (log: $log)"
  trap 'remove_root "'"$new"'"' EXIT
  local bootstrap=(mmdebstrap --variant=minbase --aptopt='Acquire::Languages "none"' --include="$include"
    --skip=download/empty --skip=essential/unlink
    --setup-hook='mkdir -p "$1/var/cache/apt/archives"' --setup-hook="sync-in $cache /var/cache/apt/archives"
    --customize-hook="sync-out /var/cache/apt/archives $cache" --customize-hook='rm -f "$1"/var/cache/apt/archives/*.deb')
  if [ "$(id -u)" = 0 ]; then
    "${bootstrap[@]}" --mode=root trixie "$new" >"$log" 2>&1 </dev/null || root_failed "$log"
  else
    # Through a tar, so that every file becomes this user's own and can be removed like any other.
    mkdir -p "$new"
    "${bootstrap[@]}" --mode=unshare --format=tar trixie - 2>"$log" </dev/null |
      tar -x -C "$new" --no-same-owner --exclude='./dev/*' 2>>"$log" || root_failed "$log"
  fi
  # Mounts need something to lie on.
  mkdir -p "$new"/{dev,proc,sys,tmp,run,var/tmp}
  rm -f "$new"/etc/{resolv.conf,hosts}; : >"$new/etc/resolv.conf"; : >"$new/etc/hosts"
  echo "$key" >"$new/.probewalk-key"
  remove_root "$dir.old"
  [ ! -e "$dir" ] || mv "$dir" "$dir.old"
  mv "$new" "$dir"
  remove_root "$dir.old"
)

root_failed() {  # LOG
  grep '^E:' "$1" | tail -n 2 >&2
  fail "mmdebstrap could not make the Debian 13 root (no network? an ordinary user also needs the package uidmap); see $1"
}

prepare_root() {
  local stale
  mkdir -p "$D13"
  exec {ROOT_LOCK}>"$D13_ROOT.lock"
  if [ "$(cat "$D13_ROOT/.probewalk-key" 2>/dev/null || true)" != "$(root_key)" ]; then
    # Commands that run in the old root hold the lock shared.
    flock --nonblock --exclusive "$ROOT_LOCK" ||
      { say "waiting for commands that run in the old Debian 13 root"; flock --exclusive "$ROOT_LOCK"; }
    for stale in "$D13_ROOT".new.*; do remove_root "$stale"; done
    make_root "$D13_ROOT"
    say "this system is $(os_field PRETTY_NAME): a real GPU or headset may not work through the root; for those build" \
      "natively on Debian 13 or newer (the same scripts do it there)"
  fi
  flock --shared "$ROOT_LOCK"
}

prepare_platform() {
  PLATFORM=${PLATFORM:-$(platform_kind)}
  mkdir -p "$BUILD"
  if [ "$PLATFORM" = native ]; then need_packages $(packages); else prepare_root; fi
}

# ---- running there

# Directories of the root that a bound one would hide.
is_system_directory() {
  case $1 in
    / | /bin* | /boot* | /dev* | /etc* | /lib* | /proc* | /run* | /sbin* | /sys* | /usr | /usr/bin* | /usr/lib* | /usr/share* | /var | /var/lib*) return 0 ;;
    *) return 1 ;;
  esac
}

# The directories to bind, parents first, none that lies in another.
directories_to_bind() {
  local dir last=/nowhere
  for dir in "$REPO" "$PWD" "$(pwd -P)" "${HOME:-/}" /tmp "${TMPDIR:-/tmp}" "${BINDS[@]}"; do
    [ -d "$dir" ] && ! is_system_directory "$dir" && printf '%s\n' "$dir"
  done | LC_ALL=C sort -u | while IFS= read -r dir; do
    case $dir/ in "$last"/*) ;; *) last=$dir; printf '%s\n' "$dir" ;; esac
  done
}

# Runs inside the new mount namespace: mounts, then becomes CMD. The root itself is read-only: what is written outside
# the bound directories fails instead of vanishing.
ENTER_ROOT='
  set -e
  root=$1; cwd=$2; count=$3; shift 3
  trap '\''echo "probewalk: cannot set up the mounts of the Debian 13 root; run as root, or build natively on Debian 13" >&2; exit 125'\'' ERR
  mount --bind "$root" "$root"
  mount --rbind /dev "$root/dev"; mount --rbind /proc "$root/proc"; mount --rbind /sys "$root/sys"
  mount -t tmpfs -o mode=755 tmpfs "$root/run"; mount -t tmpfs -o mode=1777 tmpfs "$root/var/tmp"
  for file in /etc/resolv.conf /etc/hosts; do [ ! -r "$file" ] || mount --bind "$(realpath "$file")" "$root$file"; done
  while [ "$count" -gt 0 ]; do
    mkdir -p "$root$1"; mount --rbind "$1" "$root$1"; shift; count=$((count - 1))
  done
  if [ -d "${XDG_RUNTIME_DIR:-}" ]; then
    [ -d "$root$XDG_RUNTIME_DIR" ] || { mkdir -p "$root$XDG_RUNTIME_DIR"; mount --rbind "$XDG_RUNTIME_DIR" "$root$XDG_RUNTIME_DIR"; }
  else
    export XDG_RUNTIME_DIR=/run/user/0; mkdir -p -m 700 "$root$XDG_RUNTIME_DIR"
  fi
  if [ -r "${XAUTHORITY:-}" ] && [ ! -e "$root$XAUTHORITY" ]; then
    mkdir -p "$(dirname "$root$XAUTHORITY")"; : >"$root$XAUTHORITY"; mount --bind "$XAUTHORITY" "$root$XAUTHORITY"
  fi
  mount -o remount,bind,ro "$root"
  trap - ERR
  exec chroot "$root" /usr/bin/env -u LD_PRELOAD -u LD_LIBRARY_PATH -u LIBRARY_PATH -u CPATH -u C_INCLUDE_PATH \
    -u CPLUS_INCLUDE_PATH -u PKG_CONFIG_PATH -u CMAKE_PREFIX_PATH -u CC -u CXX -u CFLAGS -u CXXFLAGS -u LDFLAGS -u LC_ALL \
    LANG=C.UTF-8 PATH="${PROBEWALK_PATH:+$PROBEWALK_PATH:}/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin" \
    bash -c '\''cd "$1" 2>/dev/null || { echo "probewalk: $1 is not visible in the Debian 13 root; go elsewhere" >&2; exit 125; }; shift; exec "$@"'\'' _ "$cwd" "$@"'

# The words that run CMD on the platform, into the array PLATFORM_COMMAND. PROBEWALK_PATH goes before PATH there.
platform_command() {  # CMD…
  if [ "$PLATFORM" = native ]; then
    PLATFORM_COMMAND=(env ${PROBEWALK_PATH:+"PATH=$PROBEWALK_PATH:$PATH"} "$@")
    return
  fi
  local dirs; mapfile -t dirs < <(directories_to_bind)
  PLATFORM_COMMAND=(env ${PROBEWALK_PATH:+"PROBEWALK_PATH=$PROBEWALK_PATH"} unshare $(namespaces)
    bash -c "$ENTER_ROOT" _ "$D13_ROOT" "$PWD" "${#dirs[@]}" "${dirs[@]}" "$@")
}
in_platform() { platform_command "$@"; "${PLATFORM_COMMAND[@]}"; }
exec_in_platform() { platform_command "$@"; exec "${PLATFORM_COMMAND[@]}"; }

build() { in_platform bash "$REPO/tools/lib/build.sh" "$@" </dev/null; }  # PRESET TARGET…

# ---- options that the scripts share

parse_common_option() {
  SHIFT=0
  case ${1:-} in
    --bind) [ $# -ge 2 ] || bad_usage "--bind needs a directory"; add_bind "$2"; SHIFT=2 ;;
    --bind=*) add_bind "${1#--bind=}"; SHIFT=1 ;;
  esac
}

add_bind() {  # DIR
  [ -d "$1" ] || bad_usage "--bind $1: not a directory"
  local dir; dir=$(cd "$1" && pwd)
  ! is_system_directory "$dir" || bad_usage "--bind $1: would hide the Debian 13 root's own $dir; bind a directory below it"
  BINDS+=("$dir")
}

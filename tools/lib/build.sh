#!/usr/bin/env bash
# Configures (once) and builds TARGETS with a preset of CMakePresets.json, on the platform itself. Says nothing when
# there is nothing to do. usage: build.sh PRESET TARGET…
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
preset=$1; shift
dir=build/$preset log=build/$preset.log
export CCACHE_DIR=${CCACHE_DIR:-$PWD/build/ccache} NINJA_STATUS='[%f/%t] '
mkdir -p "$CCACHE_DIR" 2>/dev/null || CCACHE_DIR=$PWD/build/ccache   # one that is not visible here
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1   # clones that share a cache find each other's objects

fail() {
  grep -A 8 -m 3 -E 'error:|FAILED:|CMake Error' "$log" >&2 || tail -n 20 "$log" >&2
  echo "probewalk: $1; see $PWD/$log" >&2
  exit 125
}

if [ ! -e "$dir/build.ninja" ]; then
  echo "probewalk: configuring ($preset)" >&2
  cmake --preset "$preset" >"$log" 2>&1 || { rm -f "$dir/CMakeCache.txt"; fail "configuring failed"; }
fi

# Passes ninja's output on; says one line when something is really built, on a terminal with a counter in place.
show() {
  local line said=
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (Building|Linking|Generating) ]] || continue
    if [ -t 2 ]; then
      printf '\rprobewalk: building (%s) %d of %d ' "$preset" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" >&2
    elif [ -z "$said" ]; then
      echo "probewalk: building ($preset); log: $PWD/$log" >&2
    fi
    said=yes
  done
  [ -z "$said" ] || [ ! -t 2 ] || printf '\n' >&2
}
ninja -C "$dir" -j "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}" "$@" 2>&1 | show >"$log" || fail "building failed"

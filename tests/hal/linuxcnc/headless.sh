# shellcheck shell=bash
# Sourced by hal/faults, hal/cycle and hal/own-plant: LinuxCNC without a screen, in a folder of its own.
# Expects $root and $speed; sets $files and $build.

me=hal/$(basename "$0")
files=${root:?}/tests/hal/linuxcnc

refuse() {
  echo "$me: $1" >&2
  exit 2
}

# Where the components are built; a folder that is built already may be given in STRIBECK_BUILD.
find_components() {
  if ! command -v linuxcnc >/dev/null || [[ ! -f /usr/include/linuxcnc/hal.h ]]; then
    echo "$me: LinuxCNC or its headers are missing: tools/install-dependencies --linuxcnc" >&2
    exit 3
  fi
  build=${STRIBECK_BUILD-}
  if [[ -z $build ]]; then
    build=$root/build/release
    cmake --preset release -S "$root" >/dev/null && cmake --build "$build" --target hal >/dev/null || exit 3
  fi
}

# prepare FOLDER: components and configuration in it.
prepare() {
  rm -rf "$1"
  mkdir -p "$1/modules"
  cp "$build"/hal/stribeck_{axis,contour,plant}.so "$1/modules"
  cp "$build/hal/stribeck_clock.so" "$1"
  cp "$files"/{machine.ini,machine.hal,play.py,program.ngc} "$1"
  touch "$1/machine.var" "$1/tool.tbl"
}

# isolated FOLDER COMMAND…: with the folder's modules, and $speed times faster than the clock.
isolated() {
  local work=$1
  shift
  # LinuxCNC's own threads run under the user it stands for.
  chmod -R a+rwX "$work"
  (cd "$work" && STRIBECK_SPEED=${speed:?} STRIBECK_CLOCK=$work/stribeck_clock.so timeout 300 "$root/hal/isolated" modules "$@")
}

# play FOLDER: LinuxCNC with what was put there; its log is run.log, what it says linuxcnc.out.
play() {
  local rc=0
  STRIBECK_LOG=$1/run.log isolated "$1" linuxcnc -r machine.ini >"$1/linuxcnc.out" 2>&1 || rc=$?
  if ((rc != 0)) || [[ ! -s $1/run.log ]]; then
    tail -n 20 "$1/linuxcnc.out" >&2
    echo "$me: LinuxCNC ended early, see $1/linuxcnc.out" >&2
    return 1
  fi
}

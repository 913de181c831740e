#!/usr/bin/env bash
# DISPLAY program of a headless LinuxCNC for hal/commission: commissions the machine of its folder. LinuxCNC ends when this does.
#
# STRIBECK_STEPS: commissioned  all stages
#                 killed   kills the command while it records, looks whether the machine stops, and gives the command again
#                 started  looks whether the configuration that was written has the models
#                 refused  the command has to end with exit code 1
set -euo pipefail

# The clock that runs faster is for LinuxCNC alone.
unset LD_PRELOAD
steps=$STRIBECK_STEPS
command=(./stribeck commission machine.toml --linuxcnc headless.ini -o commissioned --yes)

fail() {
  echo "commission.sh: $1" >&2
  exit 1
}

# linuxcnc EXPRESSION: of its state, true or false.
linuxcnc() {
  /usr/bin/python3 -c "
import linuxcnc, sys
s = linuxcnc.stat()
s.poll()
sys.exit(not ($1))"
}

# within SECONDS COMMAND…: waits until it succeeds.
within() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    if ((SECONDS > end)); then return 1; fi
    sleep 0.1
  done
}

within 60 linuxcnc 's.joints > 0' || fail 'LinuxCNC has not started'
case $steps in
  killed)
    "${command[@]}" >commission-killed.txt 2>&1 &
    process=$!
    within 120 test -s commissioned/.record/x-sine.halsampler || fail 'it does not come to record'
    kill -KILL "$process"
    wait "$process" || true
    within 20 linuxcnc 's.interp_state == linuxcnc.INTERP_IDLE and s.inpos' || fail 'the machine goes on without the command'
    # shellcheck disable=SC2016 # expanded inside
    within 20 bash -c '! pgrep -x halsampler >/dev/null' || fail 'the recording goes on without the command'
    if [[ -e commissioned/record ]]; then fail 'the stage counts as done'; fi
    "${command[@]}" --json commissioned.json >commission.txt 2>&1 || fail 'it does not go on'
    if grep -q '^--- moves' commission.txt; then fail 'a stage that was done is done again'; fi
    ;;
  commissioned)
    "${command[@]}" --json commissioned.json >commission.txt 2>&1 || fail 'it does not come to its end'
    ;;
  started)
    expected=$(awk '$1 == "setp" && $2 == "ax.x.mass" { print $3 }' stribeck-commissioned.hal)
    mass=$(halcmd getp ax.x.mass)
    awk -v a="$mass" -v b="$expected" 'BEGIN { d = a - b; exit !(b > 0 && d * d < 1e-10 * b * b) }' ||
      fail "ax.x.mass is $mass, expected $expected"
    ;;
  refused)
    rc=0
    "${command[@]}" >commission.txt 2>&1 || rc=$?
    if ((rc != 1)); then fail "exit code $rc, expected 1"; fi
    ;;
esac
touch "$steps.done"

#!/usr/bin/env bash
# cycle.sh N: N times in one rtapi_app, under hal/isolated: loads the three components, runs them, unloads them. Prints the resident
# memory of rtapi_app [KiB] after every tenth time, and exits with 1 when a component did not run.
set -euo pipefail

realtime=/usr/lib/linuxcnc/realtime
$realtime start
trap 'halcmd stop; halcmd unload all; $realtime stop' EXIT
halcmd loadrt threads name1=servo period1=1000000

resident() { awk '/^VmRSS:/ { sum += $2 } END { print sum }' "/proc/$(pgrep -o -x rtapi_app)/status"; }

for ((k = 1; k <= $1; ++k)); do
  result=$(
    halcmd -f <<'END'
loadrt stribeck_axis names=ax.x,ax.y
loadrt stribeck_contour names=ct axes=3
loadrt stribeck_plant names=pl.x
addf ax.x servo
addf ax.y servo
addf ct servo
addf pl.x servo
net force ax.x.force => pl.x.force
net fb pl.x.pos-fb => ax.x.pos-fb
setp pl.x.mass 900
setp pl.x.friction.conventional.alpha0 18
setp pl.x.friction.dynamics 1
setp pl.x.friction.lugre.sigma0 7.2e6
setp pl.x.current.gain 25
setp pl.x.encoder.resolution 1e-7
setp ax.x.mass 900
setp ax.x.friction.conventional.alpha0 18
setp ax.y.mass 900
setp ax.y.friction.conventional.alpha0 -1
setp ct.0.mass 900
setp ct.1.mass 750
setp ct.2.mass 750
setp ct.0.friction.conventional.alpha0 18
setp ct.1.friction.conventional.alpha0 18
setp ct.2.friction.conventional.alpha0 18
setp ct.0.law 3
setp ct.1.law 3
setp ct.2.law 3
setp ct.0.learning.lap 10
setp ct.1.learning.lap 10
setp ct.2.learning.lap 10
setp ax.x.pos-cmd 0.01
setp ax.x.enable 1
setp ax.y.enable 1
setp ct.enable 1
start
loadusr -w sleep 0.02
getp ax.x.fault
getp ax.y.fault
getp ct.faulted
getp pl.x.ok
getp ax.x.force
stop
unloadrt stribeck_axis
unloadrt stribeck_contour
unloadrt stribeck_plant
END
  )
  read -r -d '' fault_x fault_y faulted ok force <<<"$result" || true
  # ax.y was given a parameter that must be refused: fault 6.
  if [[ $fault_x/$fault_y/$faulted/$ok != 0/6/FALSE/TRUE || $force == 0 ]]; then
    echo "cycle.sh: in run $k: faults \"$fault_x\" \"$fault_y\", contour faulted \"$faulted\", plant \"$ok\", force \"$force\"" >&2
    exit 1
  fi
  if ((k % 10 == 0)); then echo "resident $k $(resident)"; fi
done

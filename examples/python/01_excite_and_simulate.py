"""From a machine file to a log: design a motion, run it on the virtual axis.  python3 01_excite_and_simulate.py MACHINE.toml FOLDER"""

import sys
from pathlib import Path

import stribeck
from figure import figure

machine, folder = sys.argv[1], Path(sys.argv[2])
excitation = stribeck.excite(machine, "pulses", "x")
print(excitation)
run = stribeck.simulate(machine, excitation.log, axis="x", seed=1)
print(run)
run.log.save(folder / "log.csv")

log = run.log
with figure(folder / "log.png", "time in s", "position in mm") as axes:
    axes.plot(log["t"], 1e3 * log["x"])

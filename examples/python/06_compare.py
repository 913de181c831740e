"""Controllers on a virtual machine, every trial:  python3 06_compare.py MACHINE.toml FOLDER"""

import sys
from pathlib import Path

import stribeck
from figure import figure

machine, folder = sys.argv[1], Path(sys.argv[2])
result = stribeck.compare(machine, only=["a", "f", "h"], speed="9.5 mm/s", trials=3)
print(result)
largest = result.errors("max_contour_error_um")  # [motion, controller, trial]
for i, name in enumerate(result.controllers):
    print(f"({name}) {result.labels[i]}: {largest[0, i].mean():.2f} um, trials {largest[0, i].round(2)}")

with figure(folder / "contour-error.png", "time in s", "contour error in um") as axes:
    for name in result.controllers:
        trace = result.trace(name)
        axes.plot(trace["t"], 1e6 * trace["contour_error"], label=name)
    axes.legend()

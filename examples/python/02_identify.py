"""Mass and friction of an axis from its log, and the curve as a figure:  python3 02_identify.py FOLDER [LOG]"""

import sys
from pathlib import Path

import stribeck
from figure import figure

folder = Path(sys.argv[1])
log = sys.argv[2] if len(sys.argv) > 2 else folder / "log.csv"

found = stribeck.identify(log)
low, high = found.mass_ci95
print(f"mass {found.mass:.0f} kg, 95 %: {low:.0f} to {high:.0f}")
for warning in found.warnings:
    print("warning:", warning)
found.save(folder / "x.toml")

curve = found.curve
with figure(folder / "friction.png", "velocity in mm/s", "friction in N") as axes:
    axes.fill_between(1e3 * curve["velocity"], curve["ci_low"], curve["ci_high"], alpha=0.3)
    axes.plot(1e3 * curve["velocity"], curve["friction"])
    axes.plot(1e3 * found.map["velocity"], found.map["friction"], ".", markersize=1)

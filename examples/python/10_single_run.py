"""One run along a path with an identified axis file, and its trace:  python3 10_single_run.py MACHINE.toml FOLDER"""

import sys
from pathlib import Path

import numpy as np
import stribeck
from figure import figure

machine, folder = sys.argv[1], Path(sys.argv[2])
with figure(folder / "eight.png", "x in mm", "y in mm") as axes:
    for controller in ("a", "f"):
        run = stribeck.simulate(machine, controller=controller, path="eight", size=0.01, parameters="thesis")
        trace = run.log
        error = trace["contour_error"]
        print(f"({controller}) largest {1e6 * np.abs(error).max():.2f} um, RMS {1e6 * np.sqrt(np.mean(error**2)):.3f} um")
        axes.plot(1e3 * trace["x_x"], 1e3 * trace["x_y"], label=controller)
    axes.legend()

"""How the error spreads when machines differ:  python3 08_study.py STUDY.toml FOLDER"""

import sys
from pathlib import Path

import numpy as np
import stribeck
from figure import figure

study, folder = sys.argv[1], Path(sys.argv[2])
print(stribeck.study(study, folder / "study"))

rows = stribeck.read_table(folder / "study" / "results.csv")
controllers = np.array(rows["controller"])
errors = 1e6 * rows["max_contour_error"]  # m in the table
with figure(folder / "study.png", "largest contour error in um", "machines") as axes:
    for name in np.unique(controllers):
        of_one = errors[controllers == name]
        print(f"({name}) median {np.median(of_one):.2f} um, worst {of_one.max():.2f} um")
        axes.hist(of_one, alpha=0.5, label=name)
    axes.legend()

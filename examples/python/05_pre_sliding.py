"""Friction of an identified axis at a reversal: the steady curve jumps, the bristles do not.  python3 05_pre_sliding.py FOLDER"""

import sys
from pathlib import Path

import numpy as np
import stribeck
from figure import figure

folder = Path(sys.argv[1])
model = stribeck.read_model(folder / "x.toml")
print(model)

sample_time = 1e-5
t = np.arange(0, 0.4, sample_time)
v = 1e-3 * np.cos(2 * np.pi * 5 * t)  # 1 mm/s, 5 Hz
run = model.simulate(v, sample_time=sample_time)
steady = model.friction(v)
print(f"level at 1 mm/s: {model.parts(1e-3)['level']:.0f} N; largest friction {run['friction'].max():.0f} N")

with figure(folder / "pre-sliding.png", "position in um", "friction in N") as axes:
    axes.plot(1e6 * run["x"], steady, label="steady")
    axes.plot(1e6 * run["x"], run["friction"], label=model.dynamics)
    axes.legend()

"""An identification from arrays: a drive of 60 kg with Coulomb and viscous friction.  python3 04_arrays.py"""

import numpy as np
import stribeck

# Ten times as fine as the log, so that its derivatives are exact enough.
t = np.arange(0, 20, 1e-4)
# Two sines and a slow change of amplitude, so that every speed and acceleration occurs.
x = (0.02 + 0.015 * np.sin(0.9 * t)) * np.sin(2.5 * t) + 0.004 * np.sin(11 * t)
v = np.gradient(x, t)
force = 60 * np.gradient(v, t) + 80 * v + 12 * np.sign(v)
t, x, force = t[::10], x[::10], force[::10]
force = force + np.random.default_rng(1).normal(0, 0.5, len(t))

found = stribeck.identify({"t": t, "x": x, "force": force})
print(f"mass {found.mass:.2f} kg, 95 %: {found.mass_ci95[0]:.2f} to {found.mass_ci95[1]:.2f}")
for name in ("coulomb_positive", "viscous_positive"):
    parameter = found.parameters[name]
    print(f"{name} {parameter['value']:.2f} {parameter['unit']}")

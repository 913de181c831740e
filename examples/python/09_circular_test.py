"""A circular test of measured positions: an axis that reverses late by 4 um.  python3 09_circular_test.py"""

import numpy as np
import stribeck

radius, turns = 0.05, 2
angle = np.linspace(0, 2 * np.pi * turns, 8000)
x = radius * np.cos(angle)
y = radius * np.sin(angle)
# The slide stays behind the drive by half the backlash, on the side from which it comes.
measured = x + 2e-6 * np.sign(np.sin(angle))

result = stribeck.evaluate({"x": measured, "y": y, "rx": x, "ry": y}, size=radius, limit={"G": "10 um"})
test = result["logs"][0]["circular_test"]
print(f"G {test['directions'][0]['circular_deviation_um']:.2f} um, within the limit: {result.ok}")
for cause in result["logs"][0]["diagnosis"]["causes"]:
    print(cause["cause"], f"{cause['effect_um']:.2f} um")

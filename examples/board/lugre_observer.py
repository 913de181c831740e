#!/usr/bin/env python3
"""A controller for `stribeck bench`: PD with a LuGre friction observer, over standard input and output.

    dẑ/dt = v − σ0·|v|/g(v)·ẑ − k·e        F = m(r̈ − k_v ė − k_p e) + σ0·ẑ + load        e = x − r

v velocity of the reference (the measured one would chatter), g steady friction of the model with its viscous part, |ẑ| ≤ g/σ0. The
term k·e moves the bristle against the error. Source: Canudas de Wit, Olsson, Åström, Lischinsky 1995, doi:10.1109/9.376053, section V;
without its damping σ1. Lines: docs/board.md.
"""

import bisect
import math
import sys

OMEGA = 40.0  # double pole of the position loop [rad/s]
OBSERVER = 0.05  # k as a share of the speed at which the loop corrects an error [1/s per 1/s]


class Axis:
    def __init__(self):
        self.known = {}
        self.speed, self.friction = [], []
        self.z, self.error = 0.0, None

    def steady(self, v):
        """Friction at a speed, by straight lines between the points."""
        i = min(max(bisect.bisect_left(self.speed, v), 1), len(self.speed) - 1)
        a, b = self.speed[i - 1], self.speed[i]
        if a < 0.0 < b:  # friction jumps at zero
            return self.friction[i] if v >= 0.0 else self.friction[i - 1]
        return self.friction[i - 1] + (v - a) / (b - a) * (self.friction[i] - self.friction[i - 1])

    def step(self, period, position, velocity, acceleration, measured):
        k = self.known
        e = measured - position
        rate = 0.0 if self.error is None else (e - self.error) / period
        self.error = e
        wanted = acceleration - 2.0 * OMEGA * rate - OMEGA * OMEGA * e
        steady = self.steady(velocity)
        sigma0 = k["stiffness"]
        if sigma0 <= 0.0:  # the model has no pre-sliding
            return k["mass"] * wanted + (steady if velocity != 0.0 else 0.0) + k["load"]
        level = max(abs(steady), 1e-9)
        # Exact over a period with the velocity held, so that a stiff bristle is stable.
        slide = sigma0 * abs(velocity) / level
        push = velocity - OBSERVER * OMEGA * e
        fade = math.exp(-slide * period)
        before = self.z
        self.z = before + push * period if slide * period < 1e-9 else before * fade + push / slide * (1.0 - fade)
        self.z = min(max(self.z, -level / sigma0), level / sigma0)
        return k["mass"] * wanted + sigma0 * self.z + k["load"]


def main():
    axes, period = [], 0.0
    for line in sys.stdin:
        words = line.split()
        if words[0] == "axes":
            axes = [Axis() for _ in range(int(words[1]))]
        elif words[0] == "period":
            period = float(words[1])
        elif words[0] == "axis":
            axes[int(words[1])].known = {key: float(value) for key, value in zip(words[2::2], words[3::2])}
        elif words[0] == "friction":
            values = [float(word) for word in words[3:]]
            axes[int(words[1])].speed, axes[int(words[1])].friction = values[::2], values[1::2]
        elif words[0] == "start":
            break
    print("ready", flush=True)
    for line in sys.stdin:
        if line == "end\n":
            return
        numbers = [float(word) for word in line.split()][1:]
        print(*(axis.step(period, *numbers[4 * i:4 * i + 4]) for i, axis in enumerate(axes)), flush=True)


if __name__ == "__main__":
    main()

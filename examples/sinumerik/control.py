#!/usr/bin/env python3
"""A stand-in for a SINUMERIK at the virtual triaxial tool, for the tutorial docs/guides/from-a-trace-to-sinumerik.md.

  control.py capture LOG.csv --axis X -o X.json     the log of `stribeck simulate --reference` in the form of SINUMERIK Edge
  control.py circle [--qec QEC.arc] -o CIRCLE.json  a circle of 10 mm at 9.5 mm/s under the cascade of controllers/cascade.toml, recorded in
                                                    that form; with QEC, quadrant error compensation has the machine data of this archive

The plant of the circle is written here anew, from machines/triaxial-tool.toml: rigid axis, LuGre friction, sine of the screw, noise of
the force, encoder. It shares no code with Stribeck, so that what it shows of an export is not the export's own prediction. Form of the
pulse: docs/guides/export.md. Python from 3.11 on, nothing else.
"""

import argparse
import csv
import json
import math
import random
import re
import sys
import tomllib
from pathlib import Path

CURRENT_PER_VOLT = 0.21  # [A/V], axes.x.plant.drive.amplifier_gain
SUB_STEPS = 5  # of a control period; ten change no error of the circle by more than 2 nm
NUMBERS = {"X": 1, "Y": 2}


def value(text):
    """The number of a quantity, in the unit that its file has."""
    return float(text.split()[0])


# ---- recordings

def write_capture(name, cycle_ms, axes):
    """axes: {letter: (commanded, actual [mm], current [A])}"""
    signals = [{"Name": "CYCLE", "Type": "INTEGER", "Axis": "Cycle", "Address": "CYCLE"}]
    columns = []
    for letter, data in axes.items():
        for signal, column in zip(("DES_POS", "ENC_POS", "CURRENT"), data):
            address = f"{signal}|{NUMBERS[letter]}"
            signals.append({"Name": address, "Type": "DOUBLE", "Axis": letter + "1", "Address": address})
            columns.append(column)
    rows = [[5_000_000 + i, *(round(x, 6) for x in row)] for i, row in enumerate(zip(*columns))]
    capture = {
        "Header": {"Format": "DEFAULT", "MachineInfo": {"MachineName": "virtual triaxial tool"}, "SignalListHFData": signals,
                   "CycleTimeMs": cycle_ms},
        "Payload": [{"HFData": rows[i:i + 500]} for i in range(0, len(rows), 500)],
        "Footer": {},
    }
    Path(name).write_text(json.dumps(capture), encoding="utf-8")
    print(f"{name}: {len(rows)} samples of {cycle_ms:g} ms")


def capture(arguments):
    with open(arguments.log, encoding="utf-8", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        names = [name.split(" ")[0] for name in next(rows)]
        columns = dict(zip(names, zip(*([float(x) for x in row] for row in rows))))
    t = columns["t"]
    # In open loop nothing is commanded; the control then shows the actual position.
    data = (columns.get("r", columns["x"]), columns["x"], [CURRENT_PER_VOLT * u for u in columns["u"]])
    write_capture(arguments.output, round(1e3 * (t[-1] - t[0]) / (len(t) - 1), 6), {arguments.axis: data})


# ---- the machine, in mm, s and N

class Axis:
    def __init__(self, table, seed):
        plant = table["plant"]
        friction, bristle = plant["friction"]["steady"], plant["friction"]["dynamics"]
        self.mass = value(plant["mass"])
        self.gain = value(plant["drive"]["gain"])
        self.coulomb, self.viscous = value(friction["alpha0"]), value(friction["alpha2"])
        self.rise = value(friction["stribeck"]["alpha1"]) - self.coulomb
        self.v0, self.delta = value(friction["stribeck"]["v0"]), friction["stribeck"]["delta"]
        sine = plant["friction"]["eccentric"][0]
        self.sine = value(sine["amplitude"]), 2 * math.pi / value(sine["period"]), value(sine["phase"])
        self.sigma0, self.sigma1, self.fading = (value(bristle[key]) for key in ("sigma0", "sigma1", "damping_velocity"))
        self.step = value(plant["encoder"]["resolution"]) * 1e-6
        self.noise_rms, self.noise_time = value(plant["noise"]["rms"]), 1e-3 * value(plant["noise"]["correlation_time"])
        self.random, self.noise = random.Random(seed), 0.0
        self.x = self.v = self.z = 0.0

    def encoder(self):
        return self.step * math.floor(self.x / self.step + 0.5)

    def rates(self, x, v, z, force):
        level = self.coulomb + self.rise * math.exp(-abs(v / self.v0) ** self.delta)
        slip = v - self.sigma0 * abs(v) / level * z
        damping = self.sigma1 * math.exp(-min((v / self.fading) ** 2, 700.0))
        friction = self.sigma0 * z + damping * slip + self.viscous * v
        friction += self.sine[0] * math.sin(self.sine[1] * x - self.sine[2])
        return v, (force - friction) / self.mass, slip

    def advance(self, force, period):
        """Runge-Kutta of fourth order; the force is held."""
        pole = math.exp(-period / self.noise_time)
        self.noise = pole * self.noise + math.sqrt(1 - pole * pole) * self.random.gauss(0.0, self.noise_rms)
        force += self.noise
        h = period / SUB_STEPS
        for _ in range(SUB_STEPS):
            s = (self.x, self.v, self.z)
            k1 = self.rates(*s, force)
            k2 = self.rates(*(a + h / 2 * k for a, k in zip(s, k1)), force)
            k3 = self.rates(*(a + h / 2 * k for a, k in zip(s, k2)), force)
            k4 = self.rates(*(a + h * k for a, k in zip(s, k3)), force)
            self.x, self.v, self.z = (a + h / 6 * (p + 2 * q + 2 * r + w) for a, p, q, r, w in zip(s, k1, k2, k3, k4))


# ---- the control

class Pulse:
    """MD32520 to MD32570 of one axis."""

    def __init__(self, archive, axis):
        def data(name):
            return float(re.search(rf"\$MA_FRICT_COMP_{name}\[{axis}\]=(\S+)", archive).group(1))
        self.largest, self.smallest = data("CONST_MAX") / 60, data("CONST_MIN") / 60  # mm/s
        self.time = data("TIME")
        self.a1, self.a2, self.a3 = (1e3 * data(f"ACCEL{i}") for i in (1, 2, 3))  # mm/s²

    def amplitude(self, a):
        if a < self.a1:
            return self.largest * a / self.a1
        if a <= self.a2:
            return self.largest
        if a < self.a3:
            return self.largest + (self.smallest - self.largest) * (a - self.a2) / (self.a3 - self.a2)
        return self.smallest


class Loop:
    """P control of position around PI control of velocity; with a pulse on the set-point of velocity after each reversal."""

    def __init__(self, law, mass, period, pulse):
        self.kv, self.kp, self.tn = (value(law[key][0]) for key in ("position_gain", "velocity_gain", "integral_time"))
        self.tn *= 1e-3
        self.mass, self.period, self.pulse_of = mass, period, pulse
        self.integral = self.pulse = self.before = self.direction = 0.0
        self.armed = False

    def force(self, r, r_v, r_a, x, begun):
        velocity = (x - self.before) / self.period if begun else 0.0
        self.before = x
        set_point = r_v + self.kv * (r - x)
        if self.pulse_of:
            self.pulse *= math.exp(-self.period / self.pulse_of.time)
            direction = math.copysign(1.0, r_v) if r_v else 0.0
            if direction:
                self.armed |= self.direction == -direction
                self.direction = direction
            if self.armed and set_point * self.direction > 0:
                self.pulse += self.direction * self.pulse_of.amplitude(abs(r_a))
                self.armed = False
        error = set_point + self.pulse - velocity
        self.integral += self.period * error
        return self.mass * (self.kp * (error + self.integral / self.tn) + r_a)


def circle(arguments):
    root = Path(__file__).resolve().parent.parent.parent
    machine = tomllib.loads((root / "machines/triaxial-tool.toml").read_text(encoding="utf-8"))
    law = tomllib.loads((root / "controllers/cascade.toml").read_text(encoding="utf-8"))["law"]
    period = 1e-3 * value(machine["sample_time"])
    archive = Path(arguments.qec).read_text(encoding="utf-8") if arguments.qec else None
    radius, feed, laps, start = 10.0, 9.5, 2.25, 0.5
    axes = [Axis(machine["axes"][letter.lower()], seed) for seed, letter in enumerate(NUMBERS, 1)]
    axes[0].x = radius
    loops = [Loop(law, axis.mass, period, Pulse(archive, f"AX{i}") if archive else None) for i, axis in enumerate(axes, 1)]
    recorded = [([], [], []) for _ in axes]
    rate = feed / radius
    for n in range(round((laps * 2 * math.pi / rate + start) / period)):
        # Speed rises as a raised cosine in the first half second.
        t = n * period
        s = min(t / start, 1.0)
        angle = rate * (start / 2 * (s - math.sin(math.pi * s) / math.pi) + max(t - start, 0.0))
        w, a = rate * (1 - math.cos(math.pi * s)) / 2, rate * math.pi / start * math.sin(math.pi * s) / 2
        c, d = radius * math.cos(angle), radius * math.sin(angle)
        motion = [(c, -d * w, -c * w * w - d * a), (d, c * w, -d * w * w + c * a)]
        forces = []
        for axis, loop, (r, r_v, r_a), (commanded, actual, current) in zip(axes, loops, motion, recorded):
            force = loop.force(r, r_v, r_a, axis.encoder(), n > 0)
            forces.append(force)
            commanded.append(r)
            actual.append(axis.encoder())
            current.append(force / axis.gain * CURRENT_PER_VOLT)
        for axis, force in zip(axes, forces):
            axis.advance(force, period)
    write_capture(arguments.output, 1e3 * period, dict(zip(NUMBERS, recorded)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(required=True)
    verb = verbs.add_parser("capture")
    verb.add_argument("log")
    verb.add_argument("--axis", choices=NUMBERS, required=True)
    verb.set_defaults(do=capture)
    verb.add_argument("-o", "--output", required=True)
    verb = verbs.add_parser("circle")
    verb.add_argument("--qec")
    verb.add_argument("-o", "--output", required=True)
    verb.set_defaults(do=circle)
    arguments = parser.parse_args()
    arguments.do(arguments)


if __name__ == "__main__":
    sys.exit(main())

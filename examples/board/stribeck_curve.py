#!/usr/bin/env python3
"""stribeck_curve.py ANSWER.toml LOG.csv…: an identifier for `stribeck bench`, with the standard library alone.

    f = m·a + {c + s·exp(−(v/v0)²)}·sgn v + b·v        c, s, b, m by least squares for each v0; v0 by a search

Intervals of 95 % go into ANSWER.json; they take the residuals for independent, which those of a log are not, and so are too narrow.
Source: Armstrong-Hélouvry, Dupont, Canudas de Wit 1994, doi:10.1016/0005-1098(94)90209-7, section 2.1.
"""

import json
import math
import sys

from regression import least_squares, rows_of, sign


def regressors(v, a, v0):
    return (a, sign(v), math.exp(-((v / v0) ** 2)) * sign(v), v)


def main(answer, logs):
    rows = rows_of(logs)
    forces = [f for _, _, f in rows]
    fastest = max(abs(v) for v, _, _ in rows)
    speeds = [fastest * 0.03 * 1.35**k for k in range(11)]
    fits = [(least_squares([regressors(v, a, v0) for v, a, _ in rows], forces), v0) for v0 in speeds]
    usable = [fit for fit in fits if fit[0][0][1] > 0.0 and fit[0][0][1] + fit[0][0][2] > 0.0]
    (found, errors, _), v0 = min(usable, key=lambda fit: fit[0][2])
    mass, coulomb, rise, viscous = found
    with open(answer, "w", encoding="utf-8") as file:
        file.write(f'mass = "{mass!r} kg"\n[friction.steady]\nkind = "conventional"\nalpha0 = "{coulomb!r} N"\n'
                   f'alpha2 = "{max(viscous, 0.0)!r} N s/m"\n'
                   f'stribeck = {{ alpha1 = "{coulomb + rise!r} N", v0 = "{v0!r} m/s", delta = 2 }}\n')
    curve = []
    for k in range(-20, 21):
        v = fastest * k / 20
        if k == 0:
            continue
        row = regressors(v, 0.0, v0)
        force = sum(c * r for c, r in zip(found, row))
        half = 1.96 * math.sqrt(sum((e * r) ** 2 for e, r in zip(errors, row)))
        curve.append({"velocity_mm_per_s": 1e3 * v, "friction_N": force, "ci95_N": [force - half, force + half]})
    with open(answer.removesuffix(".toml") + ".json", "w", encoding="utf-8") as file:
        json.dump({"mass_ci95_kg": [mass - 1.96 * errors[0], mass + 1.96 * errors[0]], "curve": curve}, file)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])

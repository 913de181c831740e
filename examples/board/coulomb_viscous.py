#!/usr/bin/env python3
"""coulomb_viscous.py ANSWER.toml LOG.csv…: an identifier for `stribeck bench`, with the standard library alone.

    f = m·a + c·sgn v + b·v        by least squares over the rows in which the axis slides; the same in both directions
"""

import sys

from regression import least_squares, rows_of, sign


def main(answer, logs):
    rows = rows_of(logs)
    (mass, coulomb, viscous), _, _ = least_squares([(a, sign(v), v) for v, a, _ in rows], [f for _, _, f in rows])
    with open(answer, "w", encoding="utf-8") as file:
        file.write(f'mass = "{mass!r} kg"\n[friction.steady]\nkind = "conventional"\n'
                   f'alpha0 = "{coulomb!r} N"\nalpha2 = "{max(viscous, 0.0)!r} N s/m"\n')


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])

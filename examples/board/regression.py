"""What the two identifiers of this folder share: motion and force from logs, and linear least squares, with the standard library."""

import csv
import math

SLOW = 0.3e-3  # below this speed bristles carry the force, not the curve [m/s]
WINDOW = 0.15  # of the smoothing [s]


def read_log(name):
    """Columns of a log of the board, in SI."""
    scale = {"s": 1.0, "mm": 1e-3, "V": 1.0, "N": 1.0}
    with open(name, encoding="utf-8", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        head = [word.replace("[", "").replace("]", "").split() for word in next(rows)]
        columns = list(zip(*rows))
    return {words[0]: [float(cell) * scale[words[1]] for cell in cells] for words, cells in zip(head, columns)}


def motion(log, period):
    """(velocity, acceleration, force) by a cubic through every window: Savitzky, Golay 1964, doi:10.1021/ac60214a047."""
    half = max(5, round(0.5 * WINDOW / period))
    steps = range(-half, half + 1)
    s2, s4, s6 = (float(sum(j**n for j in steps)) for n in (2, 4, 6))
    n = 2 * half + 1
    slope = [(s6 * j - s4 * j**3) / (s2 * s6 - s4 * s4) for j in steps]
    bend = [(n * j * j - s2) / (n * s4 - s2 * s2) for j in steps]
    force_at = [(s4 - s2 * j * j) / (n * s4 - s2 * s2) for j in steps]
    x, f = log["x"], log["f"]
    for k in range(half, len(x) - half, max(1, round(5e-3 / period))):
        around, forces = x[k - half:k + half + 1], f[k - half:k + half + 1]
        # The force of a row is held until the next one, half a row later than its position.
        held = 0.5 * (sum(map(float.__mul__, force_at, forces)) +
                      sum(map(float.__mul__, force_at, f[k - half - 1:k + half])) if k > half
                      else 2.0 * sum(map(float.__mul__, force_at, forces)))
        yield (sum(map(float.__mul__, slope, around)) / period,
               2.0 * sum(map(float.__mul__, bend, around)) / period**2, held)


def rows_of(names):
    """Rows of all logs in which the axis slides."""
    rows = []
    for name in names:
        log = read_log(name)
        period = (log["t"][-1] - log["t"][0]) / (len(log["t"]) - 1)
        rows += [row for row in motion(log, period) if abs(row[0]) > SLOW]
    return rows


def least_squares(regressors, target):
    """Coefficients, their standard errors for independent residuals, and the sum of squares, by the normal equations."""
    n = len(regressors[0])
    scale = [math.sqrt(sum(row[i] ** 2 for row in regressors)) for i in range(n)]
    matrix = [[sum(row[i] * row[j] for row in regressors) / (scale[i] * scale[j]) for j in range(n)] +
              [sum(row[i] * y for row, y in zip(regressors, target)) / scale[i]] +
              [1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(matrix[k][i]))
        matrix[i], matrix[pivot] = matrix[pivot], matrix[i]
        matrix[i] = [value / matrix[i][i] for value in matrix[i]]
        for k in range(n):
            if k != i:
                matrix[k] = [a - matrix[k][i] * b for a, b in zip(matrix[k], matrix[i])]
    found = [matrix[i][n] / scale[i] for i in range(n)]
    left = sum((y - sum(c * r for c, r in zip(found, row))) ** 2 for row, y in zip(regressors, target))
    variance = left / (len(target) - n)
    errors = [math.sqrt(variance * matrix[i][n + 1 + i]) / scale[i] for i in range(n)]
    return found, errors, left


def sign(v):
    return math.copysign(1.0, v)

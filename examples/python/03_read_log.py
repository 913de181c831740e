"""What a log of any control contains:  python3 03_read_log.py FOLDER [LOG]"""

import sys
from pathlib import Path

import numpy as np
import stribeck

path = sys.argv[2] if len(sys.argv) > 2 else Path(sys.argv[1]) / "log.csv"
log = stribeck.read_log(path)
print(log.source, log.format, log.rows, "rows")
for name in log:
    values = np.asarray(log[name])
    print(f"{name:10} {log.units[name] or 'no unit':8} {values.min():12.6g} to {values.max():.6g}")
for note in log.notes:
    print("note:", note)

"""A model on a log that it was not identified from:  python3 07_verify.py MACHINE.toml FOLDER"""

import sys
from pathlib import Path

import stribeck

machine, folder = sys.argv[1], Path(sys.argv[2])
model = stribeck.read_model(folder / "x.toml")
unseen = stribeck.simulate(machine, stribeck.excite(machine, "sine", "x").log, axis="x", seed=7).log
result = stribeck.verify(model, unseen)
print(result)
print("usable" if result.ok else "not usable")

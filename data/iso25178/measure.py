"""ISO 25178-2 parameters of the maps in the folder given, by surfalize; prints the table surfalize.csv."""

import datetime
import importlib.metadata
import pathlib
import sys

import numpy as np
from surfalize import Surface

NAMES = ["Sa", "Sq", "Ssk", "Sku", "Sp", "Sv", "Sz", "Sdq", "Sdr", "Sk", "Spk", "Svk", "Sal", "Str", "Std", "Spd", "Spc"]
UNITS = ["um", "um", "1", "1", "um", "um", "um", "1", "%", "um", "um", "um", "um", "1", "deg", "1/um^2", "1/um"]

version = importlib.metadata.version("surfalize")
print(f"# surfalize {version}, {datetime.date.today().isoformat()}")
print(",".join(["map"] + [f"{name} [{unit}]" for name, unit in zip(NAMES, UNITS)]))
for name in ["isotropic", "oblong", "grooves"]:
    path = pathlib.Path(sys.argv[1]) / f"{name}.txt"
    step_x, step_y = map(float, path.read_text().split("\n", 1)[0][1:].split())
    # surfalize counts angles with the first row on top.
    surface = Surface(np.loadtxt(path)[::-1], step_x, step_y)
    print(",".join([name] + [f"{float(getattr(surface, n)()):.12g}" for n in NAMES]))

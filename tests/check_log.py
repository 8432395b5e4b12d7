"""Checks a log against the summary of the run that wrote it: check_log.py SUMMARY.json LOG.mcap.

Reads the log with PyPI's `mcap` and `mcap-protobuf-support`, which share no code with the program: the number of
particles in every frame, the number of frames, and the position, density and pressure of one particle must be right.
"""

import json
import struct
import subprocess
import sys
from pathlib import Path

summary = json.loads(Path(sys.argv[1]).read_text())
reader = Path(__file__).with_name("read_log.py")
particles = summary["particles"]
total = sum(particles.values())
printed = subprocess.run(
    [sys.executable, reader, sys.argv[2], "--particles", str(total)], check=True, capture_output=True, text=True
).stdout
log = json.loads(printed)
fluid = log["topics"]["/particles"]
print(json.dumps(fluid, indent=1))

row = fluid["sample"]
assert row["id"] < particles["fluid"], row
# The sampled particle lies in the tank, and its pressure is that of Eq. 7 at its density.
assert 0.0 < row["x"] < 0.4 and 0.0 < row["y"] < 0.41, row
reference = 1000.0 if row["phase"] == 0 else 2000.0
bulk_modulus = 100.0 * 9.81 * 0.2 * 3000.0
expected = bulk_modulus * (row["density"] / reference - 1.0)
# Single precision: 2⁻²⁴ of the density is 0.04 Pa.
assert abs(row["pressure"] - expected) < 1.0, (row, expected)

"""Runs a cloth of 1000 x 1000 particles and checks the memory of the whole run: python check_memory.py MUSLIN DIR"""

import resource
import subprocess
import sys

LIMIT = 600e6  # [B]

muslin, folder = sys.argv[1:]
changes = [
    "cloth.0.grid.columns=1000",
    "cloth.0.grid.rows=1000",
    "run.frame_rate=2000.0",
    "run.duration=0.001",
    "run.step.constant=1.25e-4",
    "expect={}",
]
command = [muslin, "run", "scenes/hanging-100.toml", "--out", folder, "--force"]
subprocess.run(command + [word for change in changes for word in ("--set", change)], check=True)
# Linux counts in kibibytes.
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
print(f"1000 x 1000: peak of {peak / 1e6:.0f} MB")
assert peak < LIMIT, f"more than {LIMIT / 1e6:.0f} MB"

"""Loads trajectory.npz (and series.csv beside it) with NumPy: python check_npz.py TRAJECTORY [first x y z]

Checks names, shapes, types and that every number is finite; with three numbers, that particle 0 starts there [m].
"""

import sys
from pathlib import Path

import numpy as np


def check_trajectory(path, first_position):
    with np.load(path, allow_pickle=False) as archive:
        assert set(archive.files) == {"time", "positions", "velocities", "triangles"}, archive.files
        time, positions = archive["time"], archive["positions"]
        velocities, triangles = archive["velocities"], archive["triangles"]
    frames, particles = len(time), positions.shape[1]
    for name, array, dtype, shape in [
        ("time", time, np.float64, (frames,)),
        ("positions", positions, np.float64, (frames, particles, 3)),
        ("velocities", velocities, np.float64, (frames, particles, 3)),
        ("triangles", triangles, np.uint32, (len(triangles), 3)),
    ]:
        assert array.dtype == dtype, f"{name} is of type {array.dtype}"
        assert array.shape == shape, f"{name} is of shape {array.shape}, expected {shape}"
        assert np.isfinite(array).all(), f"{name} has values that are not finite"
        assert array.flags.c_contiguous, f"{name} is not in C order"
    assert 0 < frames and 0 < particles, "no frame or no particle"
    assert time[0] == 0.0 and (np.diff(time) > 0.0).all(), "time does not ascend from zero"
    assert triangles.size == 0 or triangles.max() < particles, "a triangle names a particle that is not there"
    if first_position is not None:
        assert np.array_equal(positions[0, 0], first_position), f"particle 0 starts at {positions[0, 0]} m"
    print(f"{path}: {frames} frames, {particles} particles, {len(triangles)} triangles")
    return frames


def check_series(path, frames):
    with open(path, encoding="utf-8", newline="") as file:
        header = file.readline()
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2, encoding="utf-8")
    assert header.startswith("time [s]") and header.endswith("\n") and "\r" not in header, repr(header)
    assert len(table) == frames, f"{len(table)} rows for {frames} frames"
    print(f"{path}: {table.shape[0]} rows, {table.shape[1]} columns")


def main():
    path = Path(sys.argv[1])
    first_position = [float(text) for text in sys.argv[2:5]] or None
    frames = check_trajectory(path, first_position)
    series = path.with_name("series.csv")
    if series.exists():
        check_series(series, frames)


if __name__ == "__main__":
    main()

"""Computes a run again from the paper's printed equations: python check_motion.py DIR [SECONDS]

Reads DIR/scene.toml, evaluates the three-level form (5) with the start (6), or its consistent counterpart, in NumPy
over the first SECONDS (default 0.5) of the run, and compares every frame of DIR/trajectory.npz: positions must agree to
1e-9 m. Checks DIR/summary.json's hash of every frame with hashlib on the way.

    (B + C) S(t+h) = 2B S(t) - (B - C) S(t-h) + m g + F_wind + F_int,   B = m / h^2,   C = k_d / 2h
"""

import hashlib
import json
import sys
import tomllib
from pathlib import Path

import numpy as np

# The three-level form loses digits to rounding as the step shrinks, so it is evaluated in the longest floating point type
# there is; in doubles it strays a hundred times as far.
TOLERANCE = 1e-9  # [m]
PI = 4 * np.arctan(np.longdouble(1))
FAMILIES = {
    "structural": [(1, 0), (0, 1)],
    "shear": [(1, 1), (-1, 1)],
    "bend": [(2, 0), (0, 2)],
}


def unit(vector):
    vector = np.array(vector, dtype=np.longdouble)
    return vector / np.linalg.norm(vector)


def tension(springs, extension, rest):
    """Tension [N] of springs of a fabric's table; the tangent law below its cap."""
    stiffness = np.longdouble(springs["stiffness"])
    if springs["law"] == "linear":
        return stiffness * extension
    if springs["law"] == "arctangent-force":
        return np.longdouble("0.06") * stiffness * rest * np.arctan(5 * PI * extension / rest)
    scale = np.longdouble(springs["strain_scale"]) * rest
    initial = stiffness / (np.longdouble("0.3") * PI)
    assert (extension < 1.56 * scale).all(), "a spring beyond the cap of the tangent law"
    return initial * np.where(extension > 0, scale * np.tan(np.maximum(extension, 0) / scale), extension)


class Cloth:
    """One grid: positions (rows, columns, 3) and the forces on them."""

    def __init__(self, table, fabric):
        grid, place = table["grid"], table["place"]
        self.columns, self.rows = grid["columns"], grid["rows"]
        self.fabric = fabric
        spacing = lambda extent, count: extent / (count - 1) if count > 1 else 0.0
        across = unit(place["width_axis"]) * spacing(grid.get("width", 0.0), self.columns)
        along = unit(place["height_axis"]) * spacing(grid.get("height", 0.0), self.rows)
        i, j = np.meshgrid(np.arange(self.columns), np.arange(self.rows))
        self.start = np.array(place["origin"], np.longdouble) + i[..., None] * across + j[..., None] * along
        self.pinned = np.zeros((self.rows, self.columns), bool)
        for pin in table.get("pins", []):
            self.pinned[pin.get("row", slice(None)), pin.get("column", slice(None))] = True

    def internal_forces(self, s):
        forces = np.zeros_like(s)
        for family, offsets in FAMILIES.items():
            springs = self.fabric[family]
            for di, dj in offsets:
                near = (slice(0, self.rows - dj), slice(max(0, -di), self.columns - max(0, di)))
                far = (slice(dj, self.rows), slice(max(0, di), self.columns + min(0, di)))
                vector = s[far] - s[near]
                length = np.linalg.norm(vector, axis=-1, keepdims=True)
                rest = np.linalg.norm(self.start[far] - self.start[near], axis=-1, keepdims=True)
                as_printed = self.fabric.get("force_direction") == "rest-length"
                force = tension(springs, length - rest, rest) * vector / (rest if as_printed else length)
                forces[near] += force
                forces[far] -= force
        return forces


def wind(scene, time):
    total = np.zeros(3)
    for table in scene["environment"].get("wind", []):
        strength = table["amplitude"] * np.sin(table["angular_frequency"] * time + table["phase"])
        total += strength * unit(table["direction"])
    return total


def frames_of(scene, h, steps_per_frame, count):
    """Positions (P, 3) of `count` frames."""
    gravity = np.array(scene["environment"]["gravity"], np.longdouble)
    cloths = [Cloth(table, scene["fabric"][table["fabric"]]) for table in scene["cloth"]]

    def forces(cloth, s, time):
        return cloth.fabric["particle_mass"] * gravity + wind(scene, time) + cloth.internal_forces(s)

    current = [cloth.start.copy() for cloth in cloths]
    before = []
    for cloth, s in zip(cloths, current):
        back = s.copy()
        if scene["run"].get("start", "consistent") == "consistent":
            back += h * h / (2.0 * cloth.fabric["particle_mass"]) * forces(cloth, s, 0.0)
        before.append(back)
    for frame in range(count):
        yield np.concatenate([s.reshape(-1, 3) for s in current])
        for step in range(steps_per_frame):
            time = (frame * steps_per_frame + step) * h
            for n, cloth in enumerate(cloths):
                b, c = cloth.fabric["particle_mass"] / h**2, cloth.fabric["drag"] / (2.0 * h)
                after = 2.0 * b * current[n] - (b - c) * before[n] + forces(cloth, current[n], time)
                after /= b + c
                after[cloth.pinned] = cloth.start[cloth.pinned]
                before[n], current[n] = current[n], after


def main():
    folder = Path(sys.argv[1])
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 0.5
    scene = tomllib.loads((folder / "scene.toml").read_text())
    summary = json.loads((folder / "summary.json").read_text())
    with np.load(folder / "trajectory.npz") as archive:
        positions, velocities = archive["positions"], archive["velocities"]
    for frame, expected in enumerate(summary["frame_hashes"]):
        data = (positions[frame] + 0.0).tobytes() + (velocities[frame] + 0.0).tobytes()
        found = hashlib.sha256(data).hexdigest()
        assert found == expected, f"frame {frame} has the hash {found}, the summary says {expected}"
    rate = scene["run"].get("frame_rate", 60.0)
    steps_per_frame = round(1.0 / (rate * scene["run"]["step"]["constant"]))
    count = min(len(positions), int(seconds * rate) + 1)
    largest = 0.0
    for frame, expected in enumerate(frames_of(scene, np.longdouble(1) / (np.longdouble(rate) * steps_per_frame), steps_per_frame, count)):
        largest = max(largest, np.abs(positions[frame] - expected).max())
    print(f"{folder}: {len(summary['frame_hashes'])} hashes; {count} frames, largest difference to equation (5) {largest:.1e} m")
    assert largest < TOLERANCE, f"more than {TOLERANCE} m"


main()

"""Draws a run as a picture that moves: python animate.py RUN PNG [--check]

RUN is a folder of `muslin run` with one cloth. PNG is an animated PNG on a transparent ground: the part of the run that comes
back nearest to where it began, so that it repeats. Both sides of the cloth have a colour, particles that never move are a pole.
With --check the picture is compared with PNG, and not written. Needs NumPy and Python 3.11.
"""

import struct
import sys
import tomllib
import zlib
from pathlib import Path

import numpy as np

WIDTH, HEIGHT = 640, 440  # pixels
PICTURES = 20.0  # per second
SHORTEST, LONGEST = 1.5, 2.4  # duration [s]
SETTLED = 0.4  # share of the run that is left out at its beginning
FINE = 2  # samples of a pixel along each axis
SHADES, COVERS = 30, FINE * FINE  # of each side; of a pixel
SIDES = [((22, 52, 96), (172, 206, 245)), ((112, 42, 16), (248, 182, 132))]  # from dark to light
POLE = (128, 132, 140)
AZIMUTH, ELEVATION = np.radians([28.0, 14.0])  # of the eye
LIGHT = np.array([-0.8, 0.5, 0.4])
LARGEST_DIFFERENCE = 1e-3  # share of the pixels: sums of numbers differ in their last bits from machine to machine


def main():
    run, target = Path(sys.argv[1]), Path(sys.argv[2])
    scene = tomllib.loads((run / "scene.toml").read_text(encoding="utf-8"))
    grid = scene["cloth"][0]["grid"]
    with np.load(run / "trajectory.npz") as archive:
        time, positions = archive["time"], archive["positions"]
    positions = positions.reshape(len(time), grid["rows"], grid["columns"], 3)
    stride = max(1, round(1.0 / (time[1] * PICTURES)))
    first, last = loop(positions, time[1], stride)
    pictures = draw(positions[first:last:stride])
    print(f"{target}: {len(pictures)} pictures from {time[first]:.2f} s to {time[last]:.2f} s")
    if "--check" in sys.argv[3:]:
        check(pictures, target)
    else:
        target.write_bytes(animated_png(pictures, stride * time[1]))


def loop(positions, interval, stride):
    """Frames between which the motion begins anew: those whose positions, and those one frame later, are most alike."""
    flat = positions.reshape(len(positions), -1)
    start = int(SETTLED * len(flat))
    lengths = range(int(SHORTEST / interval) // stride * stride, int(LONGEST / interval), stride)
    pairs = [(i, i + n) for n in lengths for i in range(start, len(flat) - 1 - n)]
    if not pairs:
        sys.exit(f"the run is shorter than {SHORTEST / (1.0 - SETTLED):.1f} s")
    return min(pairs, key=lambda ends: sum(np.square(flat[ends[0] + k] - flat[ends[1] + k]).sum() for k in (0, 1)))


def draw(frames):
    """Indices of the palette of every picture."""
    right = np.array([np.cos(AZIMUTH), 0.0, -np.sin(AZIMUTH)])
    towards = np.array([np.sin(AZIMUTH) * np.cos(ELEVATION), np.sin(ELEVATION), np.cos(AZIMUTH) * np.cos(ELEVATION)])
    axes = np.stack([right, np.cross(towards, right), towards])
    seen = frames @ axes.T
    low, high = seen.min(axis=(0, 1, 2))[:2], seen.max(axis=(0, 1, 2))[:2]
    scale = FINE * min((WIDTH - 24) / (high[0] - low[0]), (HEIGHT - 24) / (high[1] - low[1]))
    middle = 0.5 * (low + high)
    cell = np.abs(np.diff(frames[0], axis=1)).max() * scale
    count = int(1.6 * cell) + 1  # samples of a cell: more than its pixels, so that there is no hole
    along, across = (interpolation(n, count) for n in frames.shape[2:0:-1])
    poles = still(frames)
    return [picture(frame, axes, poles, (along, across), scale, middle) for frame in frames]


def interpolation(nodes, count):
    """Weights of nodes at `count` points of each cell: Catmull and Rom's cubics."""
    places = np.linspace(0.0, nodes - 1.0, (nodes - 1) * count + 1)
    weights = np.zeros((len(places), nodes))
    cells = np.minimum(places.astype(int), nodes - 2)
    t = places - cells
    cubics = [-t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2]
    for offset, cubic in zip(range(-1, 3), cubics):
        # Beyond an edge the cloth goes on straight.
        node = cells + offset
        inside = np.clip(node, 0, nodes - 1)
        rows = np.arange(len(places))
        np.add.at(weights, (rows, inside), 0.5 * cubic * np.where(node == inside, 1.0, 2.0))
        beyond = node != inside
        np.add.at(weights, (rows[beyond], (2 * inside - node)[beyond]), -0.5 * cubic[beyond])
    return weights


def still(frames):
    """Pairs of neighbours that never move."""
    held = np.ptp(frames, axis=0).max(axis=-1) == 0.0
    pairs = zip(frames[0][:-1][held[:-1] & held[1:]], frames[0][1:][held[:-1] & held[1:]])
    return list(pairs)


def picture(frame, axes, poles, weights, scale, middle):
    along, across = weights
    points = np.einsum("ri,ijk,cj->rck", across, frame, along, optimize=True)
    normals = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    lit = np.abs(normals @ (LIGHT / np.linalg.norm(LIGHT)))
    shade = np.rint(np.clip(0.1 + 1.0 * lit, 0.0, 1.0) * (SHADES - 1))
    value = (normals @ axes[2] < 0.0) * SHADES + shade
    samples, values = [points.reshape(-1, 3)], [value.ravel()]
    for lower, upper in poles:
        # A bar of some pixels, in front of the cloth's edge.
        share = np.linspace(0.0, 1.0, 200)[:, None, None]
        aside = np.arange(-2.0 * FINE, 2.0 * FINE)[None, :, None] / scale * axes[0]
        bar = lower + share * (upper - lower) + aside
        samples.append((bar + 1e-3 * axes[2]).reshape(-1, 3))
        values.append(np.full(bar.shape[0] * bar.shape[1], 2.0 * SHADES))
    return covered(np.concatenate(samples) @ axes.T, np.concatenate(values), scale, middle)


def covered(samples, values, scale, middle):
    """Indices of the palette of pixels that samples fall on, the nearest last."""
    width, height = FINE * WIDTH, FINE * HEIGHT
    x = np.floor(0.5 * width + scale * (samples[:, 0] - middle[0])).astype(int)
    y = np.floor(0.5 * height - scale * (samples[:, 1] - middle[1])).astype(int)
    order = np.argsort(samples[:, 2], kind="stable")
    fine = np.full(width * height, -1.0)
    fine[(np.clip(y, 0, height - 1) * width + np.clip(x, 0, width - 1))[order]] = values[order]
    blocks = fine.reshape(HEIGHT, FINE, WIDTH, FINE).transpose(0, 2, 1, 3).reshape(HEIGHT, WIDTH, COVERS)
    cover = (blocks >= 0.0).sum(axis=-1)
    # One colour of a pixel: that of its most forward kind, at the mean of its shades.
    kind = np.floor(blocks / SHADES).max(axis=-1)
    same = np.floor(blocks / SHADES) == kind[..., None]
    mean = np.rint((blocks * same).sum(axis=-1) / same.sum(axis=-1))
    return np.where(cover > 0, 1 + mean * COVERS + cover - 1, 0).astype(np.uint8)


def palette():
    """Colours and opacities: nothing, then every shade of both sides and the pole by how much of a pixel it covers."""
    def mixed(dark, light, share):
        return tuple(round(d + (l - d) * share) for d, l in zip(dark, light))

    shades = [mixed(*side, i / (SHADES - 1)) for side in SIDES for i in range(SHADES)]
    colours = [(0, 0, 0)] + [shade for shade in [*shades, POLE] for _ in range(COVERS)]
    opacities = [0] + [255 * (i + 1) // COVERS for _ in [*shades, POLE] for i in range(COVERS)]
    return bytes(channel for colour in colours for channel in colour), bytes(opacities)


def animated_png(pictures, interval):
    """PNG, third edition (2025): fcTL before each picture; the first is the IDAT of a viewer that knows no animation."""
    colours, opacities = palette()
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 3, 0, 0, 0)),
        (b"acTL", struct.pack(">II", len(pictures), 0)),
        (b"PLTE", colours),
        (b"tRNS", opacities),
    ]
    sequence = 0
    for picture in pictures:
        delay = round(1000.0 * interval)
        chunks.append((b"fcTL", struct.pack(">IIIIIHHBB", sequence, WIDTH, HEIGHT, 0, 0, delay, 1000, 0, 0)))
        sequence += 1
        data = zlib.compress(np.insert(picture, 0, 0, axis=1).tobytes(), 9)
        if sequence == 1:
            chunks.append((b"IDAT", data))
        else:
            chunks.append((b"fdAT", struct.pack(">I", sequence) + data))
            sequence += 1
    chunks.append((b"IEND", b""))
    parts = [struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def check(pictures, path):
    """Compares `pictures` with those of the file at `path`."""
    known = pictures_of(path.read_bytes())
    if len(known) != len(pictures):
        sys.exit(f"{path} has {len(known)} pictures, but the run {len(pictures)}")
    difference = np.mean([np.mean(a != b) for a, b in zip(known, pictures)])
    if LARGEST_DIFFERENCE < difference:
        sys.exit(f"{path} differs from the run in {100.0 * difference:.2f} % of its pixels")


def pictures_of(data):
    """Indices of the palette of every picture that `animated_png` wrote."""
    pictures, place = [], 8
    while place < len(data):
        length, name = struct.unpack_from(">I4s", data, place)
        content = data[place + 8 : place + 8 + length]
        if name in (b"IDAT", b"fdAT"):
            rows = np.frombuffer(zlib.decompress(content[4 if name == b"fdAT" else 0 :]), np.uint8)
            pictures.append(rows.reshape(HEIGHT, WIDTH + 1)[:, 1:])
        place += 12 + length
    return pictures


main()

"""Plays cloth.glb in Blender and compares it with trajectory.npz: python check_blender.py GLB TRAJECTORY [FRAMES]

Blender imports the file and evaluates it at FRAMES (default 7) frames from the first to the last; every vertex must
be where trajectory.npz has a particle. The file may draw a part of the particles: which ones is found from the first
frame, where each vertex must be at a particle's place, and held from then on.
"""

import sys
import time as clock

import bpy
import numpy as np


def import_glb(path, frame_rate):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # Blender places key times on its own frames: with the run's frame rate, frame n is frame n.
    scene.render.fps = max(1, round(frame_rate))
    scene.render.fps_base = scene.render.fps / frame_rate
    bpy.ops.import_scene.gltf(filepath=path)
    return [thing for thing in scene.objects if thing.type == "MESH" and len(thing.data.vertices) > 0]


def show(frame):
    whole = int(np.floor(frame))
    bpy.context.scene.frame_set(whole, subframe=float(frame - whole))


def world_vertices(thing):
    """Vertices of an object as evaluated now [m], in glTF's axes: Blender's z is up, glTF's y."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", vertices)
    evaluated.to_mesh_clear()
    matrix = np.array(evaluated.matrix_world)
    world = vertices.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    return np.stack([world[:, 0], world[:, 2], -world[:, 1]], axis=1)


def match_particles(vertices, positions, tolerance):
    """For each vertex the first unused particle at its place; all particles in order if that fits."""
    if len(vertices) == len(positions) and np.abs(vertices - positions).max() <= tolerance:
        return np.arange(len(positions))
    keys = {}
    for particle, place in enumerate(np.round(positions / tolerance).astype(np.int64)):
        keys.setdefault(tuple(place), []).append(particle)
    particles = np.empty(len(vertices), dtype=np.int64)
    offsets = [(x, y, z) for x in (0, -1, 1) for y in (0, -1, 1) for z in (0, -1, 1)]
    for vertex, place in enumerate(np.round(vertices / tolerance).astype(np.int64)):
        for offset in offsets:
            found = keys.get(tuple(place + offset))
            if found:
                particles[vertex] = found.pop(0)
                break
        else:
            raise AssertionError(f"no particle at vertex {vertex}: {vertices[vertex]} m")
    return particles


def main():
    glb, trajectory = sys.argv[1:3]
    samples = int(sys.argv[3]) if 3 < len(sys.argv) else 7
    with np.load(trajectory) as archive:
        time, positions = archive["time"], archive["positions"]
    frame_rate = (len(time) - 1) / time[-1] if 1 < len(time) else 60.0

    start = clock.perf_counter()
    things = import_glb(glb, frame_rate)
    print(f"imported in {clock.perf_counter() - start:.2f} s: {[thing.name for thing in things]}")
    assert things, "no mesh was imported"

    # Place, difference (at most twice as large) and sum are rounded to 32 bits: half a unit in the last place of each,
    # that is 2 epsilon of the largest coordinate, and as much again in Blender's own sums. A key's time is rounded too,
    # by half an epsilon of its frame number, in which a vertex moves that part of its way per frame; twice that in sum.
    largest = np.abs(positions).max()
    fastest = np.abs(np.diff(positions, axis=0)).max() if 1 < len(time) else 0.0
    epsilon = np.finfo(np.float32).eps
    tolerance = 4.0 * epsilon * largest + epsilon * len(time) * fastest

    show(0)
    particles = match_particles(np.concatenate([world_vertices(thing) for thing in things]), positions[0], tolerance)
    keys = key_frames(things)
    drawn = sorted({keys[round(n * (len(keys) - 1) / max(1, samples - 1))] for n in range(samples)})
    worst, travelled = 0.0, 0.0
    for frame in drawn:
        show(frame)
        vertices = np.concatenate([world_vertices(thing) for thing in things])
        error = np.abs(vertices - positions[frame, particles]).max()
        worst, travelled = max(worst, error), max(travelled, np.abs(vertices - positions[0, particles]).max())
        assert error <= tolerance, f"frame {frame}: {error:.3g} m off, tolerance {tolerance:.3g} m"
    assert len(time) == 1 or keys[-1] == len(time) - 1, f"the animation ends at frame {keys[-1]} of {len(time) - 1}"
    for before, after in list(zip(keys, keys[1:]))[:3]:
        show((before + after) / 2)
        vertices = np.concatenate([world_vertices(thing) for thing in things])
        error = np.abs(vertices - (positions[before, particles] + positions[after, particles]) / 2).max()
        assert error <= tolerance, f"between frames {before} and {after}: {error:.3g} m off"
    print(
        f"{glb}: {len(things)} objects, {len(particles)} vertices, {len(keys)} keys of {len(time)} frames; "
        f"frames {drawn}: within {worst:.3g} m of {trajectory} (tolerance {tolerance:.3g} m), moved {travelled:.3g} m"
    )


def key_frames(things):
    """Frames of the run that have a key, from the shape keys' names."""
    names = [key.name for key in things[0].data.shape_keys.key_blocks[1:]] if things[0].data.shape_keys else []
    return [0] + [int(name.removeprefix("frame ")) for name in names]


if __name__ == "__main__":
    main()

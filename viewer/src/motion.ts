// The cloth at any time: positions between frames, normals, strains.

import { type Frames, type RunDescription, runFrame, strainOfStep } from "./run";

export class Motion {
  /** Size of a unit of the view [m]: about the extent of the cloth. */
  readonly unit: number;
  /** Positions [units from the run's centre], three per vertex. */
  readonly positions: Float32Array;
  /** Unit normals, three per vertex. */
  readonly normals: Float32Array;
  /** Strains [1], one per vertex. */
  readonly strains: Float32Array;
  /** Centre of the cloth's bounding box [units from the run's centre]. */
  readonly centre: [number, number, number] = [0, 0, 0];
  /** Extent of the run along each axis [units]. */
  readonly runExtent: [number, number, number];
  /** Largest extent of a single frame [units]. */
  readonly frameExtent: number;
  readonly #times: Float64Array;
  readonly #scale: number;
  readonly #stepStrains: Float32Array;

  constructor(
    readonly run: RunDescription,
    readonly frames: Frames,
  ) {
    let frameQuanta = 0;
    for (const extent of frames.extents) frameQuanta = Math.max(frameQuanta, extent);
    // A lone particle has no extent of its own.
    const unitQuanta = Math.max(frameQuanta, Math.max(...run.extent) / 200) || 1;
    this.unit = unitQuanta * run.quantum;
    this.#scale = 1 / unitQuanta;
    this.runExtent = run.extent.map((extent) => extent * this.#scale) as [number, number, number];
    this.frameExtent = frameQuanta * this.#scale;
    this.#times = Float64Array.from({ length: frames.count }, (_, i) => runFrame(run, i) / run.frameRate);
    this.#stepStrains = Float32Array.from({ length: 256 }, (_, i) => strainOfStep(run, i - 128));
    this.positions = new Float32Array(3 * frames.vertexCount);
    this.normals = new Float32Array(3 * frames.vertexCount);
    this.strains = new Float32Array(frames.vertexCount);
  }

  /** Whether anything has a size or moves. */
  get hasExtent(): boolean {
    return this.run.extent.some((extent) => 0 < extent);
  }

  /** Time of the last frame [s]. */
  get duration(): number {
    return this.#times[this.#times.length - 1];
  }

  /** Time of the shown frame `index` [s]. */
  frameTime(index: number): number {
    return this.#times[Math.min(Math.max(index, 0), this.#times.length - 1)];
  }

  /** Last shown frame that is not after `time` [s]. */
  frameAt(time: number): number {
    // A frame's own time, divided and multiplied again, must find that frame.
    const index = Math.floor((time * this.run.frameRate) / this.run.frameStride + 1e-6);
    return Math.min(Math.max(index, 0), this.#times.length - 1);
  }

  /** Overwrites positions and strains with those at `time` [s]; a cubic through the four frames around it. */
  moveTo(time: number): void {
    const { frames } = this;
    const last = frames.count - 1;
    const first = Math.min(this.frameAt(time), Math.max(last - 1, 0));
    const around = [first - 1, first, first + 1, first + 2].map((frame) => Math.min(Math.max(frame, 0), last));
    const weights = this.#weights(around, time);
    const size = 3 * frames.vertexCount;
    const [p, q, r, s] = around.map((frame) => frames.coordinates.subarray(frame * size, (frame + 1) * size));
    const [a, b, c, d] = weights.map((weight) => weight * this.#scale);
    const origin = [0, 1, 2].map((axis) => {
      const sum = around.reduce((total, frame, i) => total + weights[i] * frames.origins[3 * frame + axis], 0);
      return (sum - this.run.extent[axis] / 2) * this.#scale;
    });
    for (let i = 0; i < size; i += 3) {
      this.positions[i] = origin[0] + a * p[i] + b * q[i] + c * r[i] + d * s[i];
      this.positions[i + 1] = origin[1] + a * p[i + 1] + b * q[i + 1] + c * r[i + 1] + d * s[i + 1];
      this.positions[i + 2] = origin[2] + a * p[i + 2] + b * q[i + 2] + c * r[i + 2] + d * s[i + 2];
    }
    for (let axis = 0; axis < 3; axis++) {
      const middle = around.reduce((sum, frame, i) => sum + weights[i] * frames.extents[3 * frame + axis], 0) / 2;
      this.centre[axis] = origin[axis] + middle * this.#scale;
    }
    this.#moveStrains(around[1], around[2], this.#share(around[1], around[2], time));
  }

  /** Overwrites the normals with the area-weighted means over each vertex's triangles. */
  updateNormals(): void {
    const { positions, normals } = this;
    const { triangles } = this.frames;
    normals.fill(0);
    for (let i = 0; i < triangles.length; i += 3) {
      const a = 3 * triangles[i];
      const b = 3 * triangles[i + 1];
      const c = 3 * triangles[i + 2];
      const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
      const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
      const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      normals[a] += x; normals[a + 1] += y; normals[a + 2] += z;
      normals[b] += x; normals[b + 1] += y; normals[b + 2] += z;
      normals[c] += x; normals[c + 1] += y; normals[c + 2] += z;
    }
    for (let i = 0; i < normals.length; i += 3) {
      const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]);
      if (0 < length) {
        normals[i] /= length; normals[i + 1] /= length; normals[i + 2] /= length;
      } else {
        normals[i + 1] = 1;
      }
    }
  }

  /** How often each strain step occurs in the run, from step -128 to 127. */
  strainHistogram(): Uint32Array {
    const counts = new Uint32Array(256);
    for (const step of this.frames.strains) counts[step + 128]++;
    return counts;
  }

  #moveStrains(before: number, after: number, share: number): void {
    const count = this.frames.vertexCount;
    const from = this.frames.strains.subarray(before * count, (before + 1) * count);
    const to = this.frames.strains.subarray(after * count, (after + 1) * count);
    for (let i = 0; i < count; i++) {
      const strain = this.#stepStrains[from[i] + 128];
      this.strains[i] = strain + share * (this.#stepStrains[to[i] + 128] - strain);
    }
  }

  /** Part of the way from frame `before` to `after` at `time`. */
  #share(before: number, after: number, time: number): number {
    const span = this.#times[after] - this.#times[before];
    return 0 < span ? Math.min(Math.max((time - this.#times[before]) / span, 0), 1) : 0;
  }

  /** Weights of four frames in the cubic whose slopes at the middle two are those between their neighbours. */
  #weights([p, q, r, s]: number[], time: number): number[] {
    const u = this.#share(q, r, time);
    const span = this.#times[r] - this.#times[q];
    const slope = (from: number, to: number) => (from < to ? span / (this.#times[to] - this.#times[from]) : 0);
    const [start, end] = [slope(p, r) * u * (1 - u) * (1 - u), slope(q, s) * u * u * (u - 1)];
    const rise = u * u * (3 - 2 * u);
    return [-start, 1 - rise - end, rise + start, end];
  }
}

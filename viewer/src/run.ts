// The run as the page carries it: a description in JSON and a payload of frames.

export interface Series {
  name: string;
  /** One value per time; null where there is none. */
  values: (number | null)[];
}

export interface RunDescription {
  title: string;
  /** What the reader must know first, such as why the run stopped. */
  notice: string | null;
  facts: [string, string][];
  /** Frames of the run per simulated second [1/s]. */
  frameRate: number;
  /** Frames of the run, of which every `frameStride`-th and the last are here. */
  frameCount: number;
  frameStride: number;
  counts: { vertices: number; triangles: number; lines: number; points: number; pins: number };
  /** Lowest corner of the run [m] and its extent [quanta]. */
  low: [number, number, number];
  extent: [number, number, number];
  /** Size of a quantum [m]. */
  quantum: number;
  largestStrain: number;
  /** Times of the series [s]. */
  times: number[];
  energies: Series[];
  strains: Series[];
}

/** The drawable shape (vertex indices) and its frames. */
export interface Frames {
  count: number;
  vertexCount: number;
  triangles: Uint32Array;
  lines: Uint32Array;
  points: Uint32Array;
  pins: Uint32Array;
  /** Per frame: lowest coordinates [quanta from the run's lowest corner]. */
  origins: Int32Array;
  /** Per frame: extent [quanta]. */
  extents: Uint16Array;
  /** Per frame and vertex: coordinates above the frame's origin [quanta]. */
  coordinates: Uint16Array;
  /** Per frame and vertex: strain in steps, see `strainOfStep`. */
  strains: Int8Array;
}

/** Index in the run of the shown frame `index`. */
export function runFrame(run: RunDescription, index: number): number {
  return Math.min(index * run.frameStride, run.frameCount - 1);
}

/** Number of shown frames. */
export function shownFrameCount(run: RunDescription): number {
  return Math.ceil((run.frameCount - 1) / run.frameStride) + 1;
}

/** Strain [1] of a step, finest around zero. */
export function strainOfStep(run: RunDescription, step: number): number {
  return (Math.sign(step) * run.largestStrain * step * step) / (127 * 127);
}

/** The payload's bytes from its base64 text. */
async function unpack(base64: string): Promise<ArrayBuffer> {
  const binary = atob(base64);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  const inflated = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(inflated).arrayBuffer();
}

/** Reads the payload; its layout is described where it is written. */
export async function readFrames(run: RunDescription, base64: string): Promise<Frames> {
  const buffer = await unpack(base64);
  const view = new DataView(buffer);
  const bytes = new Uint8Array(buffer);
  let offset = 0;
  const indices = (length: number): Uint32Array => {
    const values = Uint32Array.from({ length }, (_, i) => view.getUint32(offset + 4 * i, true));
    offset += 4 * length;
    return values;
  };
  const { vertices: vertexCount, triangles, lines, points, pins } = run.counts;
  const count = shownFrameCount(run);
  const frames: Frames = {
    count,
    vertexCount,
    triangles: indices(3 * triangles),
    lines: indices(2 * lines),
    points: indices(points),
    pins: indices(pins),
    origins: new Int32Array(3 * count),
    extents: new Uint16Array(3 * count),
    coordinates: new Uint16Array(3 * count * vertexCount),
    strains: new Int8Array(count * vertexCount),
  };
  // Coordinates modulo 2^16 of the frame before and of the one before that, by axis and vertex.
  let before = new Uint16Array(3 * vertexCount);
  let twoBefore = new Uint16Array(3 * vertexCount);
  for (let frame = 0; frame < count; frame++) {
    const coordinates = frames.coordinates.subarray(3 * frame * vertexCount, 3 * (frame + 1) * vertexCount);
    for (let axis = 0; axis < 3; axis++) frames.origins[3 * frame + axis] = view.getInt32(offset + 4 * axis, true);
    offset += 12;
    for (let axis = 0; axis < 3; axis++) {
      const origin = frames.origins[3 * frame + axis];
      let drift = frame === 0 ? origin : 0;
      let extent = 0;
      for (let vertex = 0; vertex < vertexCount; vertex++) {
        const folded = bytes[offset + vertex] | (bytes[offset + vertexCount + vertex] << 8);
        drift += (folded >> 1) ^ -(folded & 1);
        const at = axis * vertexCount + vertex;
        const predicted = frame === 0 ? 0 : frame === 1 ? before[at] : 2 * before[at] - twoBefore[at];
        const coordinate = predicted + drift;
        const local = (coordinate - origin) & 0xffff;
        coordinates[3 * vertex + axis] = local;
        if (extent < local) extent = local;
        twoBefore[at] = coordinate & 0xffff;
      }
      frames.extents[3 * frame + axis] = extent;
      offset += 2 * vertexCount;
    }
    [before, twoBefore] = [twoBefore, before];
    const strains = frames.strains.subarray(frame * vertexCount, (frame + 1) * vertexCount);
    for (let vertex = 0; vertex < vertexCount; vertex++) {
      const last = frame === 0 ? 0 : frames.strains[(frame - 1) * vertexCount + vertex];
      strains[vertex] = last + bytes[offset + vertex];
    }
    offset += vertexCount;
  }
  if (offset !== buffer.byteLength) throw new Error("the frames in this file are incomplete");
  return frames;
}

// Where the camera stands so that the whole run is in the picture.

import { PerspectiveCamera, Vector3 } from "three";
import type { Motion } from "./motion";

const SAMPLED_FRAMES = 24;
const SAMPLED_VERTICES = 2500;
/** Share of the picture that the run fills. */
const FILL = 0.84;
/** Least share of the picture's upper half that is left to the run below the buttons. */
const LEAST_FILL = 0.4;
const AZIMUTH = (28 * Math.PI) / 180;
const ELEVATION = (14 * Math.PI) / 180;

/** Points of the run: as they are, and relative to the centre of their frame. */
export interface Samples {
  run: Vector3[];
  frame: Vector3[];
  /** Direction from the run to the camera. */
  direction: Vector3;
}

/** Samples the run, and finds the side from which the cloth shows most of its face. */
export function sampleRun(motion: Motion): Samples {
  const { frames } = motion;
  const run: Vector3[] = [];
  const frame: Vector3[] = [];
  const stride = Math.max(1, Math.ceil(frames.vertexCount / SAMPLED_VERTICES));
  const count = Math.min(SAMPLED_FRAMES, frames.count);
  let [facingX, facingZ] = [0, 0];
  for (let sample = 0; sample < count; sample++) {
    motion.moveTo(motion.frameTime(Math.round((sample * (frames.count - 1)) / Math.max(count - 1, 1))));
    motion.updateNormals();
    const centre = new Vector3(...motion.centre);
    for (let vertex = 0; vertex < frames.vertexCount; vertex += stride) {
      const point = new Vector3().fromArray(motion.positions, 3 * vertex);
      run.push(point);
      frame.push(point.clone().sub(centre));
      facingX += Math.abs(motion.normals[3 * vertex]);
      facingZ += Math.abs(motion.normals[3 * vertex + 2]);
    }
  }
  const azimuth = facingZ < facingX ? Math.PI / 2 - AZIMUTH : AZIMUTH;
  const level = Math.cos(ELEVATION);
  const direction = new Vector3(level * Math.sin(azimuth), Math.sin(ELEVATION), level * Math.cos(azimuth));
  return { run, frame, direction };
}

/**
 * Places `camera` along `direction` so that it sees all `points` below a strip that takes the share `strip` of the
 * picture at its top; returns what it looks at.
 */
export function frame(camera: PerspectiveCamera, points: Vector3[], direction: Vector3, strip: number): Vector3 {
  const right = new Vector3().crossVectors(new Vector3(0, 1, 0), direction).normalize();
  const up = new Vector3().crossVectors(direction, right);
  const slope = Math.tan((camera.fov * Math.PI) / 360);
  const [below, above] = [slope * FILL, slope * Math.max(Math.min(FILL, 1 - 2 * strip), LEAST_FILL)];
  const beside = below * camera.aspect;
  // Along one axis of the picture, a point at `across` and `toward` is inside if across - middle is at most
  // (distance - toward) * up, and middle - across at most (distance - toward) * down. The largest of
  // across + up * toward and the least of across - down * toward give the distance, and the middle for any that is
  // not less.
  const fit = (axis: Vector3, down: number, up: number) => {
    let [high, low] = [-Infinity, Infinity];
    for (const point of points) {
      const across = point.dot(axis);
      const toward = point.dot(direction);
      high = Math.max(high, across + up * toward);
      low = Math.min(low, across - down * toward);
    }
    const middle = (distance: number) => (high + low + (down - up) * distance) / 2;
    return { distance: (high - low) / (down + up), middle };
  };
  const horizontal = fit(right, beside, beside);
  const vertical = fit(up, below, above);
  const depths = points.map((point) => point.dot(direction));
  const [near, far] = depths.reduce(([a, b], depth) => [Math.max(a, depth), Math.min(b, depth)], [-Infinity, Infinity]);
  const depth = (near + far) / 2;
  // A lone point has no size: stay a little away from it.
  const distance = Math.max(horizontal.distance, vertical.distance, near + 0.5);
  const [x, y] = [horizontal.middle(distance), vertical.middle(distance)];
  const target = right.multiplyScalar(x).addScaledVector(up, y).addScaledVector(direction, depth);
  camera.position.copy(target).addScaledVector(direction, distance - depth);
  return target;
}

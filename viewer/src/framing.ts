// Where the camera stands so that the whole run is in the picture.

import { PerspectiveCamera, Vector3 } from "three";
import type { Motion } from "./motion";

const SAMPLED_FRAMES = 24;
const SAMPLED_VERTICES = 2500;
/** Share of the picture that the run fills. */
const FILL = 0.84;
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

/** Places `camera` along `direction` so that it sees all `points`; returns what it looks at. */
export function frame(camera: PerspectiveCamera, points: Vector3[], direction: Vector3): Vector3 {
  const right = new Vector3().crossVectors(new Vector3(0, 1, 0), direction).normalize();
  const up = new Vector3().crossVectors(direction, right);
  const vertical = Math.tan((camera.fov * Math.PI) / 360) * FILL;
  const horizontal = vertical * camera.aspect;
  // Along one axis of the picture, a point at `across` and `toward` is inside if |across - middle| is at most
  // (distance - toward) * slope. The largest of across + slope * toward and the least of across - slope * toward
  // give the middle and the distance.
  const fit = (axis: Vector3, slope: number): [middle: number, distance: number] => {
    let [high, low] = [-Infinity, Infinity];
    for (const point of points) {
      const across = point.dot(axis);
      const reach = slope * point.dot(direction);
      high = Math.max(high, across + reach);
      low = Math.min(low, across - reach);
    }
    return [(high + low) / 2, (high - low) / (2 * slope)];
  };
  const [x, distanceX] = fit(right, horizontal);
  const [y, distanceY] = fit(up, vertical);
  const depths = points.map((point) => point.dot(direction));
  const [near, far] = depths.reduce(([a, b], depth) => [Math.max(a, depth), Math.min(b, depth)], [-Infinity, Infinity]);
  const depth = (near + far) / 2;
  // A lone point has no size: stay a little away from it.
  const distance = Math.max(distanceX, distanceY, near + 0.5);
  const target = right.multiplyScalar(x).addScaledVector(up, y).addScaledVector(direction, depth);
  camera.position.copy(target).addScaledVector(direction, distance - depth);
  return target;
}

// A measuring staff beside a cloth that the view follows: without it, a fall far above the floor would not be seen.

import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineSegments, Vector3 } from "three";

const MOST_MARKS = 20_000;

export class Staff {
  readonly lines: LineSegments;
  readonly #place: Vector3;

  /** A staff from `ground` up to `height` above it, marked every `spacing`; `direction` leads to the camera. */
  constructor(ground: number, height: number, spacing: number, direction: Vector3) {
    const right = new Vector3(direction.z, 0, -direction.x).normalize();
    this.#place = right.clone().multiplyScalar(-0.85).addScaledVector(direction, -0.3).setY(ground);
    const coordinates: number[] = [];
    const marks = Math.min(Math.floor(height / spacing), MOST_MARKS);
    for (let mark = 0; mark <= marks; mark++) {
      const width = mark % 5 === 0 ? 0.06 : 0.025;
      const y = mark * spacing;
      // Short pieces, because some graphics drivers drop a line whose ends are far outside the picture.
      if (mark < marks) coordinates.push(0, y, 0, 0, y + spacing, 0);
      coordinates.push(0, y, 0, width * right.x, y, width * right.z);
    }
    const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(coordinates, 3));
    this.lines = new LineSegments(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.8 }));
    this.lines.frustumCulled = false;
  }

  /** Keeps the staff beside (`x`, `z`). */
  moveTo(x: number, z: number): void {
    this.lines.position.set(x, 0, z).add(this.#place);
  }

  setTheme(colour: string): void {
    (this.lines.material as LineBasicMaterial).color.set(colour);
  }
}

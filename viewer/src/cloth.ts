// What is drawn of the cloth: faces on both sides, threads, beads, pins, the mesh.

import {
  BackSide, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DynamicDrawUsage, FrontSide, Group,
  InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshPhysicalMaterial, MeshStandardMaterial,
  Quaternion, type Side, SphereGeometry, Vector3,
} from "three";
import { colourStrains } from "./colour";
import type { Motion } from "./motion";
import { pieceExtents } from "./pieces";

const FRONT = "#f6f2ea";
const BACK = "#e9e1d3";
/** The back stays a shade darker where strain gives the colour. */
const BACK_OF_COLOURED = "#efeae1";
const THREAD = "#b39c7c";
const PIN = "#a5483a";
/** Radius of a pin [units], and the most of it as a share of what it holds. */
const PIN_RADIUS = 0.013;
const PIN_SHARE = 0.03;
/** Radius of a lone particle [units]. */
const LONE_RADIUS = 0.03;
/** Radius of a pin over that of the bead it hides. */
const PIN_OVER_BEAD = 1.3;
/** Soft brightening of grazed fibres. */
const SHEEN = 0.3;

export class Cloth {
  readonly group = new Group();
  /** Strain [1] at which colours are full. */
  strainLimit = 1;
  readonly #motion: Motion;
  readonly #positions: BufferAttribute;
  readonly #normals: BufferAttribute;
  readonly #colours: BufferAttribute;
  readonly #faces: [MeshPhysicalMaterial, MeshPhysicalMaterial];
  readonly #mesh: LineSegments;
  readonly #beads: InstancedMesh;
  readonly #threads: InstancedMesh;
  readonly #pins: InstancedMesh;
  readonly #beadVertices: Uint32Array;
  readonly #beadRadius: number;
  readonly #pinRadii: number[];
  #coloured = false;

  constructor(motion: Motion) {
    this.#motion = motion;
    const { triangles, lines, points, pins } = motion.frames;
    const attribute = (array: Float32Array) => new BufferAttribute(array, 3).setUsage(DynamicDrawUsage);
    this.#positions = attribute(motion.positions);
    this.#normals = attribute(motion.normals);
    this.#colours = attribute(new Float32Array(motion.positions.length));
    const geometry = this.#geometry(triangles);
    this.#faces = [face(FrontSide, FRONT), face(BackSide, BACK)];
    for (const material of this.#faces) {
      const mesh = new Mesh(geometry, material);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      mesh.visible = 0 < triangles.length;
      this.group.add(mesh);
    }
    const wire = new LineBasicMaterial({ color: "#3a3129", transparent: true, opacity: 0.4 });
    this.#mesh = new LineSegments(this.#geometry(edges(triangles)), wire);
    this.#mesh.frustumCulled = false;
    this.#mesh.visible = false;
    this.group.add(this.#mesh);

    motion.moveTo(0);
    const spacing = meanLength(motion.positions, 0 < lines.length ? lines : edges(triangles));
    this.#beadVertices = Uint32Array.from(new Set([...lines, ...points]));
    this.#beadRadius = 0 < lines.length ? Math.min(0.016, 0.28 * spacing) : LONE_RADIUS;
    const ball = new SphereGeometry(1, 20, 14);
    this.#beads = this.#instances(ball, THREAD, this.#beadVertices.length);
    this.#threads = this.#instances(new CylinderGeometry(1, 1, 1, 10, 1, true), THREAD, lines.length / 2);
    // Many pins stand side by side, each no wider than its place.
    const pinRadius = pins.length <= 12 ? PIN_RADIUS : Math.min(PIN_RADIUS, Math.max(0.5 * spacing, 0.3 * PIN_RADIUS));
    this.#pins = this.#instances(ball, PIN, pins.length);
    const extents = pieceExtents(motion.positions, [triangles, 3], [lines, 2]);
    const beads = new Set(this.#beadVertices);
    this.#pinRadii = Array.from(pins, (vertex) => {
      return beads.has(vertex) ? PIN_OVER_BEAD * this.#beadRadius : Math.min(pinRadius, PIN_SHARE * extents[vertex]);
    });
  }

  /** Whether there are faces whose mesh can be shown. */
  get hasFaces(): boolean {
    return 0 < this.#motion.frames.triangles.length;
  }

  get wireframe(): boolean {
    return this.#mesh.visible;
  }

  set wireframe(shown: boolean) {
    this.#mesh.visible = shown;
    // Faces give way to the lines on them.
    for (const material of this.#faces) {
      material.polygonOffset = shown;
      material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
      material.needsUpdate = true;
    }
  }

  get coloured(): boolean {
    return this.#coloured;
  }

  set coloured(coloured: boolean) {
    this.#coloured = coloured;
    const colours = coloured ? ["#ffffff", BACK_OF_COLOURED] : [FRONT, BACK];
    this.#faces.forEach((material, i) => {
      material.vertexColors = coloured;
      material.color.set(colours[i]);
      material.sheen = coloured ? 0 : SHEEN;
      material.needsUpdate = true;
    });
    this.update();
  }

  /** Takes over the motion's positions and strains. */
  update(): void {
    const motion = this.#motion;
    if (this.hasFaces) {
      motion.updateNormals();
      this.#positions.needsUpdate = true;
      this.#normals.needsUpdate = true;
    }
    const colours = this.#colours.array as Float32Array;
    if (this.#coloured) {
      colourStrains(motion.strains, this.strainLimit, colours);
      this.#colours.needsUpdate = true;
    }
    const colour = new Color();
    const thread = new Color(THREAD);
    const colourOf = (vertex: number) => (this.#coloured ? colour.fromArray(colours, 3 * vertex) : thread);
    const at = (vertex: number) => new Vector3().fromArray(motion.positions, 3 * vertex);
    const matrix = new Matrix4();
    const ball = (mesh: InstancedMesh, i: number, vertex: number, radius: number) => {
      mesh.setMatrixAt(i, matrix.makeScale(radius, radius, radius).setPosition(at(vertex)));
    };
    this.#beadVertices.forEach((vertex, i) => {
      ball(this.#beads, i, vertex, this.#beadRadius);
      this.#beads.setColorAt(i, colourOf(vertex));
    });
    motion.frames.pins.forEach((vertex, i) => ball(this.#pins, i, vertex, this.#pinRadii[i]));
    const { lines } = motion.frames;
    const [up, turn, width] = [new Vector3(0, 1, 0), new Quaternion(), 0.34 * this.#beadRadius];
    for (let i = 0; i < lines.length / 2; i++) {
      const [from, to] = [at(lines[2 * i]), at(lines[2 * i + 1])];
      const along = to.clone().sub(from);
      const length = along.length();
      if (0 < length) turn.setFromUnitVectors(up, along.divideScalar(length));
      this.#threads.setMatrixAt(i, matrix.compose(from.add(to).divideScalar(2), turn, new Vector3(width, length, width)));
      this.#threads.setColorAt(i, colourOf(lines[2 * i + 1]));
    }
    for (const mesh of [this.#beads, this.#threads, this.#pins]) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
  }

  #geometry(index: Uint32Array): BufferGeometry {
    return new BufferGeometry()
      .setAttribute("position", this.#positions)
      .setAttribute("normal", this.#normals)
      .setAttribute("color", this.#colours)
      .setIndex(new BufferAttribute(index, 1));
  }

  #instances(geometry: BufferGeometry, colour: string, count: number): InstancedMesh {
    // Beads and threads take their colour from each instance.
    const material = new MeshStandardMaterial({ color: colour === THREAD ? "#ffffff" : colour, roughness: 0.7 });
    const mesh = new InstancedMesh(geometry, material, count);
    mesh.castShadow = true;
    mesh.frustumCulled = false;
    mesh.visible = 0 < count;
    this.group.add(mesh);
    return mesh;
  }
}

function face(side: Side, colour: string): MeshPhysicalMaterial {
  const material = new MeshPhysicalMaterial({ color: colour, side, roughness: 0.92, sheen: SHEEN });
  material.sheenRoughness = 0.55;
  material.sheenColor.set("#fff8ee");
  return material;
}

/** Every edge of the triangles once, as pairs of vertices. */
function edges(triangles: Uint32Array): Uint32Array {
  const seen = new Set<number>();
  const pairs: number[] = [];
  for (let i = 0; i < triangles.length; i++) {
    const from = triangles[i];
    const to = triangles[i % 3 === 2 ? i - 2 : i + 1];
    const [low, high] = from < to ? [from, to] : [to, from];
    const key = low * 2 ** 26 + high;
    if (!seen.has(key)) {
      seen.add(key);
      pairs.push(low, high);
    }
  }
  return Uint32Array.from(pairs);
}

function meanLength(positions: Float32Array, pairs: Uint32Array): number {
  let sum = 0;
  for (let i = 0; i < pairs.length; i += 2) {
    const [a, b] = [3 * pairs[i], 3 * pairs[i + 1]];
    sum += Math.hypot(positions[a] - positions[b], positions[a + 1] - positions[b + 1], positions[a + 2] - positions[b + 2]);
  }
  return 0 < pairs.length ? sum / (pairs.length / 2) : 0;
}

// The view: camera, light, floor and cloth, drawn when something has changed.

import {
  DirectionalLight, HemisphereLight, PCFShadowMap, PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Cloth } from "./cloth";
import { Floor } from "./floor";
import { Staff } from "./staff";
import { roundDown } from "./format";
import { type Samples, frame, sampleRun } from "./framing";
import type { Motion } from "./motion";

/** How many times longer than the cloth a run's way must be for the view to follow it from the start. */
const FOLLOW_FROM = 2.5;
/** Height of the strip that belongs to the buttons [rem]. */
const BUTTONS = 3.6;

/** Whether the browser can draw in space. */
export function canDraw(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

export class Stage {
  readonly cloth: Cloth;
  /** Distance of the floor's lines [m]. */
  readonly gridSpacing: number;
  readonly #motion: Motion;
  readonly #canvas: HTMLCanvasElement;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #camera = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly #controls: OrbitControls;
  readonly #floor: Floor;
  readonly #staff: Staff;
  readonly #sun = new DirectionalLight("#fff8ef", 2.1);
  readonly #sky = new HemisphereLight("#fffefb", "#d9cfc1", 1.75);
  readonly #samples: Samples;
  /** Where the cloth was when the view last followed it. */
  readonly #centre = new Vector3();
  #following: boolean;
  #turned = false;
  #requested = false;

  constructor(canvas: HTMLCanvasElement, motion: Motion) {
    this.#canvas = canvas;
    this.#motion = motion;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = PCFShadowMap;
    this.#samples = sampleRun(motion);
    this.#following = FOLLOW_FROM * Math.max(motion.frameExtent, 0.01) < Math.max(...motion.runExtent);

    const { runExtent, run, unit } = motion;
    this.gridSpacing = roundDown(0.12 * unit);
    const spacing = this.gridSpacing / unit;
    // Without an extent the unit says nothing, and no place is a whole number of it.
    const zeroAlong = (axis: number) => -(run.low[axis] / unit + runExtent[axis] / 2) % (5 * spacing);
    const zero = [0, 2].map((axis) => (motion.hasExtent ? zeroAlong(axis) : 0));
    const ground = -runExtent[1] / 2 - 0.03;
    this.#floor = new Floor(ground, spacing, new Vector2(...zero));
    this.#staff = new Staff(ground, runExtent[1] + 0.5, spacing, this.#samples.direction);
    this.cloth = new Cloth(motion);
    this.#light();
    this.#scene.add(this.cloth.group, this.#floor.group, this.#staff.lines, this.#sky, this.#sun, this.#sun.target);

    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = true;
    this.#controls.dampingFactor = 0.12;
    this.#controls.addEventListener("change", () => this.request());
    this.#controls.addEventListener("start", () => {
      this.#turned = true;
      this.request();
    });
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#resize();
    this.reset();
  }

  get following(): boolean {
    return this.#following;
  }

  set following(following: boolean) {
    this.#following = following;
    this.reset();
  }

  /** Shows the motion as it is now. */
  update(): void {
    const centre = new Vector3(...this.#motion.centre);
    if (this.#following) {
      const step = centre.clone().sub(this.#centre);
      this.#camera.position.add(step);
      this.#controls.target.add(step);
    }
    this.#centre.copy(centre);
    this.#place();
    this.cloth.update();
    this.request();
  }

  /** Back to the first view, around the whole run or, following, around the cloth. */
  reset(): void {
    this.#turned = false;
    // Without damping, an update uses up what is left of a swing.
    this.#controls.enableDamping = false;
    this.#controls.update();
    this.#controls.enableDamping = true;
    const points = this.#following ? this.#samples.frame : this.#samples.run;
    const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
    const strip = (BUTTONS * rem) / Math.max(this.#canvas.clientHeight, 1);
    const target = frame(this.#camera, points, this.#samples.direction, strip);
    this.#centre.set(...this.#motion.centre);
    if (this.#following) {
      target.add(this.#centre);
      this.#camera.position.add(this.#centre);
    }
    const distance = this.#camera.position.distanceTo(target);
    this.#camera.near = distance / 200;
    this.#camera.far = distance * 40;
    this.#camera.updateProjectionMatrix();
    this.#controls.minDistance = 0.02 * distance;
    this.#controls.maxDistance = 8 * distance;
    this.#controls.target.copy(target);
    this.#controls.update();
    this.#place();
    this.request();
  }

  setTheme(line: string, shadowOpacity: number): void {
    this.#floor.setTheme(line, shadowOpacity);
    this.#staff.setTheme(line);
    this.request();
  }

  /** Draws soon. */
  request(): void {
    if (this.#requested) return;
    this.#requested = true;
    requestAnimationFrame(() => {
      this.#requested = false;
      // While the view still swings, this asks for the next picture.
      this.#controls.update();
      this.#renderer.render(this.#scene, this.#camera);
    });
  }

  #light(): void {
    const reach = 1.1;
    const shadow = this.#sun.shadow;
    shadow.mapSize.set(2048, 2048);
    Object.assign(shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: 12 });
    shadow.radius = 9;
    shadow.bias = -0.0006;
    shadow.normalBias = 0.012;
    shadow.intensity = 0.85;
    this.#sun.castShadow = true;
  }

  /** Brings light and floor to where the cloth is. */
  #place(): void {
    const { direction } = this.#samples;
    const [x, y, z] = this.#motion.centre;
    this.#sun.target.position.set(x, y, z);
    const side = new Vector3(direction.z, 0, -direction.x).normalize();
    const toSun = side.multiplyScalar(-0.75).add(new Vector3(direction.x, 0, direction.z).multiplyScalar(0.85));
    this.#sun.position.set(x, y, z).add(toSun.setY(1.05).normalize().multiplyScalar(4));
    const spread = Math.max(this.#motion.runExtent[0], this.#motion.runExtent[2], 1);
    this.#staff.lines.visible = this.#following;
    this.#staff.moveTo(x, z);
    if (this.#following) this.#floor.moveTo(x, z, 3);
    else this.#floor.moveTo(0, 0, 1.2 + 1.1 * spread);
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    if (this.#turned) this.request();
    else this.reset();
  }
}

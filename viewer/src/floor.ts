// The floor: a grid that fades out, and the shadow on it.

import { Color, Group, Mesh, PlaneGeometry, ShaderMaterial, ShadowMaterial, Vector2 } from "three";

const VERTEX = `
varying vec2 place;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  place = world.xz;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const FRAGMENT = `
uniform vec3 colour;
uniform vec2 centre;
uniform vec2 zero;
uniform float radius;
uniform float spacing;
varying vec2 place;
float lines(float cell) {
  vec2 at = (place - zero) / cell;
  vec2 width = fwidth(at);
  vec2 near = abs(fract(at - 0.5) - 0.5) / max(width, 1e-6);
  // Where a cell is no wider than a few pixels its lines would shimmer.
  vec2 line = (1.0 - min(near, 1.0)) * (1.0 - smoothstep(0.15, 0.4, width));
  return max(line.x, line.y);
}
void main() {
  float fade = 1.0 - smoothstep(0.15, 1.0, length(place - centre) / radius);
  float strength = max(0.3 * lines(spacing), 0.55 * lines(5.0 * spacing));
  gl_FragColor = vec4(colour, strength * fade);
  #include <colorspace_fragment>
}`;

export class Floor {
  readonly group = new Group();
  readonly #grid: ShaderMaterial;
  readonly #shadow: ShadowMaterial;

  /** A floor at `height`, its grid `spacing` apart and through `zero`; all in units of the view. */
  constructor(height: number, spacing: number, zero: Vector2) {
    this.#grid = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        colour: { value: new Color() },
        centre: { value: new Vector2() },
        zero: { value: zero },
        radius: { value: 1 },
        spacing: { value: spacing },
      },
      transparent: true,
      depthWrite: false,
    });
    this.#shadow = new ShadowMaterial({ transparent: true, depthWrite: false });
    const plane = new PlaneGeometry(2, 2).rotateX(-Math.PI / 2);
    const shadow = new Mesh(plane, this.#shadow);
    shadow.receiveShadow = true;
    shadow.renderOrder = -2;
    const grid = new Mesh(plane, this.#grid);
    grid.renderOrder = -1;
    for (const mesh of [shadow, grid]) mesh.frustumCulled = false;
    this.group.add(shadow, grid);
    this.group.position.y = height;
  }

  /** Shows the floor around (`x`, `z`). */
  moveTo(x: number, z: number, radius: number): void {
    this.group.position.x = x;
    this.group.position.z = z;
    this.group.scale.set(radius, 1, radius);
    this.#grid.uniforms.centre.value.set(x, z);
    this.#grid.uniforms.radius.value = radius;
  }

  /** Colours for light or dark surroundings. */
  setTheme(line: string, shadowOpacity: number): void {
    this.#grid.uniforms.colour.value.set(line);
    this.#shadow.color.set("#120f0b");
    this.#shadow.opacity = shadowOpacity;
  }
}

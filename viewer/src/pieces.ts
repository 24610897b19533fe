// The separate pieces of a shape.

/**
 * The largest extent, along any axis, of the piece that each vertex belongs to.
 *
 * Each of `shapes` lists vertices in groups of the given size; those of a group belong together.
 */
export function pieceExtents(positions: Float32Array, ...shapes: [Uint32Array, number][]): Float32Array {
  const count = positions.length / 3;
  const parents = Uint32Array.from({ length: count }, (_, vertex) => vertex);
  const rootOf = (vertex: number) => {
    while (parents[vertex] !== vertex) vertex = parents[vertex] = parents[parents[vertex]];
    return vertex;
  };
  for (const [vertices, size] of shapes) {
    for (let i = 0; i < vertices.length; i++) {
      if (i % size !== 0) parents[rootOf(vertices[i])] = rootOf(vertices[i - 1]);
    }
  }
  const low = new Float32Array(positions.length).fill(Infinity);
  const high = new Float32Array(positions.length).fill(-Infinity);
  for (let i = 0; i < positions.length; i++) {
    const at = 3 * rootOf(Math.floor(i / 3)) + (i % 3);
    low[at] = Math.min(low[at], positions[i]);
    high[at] = Math.max(high[at], positions[i]);
  }
  return Float32Array.from({ length: count }, (_, vertex) => {
    const at = 3 * rootOf(vertex);
    return Math.max(high[at] - low[at], high[at + 1] - low[at + 1], high[at + 2] - low[at + 2]);
  });
}

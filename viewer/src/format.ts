// Numbers as people read them.

const PREFIXES: [number, string][] = [
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"],
];

/** Largest 1, 2 or 5 times a power of ten that is not above `value`. */
export function roundDown(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  // A ratio such as 4.999999999 stands for 5.
  const ratio = value / power + 1e-9;
  return (ratio < 2 ? 1 : ratio < 5 ? 2 : 5) * power;
}

/** Smallest number that is not below `value` and easy to halve and to read. */
export function roundUp(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const ratio = value / power - 1e-9;
  return ([1, 1.5, 2, 3, 4, 5, 6, 8].find((step) => ratio <= step) ?? 10) * power;
}

/** Decimal prefix in which a quantity of the given magnitude is written: its factor and its letter. */
export function prefix(magnitude: number): [number, string] {
  if (!(0 < magnitude)) return [1, ""];
  return PREFIXES.find(([factor]) => factor <= magnitude * 1.0001) ?? PREFIXES[PREFIXES.length - 1];
}

/** `value` to `digits` significant digits, without trailing zeros. */
export function number(value: number, digits = 3): string {
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  const plain = rounded === 0 || (1e-3 <= size && size < 1e6);
  const text = plain ? String(rounded) : rounded.toExponential().replace("e+", "e");
  return text.replace(/-/g, "−");
}

/** A length [m] with its unit. */
export function length(metres: number): string {
  if (metres < 1e-3) return `${number(metres * 1e6)} µm`;
  if (metres < 1e-2) return `${number(metres * 1e3)} mm`;
  if (metres < 1) return `${number(metres * 1e2)} cm`;
  return metres < 1e3 ? `${number(metres)} m` : `${number(metres / 1e3)} km`;
}

// Colours of strain: cool for compression, cloth for none, warm for extension, even to the eye (OKLab).

type Triple = [number, number, number];

/** From fully compressed to fully extended, as sRGB. */
const STOPS = ["#2c3f74", "#7f9ac4", "#efe8da", "#dd9160", "#8c2a26"];
const HALF = 128;

function linear(channel: number): number {
  return channel <= 0.04045 ? channel / 12.92 : ((channel + 0.055) / 1.055) ** 2.4;
}

function encoded(channel: number): number {
  const value = Math.min(Math.max(channel, 0), 1);
  return value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;
}

function linearOfHex(hex: string): Triple {
  return [1, 3, 5].map((at) => linear(parseInt(hex.slice(at, at + 2), 16) / 255)) as Triple;
}

function oklabOfLinear([r, g, b]: Triple): Triple {
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function linearOfOklab([lightness, a, b]: Triple): Triple {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

/** The map in linear RGB, three numbers per entry, from -1 to 1. */
const TABLE = ((): Float32Array => {
  const stops = STOPS.map((hex) => oklabOfLinear(linearOfHex(hex)));
  const table = new Float32Array(3 * (2 * HALF + 1));
  for (let i = 0; i <= 2 * HALF; i++) {
    const at = (i / (2 * HALF)) * (stops.length - 1);
    const first = Math.min(Math.floor(at), stops.length - 2);
    const mixed = stops[first].map((value, c) => value + (at - first) * (stops[first + 1][c] - value)) as Triple;
    table.set(linearOfOklab(mixed).map((value) => Math.min(Math.max(value, 0), 1)), 3 * i);
  }
  return table;
})();

/** Overwrites `colours` (linear RGB) with those of `strains`, full at `limit`. */
export function colourStrains(strains: Float32Array, limit: number, colours: Float32Array): void {
  for (let i = 0; i < strains.length; i++) {
    const entry = 3 * Math.round(HALF + HALF * Math.min(Math.max(strains[i] / limit, -1), 1));
    colours[3 * i] = TABLE[entry];
    colours[3 * i + 1] = TABLE[entry + 1];
    colours[3 * i + 2] = TABLE[entry + 2];
  }
}

/** The map as a CSS gradient from left to right. */
export function strainGradient(): string {
  const steps = 16;
  const colours = Array.from({ length: steps + 1 }, (_, i) => {
    const at = 3 * Math.round((i / steps) * 2 * HALF);
    const channels = [0, 1, 2].map((c) => Math.round(255 * encoded(TABLE[at + c])));
    return `rgb(${channels.join(" ")})`;
  });
  return `linear-gradient(90deg, ${colours.join(", ")})`;
}

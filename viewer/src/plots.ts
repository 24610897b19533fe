// A plot of several quantities over time, with a cursor at the shown time that can be dragged.

import uPlot from "uplot";
import { number, prefix } from "./format";
import type { Series } from "./run";

export interface PlotOptions {
  title: string;
  unit: string;
  /** Shown value per stored value. */
  factor: number;
  times: number[];
  series: Series[];
  /** Last time of the axis [s]. */
  duration: number;
  /** Least extent of the vertical axis [unit]. */
  least: number;
  seek: (time: number) => void;
}

const DYES = ["--indigo", "--madder", "--weld", "--sage", "--plum", "--walnut", "--sky", "--moss", "--rose"];

interface Line {
  name: string;
  values: (number | null)[];
  colour: string;
  dashed: boolean;
  reading: HTMLElement;
}

export class Plot {
  readonly element = document.createElement("figure");
  readonly #options: PlotOptions;
  readonly #lines: Line[];
  readonly #cursor = document.createElement("div");
  readonly #plot: uPlot;
  #time = 0;

  constructor(parent: HTMLElement, options: PlotOptions) {
    this.#options = options;
    const caption = document.createElement("figcaption");
    caption.innerHTML = "<h2></h2><ul></ul>";
    const heading = caption.querySelector("h2") as HTMLElement;
    const names = caption.querySelector("ul") as HTMLElement;
    heading.textContent = options.title;
    heading.append(Object.assign(document.createElement("span"), { textContent: ` ${options.unit}` }));
    const box = document.createElement("div");
    box.className = "plot";
    this.element.append(caption, box);
    parent.append(this.element);
    this.#lines = linesOf(options);
    this.#lines.forEach((line, i) => names.append(this.#name(line, i)));
    this.#cursor.className = "cursor";
    this.#plot = this.#create(box);
    this.#plot.over.append(this.#cursor);
    this.#listen(this.#plot.over);
    new ResizeObserver(() => {
      this.#plot.setSize({ width: box.clientWidth, height: box.clientHeight });
      this.showTime(this.#time);
    }).observe(box);
  }

  /** Moves the cursor to `time` [s] and shows the values there. */
  showTime(time: number): void {
    this.#time = time;
    this.#cursor.style.transform = `translateX(${this.#plot.valToPos(time, "x")}px)`;
    for (const line of this.#lines) {
      const value = valueAt(this.#options.times, line.values, time);
      line.reading.textContent = value === null ? "–" : number(value);
    }
  }

  /** Draws again, after the colours of the page have changed. */
  redraw(): void {
    this.#plot.redraw(false);
  }

  #create(box: HTMLElement): uPlot {
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    const size = Math.round(parseFloat(style.fontSize) * 0.75);
    const font = `${size}px ${getComputedStyle(document.body).fontFamily}`;
    const axis = { stroke: () => colour("--ink-soft"), font, ticks: { show: false }, labelSize: 0, gap: 6 };
    const grid = { stroke: () => colour("--hairline"), width: 1 };
    const [timeFactor, timeLetter] = this.#options.duration < 0.1 ? prefix(this.#options.duration) : [1, ""];
    const format = (splits: number[]) => splits.map((value) => number(value, 6));
    return new uPlot(
      {
        width: box.clientWidth,
        height: box.clientHeight,
        // The last label of the time axis reaches beyond its end by half.
        padding: [8, 2.4 * size, 0, 0],
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: () => [0, this.#options.duration || 1] }, y: { range: (_, low, high) => yRange(low, high, this.#options.least) } },
        axes: [
          { ...axis, grid: { show: false }, size: size + 14, space: 5 * size, values: (_, splits) => format(splits.map((time) => time / timeFactor)).map((text) => `${text} ${timeLetter}s`) },
          { ...axis, grid, size: (_, texts) => gutter(texts, size), space: 2.6 * size, values: (_, splits) => format(splits) },
        ],
        series: [
          {},
          ...this.#lines.map((line) => ({
            stroke: () => colour(line.colour),
            width: Math.max(1.5, size / 8),
            dash: line.dashed ? [5, 4] : undefined,
            pxAlign: 0,
            points: { show: line.values.length < 2 },
          })),
        ],
      },
      [this.#options.times, ...this.#lines.map((line) => line.values)],
      box,
    );
  }

  /** The entry of a line in the legend: its name and its value at the shown time; a click hides the line. */
  #name(line: Line, index: number): HTMLElement {
    const entry = document.createElement("li");
    const button = document.createElement("button");
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    button.style.setProperty("--dye", `var(${line.colour})`);
    if (line.dashed) button.classList.add("dashed");
    button.append(Object.assign(document.createElement("span"), { textContent: line.name }), line.reading);
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(shown));
      this.#plot.setSeries(index + 1, { show: shown });
    });
    entry.append(button);
    return entry;
  }

  #listen(over: HTMLElement): void {
    const seek = (event: PointerEvent) => {
      this.#options.seek(this.#plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x"));
    };
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      seek(event);
    });
    over.addEventListener("pointermove", (event) => {
      if (over.hasPointerCapture(event.pointerId)) seek(event);
    });
  }
}

/** Whether a series has something to show. */
export function isShown({ values }: Series): boolean {
  return values.some((value) => value !== null && value !== 0);
}

/** Lines of a plot, those that are shown: a mean is dashed in the colour of its maximum, the residual has that of the text. */
function linesOf({ series, factor }: PlotOptions): Line[] {
  const families: string[] = [];
  // What is left out keeps its colour, so that a quantity looks the same in all runs.
  const lines = series.map(({ name, values }) => {
    const family = name.replace(/[ _-](max|mean)$/, "");
    if (!families.includes(family) && family !== "residual") families.push(family);
    return {
      name: name.replace(/_/g, " "),
      values: values.map((value) => (value === null ? null : value * factor)),
      colour: family === "residual" ? "--ink" : DYES[families.indexOf(family) % DYES.length],
      dashed: family !== name && name.endsWith("mean"),
      reading: document.createElement("data"),
    };
  });
  return lines.filter((_, i) => isShown(series[i]));
}

/** Width of the column in which `texts` stand beside a plot. */
function gutter(texts: string[] | null, fontSize: number): number {
  const longest = (texts ?? []).reduce((most, text) => Math.max(most, text.length), 0);
  return Math.max(4.4 * fontSize, 0.62 * fontSize * longest + 12);
}

/** A range around the values and zero, at least `least` wide. */
function yRange(low: number | null, high: number | null, least: number): [number, number] {
  const bottom = Math.min(low ?? 0, 0);
  const top = Math.max(high ?? 0, 0, bottom + least);
  const margin = 0.06 * (top - bottom) || 1;
  return [bottom < 0 ? bottom - margin : 0, top + margin];
}

/** The value at `time`, on the straight line between samples. */
function valueAt(times: number[], values: (number | null)[], time: number): number | null {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle - 1;
  }
  const [from, to] = [values[low] ?? null, values[low + 1] ?? null];
  if (from === null || to === null) return from;
  const share = Math.min(Math.max((time - times[low]) / (times[low + 1] - times[low]), 0), 1);
  return from + share * (to - from);
}

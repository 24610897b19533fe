// How far the colours of strain reach, and the legend that says so.

import { strainGradient } from "./colour";
import { number, roundUp } from "./format";
import type { Motion } from "./motion";
import { strainOfStep } from "./run";

/** Share of all strains that the colours tell apart; those beyond, often at a pin, have the last colour. */
const COVERED = 0.99;
/** Least strain [1] at which colours are full or a plot ends: what is far below is round-off. */
export const LEAST_STRAIN = 1e-6;
/** Characters for which there is room between the end of the legend and the middle of its half. */
const ROOM = 7;

export interface StrainScale {
  /** Strain [1] at which colours are full, a round number. */
  limit: number;
  /** Whether the run has strains below and above the colours. */
  below: boolean;
  above: boolean;
}

/** The scale for a run. */
export function strainScale(motion: Motion): StrainScale {
  const counts = motion.strainHistogram();
  const total = counts.reduce((sum, count) => sum + count, 0);
  let size = 0;
  let covered = counts[128];
  while (covered < COVERED * total) {
    size++;
    covered += counts[128 + size] + counts[128 - size];
  }
  const { run } = motion;
  // A cloth that is strained nowhere, or hardly anywhere, has a scale all the same.
  const limit = Math.max(roundUp(strainOfStep(run, size) || run.largestStrain || 0.01), LEAST_STRAIN);
  const beyond = (sign: number) => counts.some((count, i) => 0 < count && limit < sign * strainOfStep(run, i - 128));
  return { limit, below: beyond(-1), above: beyond(1) };
}

/** Fills the legend. */
export function showLegend(legend: HTMLElement, { limit, below, above }: StrainScale): void {
  (legend.querySelector(".scale") as HTMLElement).style.background = strainGradient();
  const textAt = (share: number) => {
    const beyond = share === -1 && below ? "≤ " : share === 1 && above ? "≥ " : "";
    return `${beyond}${0 < share ? "+" : ""}${number(100 * share * limit)}`;
  };
  const hasRoom = [-1, 1].every((end) => textAt(end).length + textAt(end / 2).length / 2 <= ROOM);
  const marks = (hasRoom ? [-1, -0.5, 0, 0.5, 1] : [-1, 0, 1]).map((share) => {
    const mark = Object.assign(document.createElement("li"), { textContent: textAt(share) });
    mark.style.setProperty("--at", `${50 + 50 * share}%`);
    return mark;
  });
  (legend.querySelector("ol") as HTMLElement).replaceChildren(...marks);
}

// The speeds at which a run can be played.

export interface Speed {
  name: string;
  /** Simulated seconds per second. */
  value: number;
}

/** Playing time [s] that the slowest speed gives at least. */
const SLOWEST = 10;
/** Playing time [s] that a run much shorter than that has at first. */
const USUAL = 2;
const FASTER = [0.125, 0.25, 0.5, 1, 2, 4];

/** Speeds for a run of `duration` [s], slowest first: however short it is, it can be watched. */
export function speedsFor(duration: number): Speed[] {
  const slower = [20];
  for (let decade = 10; 0 < duration && duration * slower[0] < SLOWEST; decade *= 10) {
    for (const step of [5, 10, 20]) if (duration * slower[0] < SLOWEST) slower.unshift(step * decade);
  }
  return [
    ...slower.map((divisor) => ({ name: `1/${divisor} ×`, value: 1 / divisor })),
    ...FASTER.map((value) => ({ name: value < 1 ? `1/${1 / value} ×` : `${value} ×`, value })),
  ];
}

/** The speed to begin with: real time, or slower where that would be over at once. */
export function usualSpeed(speeds: Speed[], duration: number): number {
  if (duration <= 0 || USUAL / 4 <= duration) return 1;
  const slow = speeds.filter(({ value }) => USUAL <= duration / value);
  return slow[slow.length - 1].value;
}

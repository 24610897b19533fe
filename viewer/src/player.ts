// The time that is shown, and its passing.

export class Player {
  /** Simulated seconds per second. */
  speed = 1;
  readonly #duration: number;
  readonly #listeners: (() => void)[] = [];
  #time = 0;
  #playing = false;
  #lastTick = 0;

  constructor(duration: number) {
    this.#duration = duration;
  }

  /** Shown time [s]. */
  get time(): number {
    return this.#time;
  }

  get playing(): boolean {
    return this.#playing;
  }

  /** Calls `listener` when time or playing have changed. */
  onChange(listener: () => void): void {
    this.#listeners.push(listener);
  }

  /** Goes to `time` [s], or as near as the run allows. */
  seek(time: number): void {
    this.#time = Math.min(Math.max(time, 0), this.#duration);
    this.#notify();
  }

  play(): void {
    if (this.#playing || this.#duration <= 0) return;
    if (this.#duration <= this.#time) this.#time = 0;
    this.#playing = true;
    this.#lastTick = performance.now();
    requestAnimationFrame((now) => this.#tick(now));
    this.#notify();
  }

  pause(): void {
    this.#playing = false;
    this.#notify();
  }

  toggle(): void {
    if (this.#playing) this.pause();
    else this.play();
  }

  #tick(now: number): void {
    if (!this.#playing) return;
    // After the page was hidden, go on from where it was left.
    const passed = Math.min(Math.max(now - this.#lastTick, 0), 250) / 1000;
    this.#lastTick = now;
    this.#time += passed * this.speed;
    if (this.#duration <= this.#time) this.#time %= this.#duration;
    this.#notify();
    requestAnimationFrame((next) => this.#tick(next));
  }

  #notify(): void {
    for (const listener of this.#listeners) listener();
  }
}

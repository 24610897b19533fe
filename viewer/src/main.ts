// Puts the page together.

import { length, prefix } from "./format";
import { Motion } from "./motion";
import { Player } from "./player";
import { Plot, isShown } from "./plots";
import { type RunDescription, readFrames, runFrame } from "./run";
import { speedsFor, usualSpeed } from "./speeds";
import { Stage, canDraw } from "./stage";
import { LEAST_STRAIN, showLegend, strainScale } from "./strain-scale";

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

function showFacts(run: RunDescription): void {
  element("title").title = run.title;
  element("notice").textContent = run.notice;
  element("notice").hidden = !run.notice;
  for (const [name, value] of run.facts) {
    const fact = document.createElement("div");
    fact.append(
      Object.assign(document.createElement("dt"), { textContent: name }),
      Object.assign(document.createElement("dd"), { textContent: value, title: value }),
    );
    element("facts").append(fact);
  }
  const shown = run.frameStride === 1 ? "" : ` It shows every ${ordinal(run.frameStride)} frame of the run and the last.`;
  element("about").textContent = `This page was written by muslin and needs no network.${shown}`;
}

function ordinal(n: number): string {
  const ending = n % 100 < 11 || 13 < n % 100 ? ["th", "st", "nd", "rd"][n % 10] : undefined;
  return `${n}${ending ?? "th"}`;
}

function createPlots(run: RunDescription, player: Player): Plot[] {
  const duration = (run.frameCount - 1) / run.frameRate;
  const largest = run.energies.flatMap(({ values }) => values).reduce<number>((a, b) => Math.max(a, Math.abs(b ?? 0)), 0);
  const [factor, letter] = prefix(largest);
  const common = { times: run.times, duration, seek: (time: number) => player.seek(time) };
  const plots = [
    { ...common, title: "Energy", unit: `${letter}J`, factor: 1 / factor, least: 0, series: run.energies },
    { ...common, title: "Strain", unit: "%", factor: 100, least: 100 * LEAST_STRAIN, series: run.strains },
  ];
  return plots.filter(({ series }) => series.some(isShown)).map((options) => new Plot(element("plots"), options));
}

/** Play button, scrubber, clock and speed. */
function connectTransport(run: RunDescription, player: Player): void {
  const [play, scrub, speed] = [element<HTMLButtonElement>("play"), element<HTMLInputElement>("scrub"), element<HTMLSelectElement>("speed")];
  const duration = (run.frameCount - 1) / run.frameRate;
  const digits = Math.min(Math.max(Math.ceil(Math.log10(run.frameRate)) + 1, 2), 6);
  scrub.max = String(duration || 1);
  scrub.disabled = play.disabled = duration === 0;
  element("duration").textContent = ` / ${duration.toFixed(digits)} s`;
  const speeds = speedsFor(duration);
  player.speed = usualSpeed(speeds, duration);
  speed.replaceChildren(...speeds.map(({ name, value }) => new Option(name, String(value), false, value === player.speed)));
  play.addEventListener("click", () => player.toggle());
  scrub.addEventListener("input", () => player.seek(Number(scrub.value)));
  speed.addEventListener("change", () => {
    player.speed = Number(speed.value);
  });
  player.onChange(() => {
    const frame = Math.min(Math.floor(player.time * run.frameRate + 1e-6), run.frameCount - 1);
    scrub.value = String(player.time);
    scrub.style.setProperty("--done", String(duration === 0 ? 0 : player.time / duration));
    element("time").textContent = player.time.toFixed(digits);
    element("frame").textContent = `frame ${frame + 1} of ${run.frameCount}`;
    play.classList.toggle("playing", player.playing);
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
  });
}

interface Action {
  keys: string[];
  act: (event: KeyboardEvent) => void;
}

function connectKeys(actions: Action[]): void {
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest("select, dialog")) return;
    // A focused button keeps its own keys.
    if (event.key === " " && target.closest("button")) return;
    const action = actions.find(({ keys }) => keys.includes(event.key.length === 1 ? event.key.toLowerCase() : event.key));
    if (!action) return;
    event.preventDefault();
    action.act(event);
  });
  // After a click with the pointer, the space bar plays again.
  document.addEventListener("click", (event) => {
    if (0 < event.detail) (event.target as HTMLElement).closest<HTMLElement>("button")?.blur();
  });
}

function connectTime(run: RunDescription, player: Player): void {
  const step = (frames: number) => {
    const interval = run.frameStride / run.frameRate;
    const at = player.time / interval;
    // From between two frames, one step leads to the nearer end on that side.
    const from = 0 < frames ? Math.floor(at + 1e-6) : Math.ceil(at - 1e-6);
    player.pause();
    player.seek((Math.max(from + frames, 0) * run.frameStride) / run.frameRate);
  };
  const speed = element<HTMLSelectElement>("speed");
  const changeSpeed = (by: number) => {
    speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + by, 0), speed.options.length - 1);
    speed.dispatchEvent(new Event("change"));
  };
  const help = element<HTMLDialogElement>("help-dialog");
  element("help").addEventListener("click", () => help.showModal());
  help.addEventListener("click", (event) => {
    if (event.target === help) help.close();
  });
  connectKeys([
    { keys: [" "], act: () => player.toggle() },
    { keys: ["ArrowLeft"], act: (event) => step(event.shiftKey ? -10 : -1) },
    { keys: ["ArrowRight"], act: (event) => step(event.shiftKey ? 10 : 1) },
    { keys: ["Home"], act: () => player.seek(0) },
    { keys: ["End"], act: () => { player.pause(); player.seek(Infinity); } },
    { keys: ["["], act: () => changeSpeed(-1) },
    { keys: ["]"], act: () => changeSpeed(1) },
    { keys: ["?"], act: () => help.showModal() },
    { keys: ["s"], act: () => element("strain").click() },
    { keys: ["w"], act: () => element("wireframe").click() },
    { keys: ["f"], act: () => element("follow").click() },
    { keys: ["r"], act: () => element("reset").click() },
  ]);
}

/** The cloth and the buttons that change how it is seen. */
function connectStage(motion: Motion, player: Player): Stage {
  const stage = new Stage(element<HTMLCanvasElement>("stage"), motion);
  const scale = strainScale(motion);
  stage.cloth.strainLimit = scale.limit;
  showLegend(element("legend"), scale);
  const { frameStride } = motion.run;
  const every = frameStride === 1 ? "" : `every ${ordinal(frameStride)} frame, `;
  element("grid-note").hidden = !motion.hasExtent;
  element("grid-note").textContent = `${every}grid ${length(stage.gridSpacing)}`;
  const switchable = (id: string, get: () => boolean, set: (on: boolean) => void) => {
    const button = element(id);
    button.setAttribute("aria-pressed", String(get()));
    button.addEventListener("click", () => {
      set(!get());
      button.setAttribute("aria-pressed", String(get()));
      stage.request();
    });
  };
  const { cloth } = stage;
  switchable("strain", () => cloth.coloured, (on) => {
    cloth.coloured = on;
    element("legend").hidden = !on;
  });
  switchable("wireframe", () => cloth.wireframe, (on) => { cloth.wireframe = on; });
  switchable("follow", () => stage.following, (on) => { stage.following = on; });
  element<HTMLButtonElement>("wireframe").disabled = !cloth.hasFaces;
  element("reset").addEventListener("click", () => stage.reset());
  player.onChange(() => {
    motion.moveTo(player.time);
    stage.update();
  });
  return stage;
}

async function start(): Promise<void> {
  const run = JSON.parse(element("run").textContent ?? "") as RunDescription;
  const player = new Player(runFrame(run, Infinity) / run.frameRate);
  showFacts(run);
  connectTransport(run, player);
  connectTime(run, player);
  const plots = createPlots(run, player);
  player.onChange(() => plots.forEach((plot) => plot.showTime(player.time)));
  player.seek(0);

  const message = element("message");
  const payload = element("frames");
  let stage: Stage | undefined;
  if (!canDraw()) {
    message.textContent = "This browser cannot draw in three dimensions: WebGL 2 is missing or switched off. The plots work without it.";
  } else {
    const frames = await readFrames(run, payload.textContent ?? "");
    payload.remove();
    stage = connectStage(new Motion(run, frames), player);
    message.hidden = true;
    player.seek(0);
  }
  document.body.classList.toggle("ready", stage !== undefined);
  for (const button of document.querySelectorAll<HTMLButtonElement>(".tools button:not(#help)")) {
    button.disabled ||= stage === undefined;
  }

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const applyTheme = () => {
    const style = getComputedStyle(document.documentElement);
    stage?.setTheme(style.getPropertyValue("--floor").trim(), dark.matches ? 0.55 : 0.24);
    plots.forEach((plot) => plot.redraw());
  };
  dark.addEventListener("change", applyTheme);
  applyTheme();
  if (stage && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();
}

start().catch((error: unknown) => {
  const message = element("message");
  message.hidden = false;
  message.textContent = `The run could not be shown: ${error instanceof Error ? error.message : String(error)}`;
  console.error(error);
});

// Opens a page in Chromium and checks that it works: node check/check.mjs PAGE [--shots DIR]

import { mkdir } from "node:fs/promises";
import { resolve } from "node:path";
import { parseArgs } from "node:util";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const SIZES = { phone: [390, 844], landscape: [844, 390], desktop: [1920, 1080], large: [2560, 1440] };
// Software rendering, so that the check needs no graphics card.
const FLAGS = [
  "--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking",
  "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];

const { values, positionals } = parseArgs({ allowPositionals: true, options: { shots: { type: "string" } } });
if (positionals.length !== 1) throw new Error("usage: check.mjs PAGE [--shots DIR]");
const address = pathToFileURL(resolve(positionals[0])).href;
if (values.shots) await mkdir(values.shots, { recursive: true });

const failures = [];
const check = (holds, what) => {
  console.log(`${holds ? "ok  " : "FAIL"} ${what}`);
  if (!holds) failures.push(what);
};

const launch = (flags) =>
  chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: flags, headless: true });
const browser = await launch(FLAGS);

/** The page in a window of `size`, with a record of all it complains about and asks for. */
async function open(from, [width, height], options = {}) {
  const context = await from.newContext({ viewport: { width, height }, reducedMotion: "reduce", ...options });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => {
    // Remarks of the software renderer on reading pictures back are about the check, not the page.
    if (/GPU stall due to ReadPixels/.test(message.text())) return;
    if (["error", "warning"].includes(message.type())) complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    if (request.url() !== address && !request.url().startsWith("data:")) complaints.push(`request: ${request.url()}`);
  });
  page.on("requestfailed", (request) => complaints.push(`failed request: ${request.url()}`));
  const started = performance.now();
  await page.goto(address);
  return { page, complaints, started };
}

/** Waits until the picture has been drawn. */
const settle = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 100)))));

const lens = await browser.newPage();

/** Share of the pixels of two PNG pictures that differ. */
function difference(a, b) {
  return lens.evaluate(async (pictures) => {
    const [p, q] = await Promise.all(
      pictures.map(async (picture) => {
        const image = new Image();
        image.src = `data:image/png;base64,${picture}`;
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        return new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
      }),
    );
    let differing = 0;
    for (let i = 0; i < p.length; i++) if (p[i] !== q[i]) differing++;
    return differing / p.length;
  }, [a.toString("base64"), b.toString("base64")]);
}

const view = async (page) => {
  await settle(page);
  return page.locator("#view").screenshot();
};
const time = (page) => page.locator("#time").textContent().then(Number);
const percent = (share) => `${(100 * share).toFixed(2)} %`;

async function checkWorking() {
  const { page, complaints, started } = await open(browser, [1280, 900]);
  await page.waitForSelector("body.ready", { timeout: 30_000 });
  console.log(`ready after ${Math.round(performance.now() - started)} ms, rendered in software`);
  await page.waitForTimeout(700);
  const run = JSON.parse(await page.locator("#run").textContent());
  const duration = (run.frameCount - 1) / run.frameRate;
  const first = await view(page);
  check((await difference(first, await view(page))) === 0, "a paused view stays as it is");

  if (0 < duration) {
    await page.locator("#play").click();
    // However slow the drawing, time goes on.
    const reached = (least) => Number(document.getElementById("time").textContent) >= least;
    await page.waitForFunction(reached, duration / 10, { timeout: 60_000 });
    await page.keyboard.press("Space");
    const moved = await difference(first, await view(page));
    check(0 < (await time(page)), `playing moves the clock (to ${await time(page)} s)`);
    check(1e-4 < moved, `playing moves the cloth (${percent(moved)} of the pixels)`);

    // Tooltips are not part of the picture.
    await page.mouse.move(5, 5);
    await page.waitForTimeout(500);
    await page.keyboard.press("Home");
    check((await time(page)) === 0, "home leads to the start");
    check((await difference(first, await view(page))) === 0, "the start looks as before");
    await page.locator("#scrub").evaluate((scrub, value) => {
      scrub.value = value;
      scrub.dispatchEvent(new Event("input", { bubbles: true }));
    }, String(duration / 2));
    check(Math.abs((await time(page)) - duration / 2) < 0.01, "the scrubber sets the time");
    const scrubbed = await difference(first, await view(page));
    check(1e-4 < scrubbed, `the scrubber moves the cloth (${percent(scrubbed)})`);
    await page.keyboard.press("End");
    check(Math.abs((await time(page)) - duration) < 0.001, "end leads to the end");
    await page.keyboard.press("ArrowLeft");
    check((await time(page)) < duration, "an arrow key leads one frame back");
    for (const plot of await page.locator("#plots figure").all()) {
      const looks = await plot.locator("li button").evaluateAll((buttons) => buttons.map((button) => button.style.cssText + button.className));
      check(new Set(looks).size === looks.length, "every line of a plot looks different");
    }
    for (const plot of await page.locator(".u-over").all()) {
      const box = await plot.boundingBox();
      await page.mouse.move(box.x + 5, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2, { steps: 3 });
      await page.mouse.up();
      check(Math.abs((await time(page)) - duration / 2) < 0.02 * duration, "dragging in a plot sets the time");
    }
  }

  const plain = await view(page);
  await page.locator("#strain").click();
  await page.mouse.move(5, 5);
  await page.waitForTimeout(500);
  const coloured = await difference(plain, await view(page));
  check(1e-4 < coloured, `strain changes the colours (${percent(coloured)})`);
  check(/%/.test(await page.locator("#legend").innerText()), "the legend is in percent");

  const box = await page.locator("#stage").boundingBox();
  await page.waitForTimeout(500);
  const beforeTurn = await view(page);
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 180, box.y + box.height / 2 + 40, { steps: 5 });
  await page.mouse.up();
  await page.waitForTimeout(900);
  const turned = await difference(beforeTurn, await view(page));
  check(1e-4 < turned, `dragging turns the view (${percent(turned)})`);
  await page.keyboard.press("r");
  await page.mouse.move(5, 5);
  await page.waitForTimeout(900);
  const reset = await difference(beforeTurn, await view(page));
  check(reset < 1e-3, `reset brings the view back (${percent(reset)})`);

  const inks = await page.locator(".plot canvas").evaluateAll((canvases) =>
    canvases.map((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.filter((value, i) => i % 4 === 3 && value !== 0).length / (data.length / 4);
    }),
  );
  const plotted = (series) => series.some(({ values }) => values.some((value) => value !== null && value !== 0));
  const expected = plotted(run.energies) + plotted(run.strains);
  check(inks.length === expected && inks.every((ink) => 0.002 < ink), `${expected} plots are drawn (${inks.map(percent)})`);
  check(complaints.length === 0, `no errors, warnings or requests ${complaints.join("; ")}`);
  await page.context().close();
}

async function checkSizes() {
  for (const [name, size] of Object.entries(SIZES)) {
    for (const colorScheme of ["light", "dark"]) {
      const phone = name === "phone";
      const options = { colorScheme, hasTouch: phone, isMobile: phone, deviceScaleFactor: phone ? 2 : 1 };
      const { page, complaints } = await open(browser, size, options);
      await page.waitForSelector("body.ready", { timeout: 30_000 });
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      check(overflow <= 0, `${name}, ${colorScheme}: nothing is wider than the window`);
      const plotOverflow = await page.locator("#plots figure").evaluateAll((figures) =>
        Math.max(0, ...figures.map((figure) => figure.querySelector(".uplot").offsetWidth - figure.clientWidth)),
      );
      check(plotOverflow <= 1, `${name}, ${colorScheme}: plots keep to their places`);
      await page.locator("#scrub").evaluate((scrub) => {
        scrub.value = String(0.45 * Number(scrub.max));
        scrub.dispatchEvent(new Event("input", { bubbles: true }));
      });
      for (const coloured of [false, true]) {
        if (coloured) await page.locator("#strain").click();
        await page.mouse.move(2, 2);
        await page.waitForTimeout(700);
        await settle(page);
        if (coloured) {
          const labels = await page.locator("#legend li").evaluateAll((marks) => marks.map((mark) => mark.getBoundingClientRect()));
          const apart = labels.every(({ left }, i) => i === 0 || labels[i - 1].right < left);
          check(apart, `${name}, ${colorScheme}: the labels of the legend stand apart`);
        }
        const path = `${values.shots}/${name}-${colorScheme}${coloured ? "-strain" : ""}.png`;
        if (values.shots) await page.screenshot({ path, fullPage: phone });
      }
      check(complaints.length === 0, `${name}, ${colorScheme}: no complaints ${complaints.join("; ")}`);
      await page.context().close();
    }
  }
}

/** Without WebGL the page says so and the plots still work. */
async function checkWithoutGraphics() {
  const bare = await launch(["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-3d-apis"]);
  const { page, complaints } = await open(bare, [1280, 900]);
  await page.waitForTimeout(500);
  check(/WebGL/.test(await page.locator("#message").innerText()), "without WebGL a message says so");
  check(0 < (await page.locator(".plot canvas").count()), "without WebGL the plots are there");
  check(complaints.length === 0, `without WebGL: no complaints ${complaints.join("; ")}`);
  if (values.shots) await page.screenshot({ path: `${values.shots}/no-webgl.png` });
  await bare.close();
}

try {
  await checkWorking();
  await checkSizes();
  await checkWithoutGraphics();
} finally {
  await browser.close();
}
console.log(failures.length === 0 ? "all checks hold" : `${failures.length} checks fail`);
process.exitCode = failures.length === 0 ? 0 : 1;

// Bundles the sources into the one template that the Rust library fills, and lists the licences of what is bundled.

import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const here = (path) => new URL(path, import.meta.url);
const TEMPLATE = here("../crates/muslin/src/write/view/template.html");
const LICENSES = here("LICENSES.md");
const PLACEHOLDERS = { "@@TITLE@@": 2, "@@RUN@@": 1, "@@FRAMES@@": 1 };
const BUNDLED = ["three", "uplot"];

/** One minified file from an entry point. */
async function bundle(entry) {
  const result = await build({
    entryPoints: [here(entry).pathname],
    bundle: true,
    minify: true,
    format: "iife",
    target: ["es2022"],
    charset: "utf8",
    legalComments: "none",
    write: false,
  });
  return result.outputFiles[0].text.trim();
}

/** `text` with the one occurrence of `mark` replaced; the replacement is taken literally. */
function fill(text, mark, replacement) {
  const pieces = text.split(mark);
  if (pieces.length !== 2) throw new Error(`${mark} occurs ${pieces.length - 1} times`);
  return pieces.join(replacement);
}

async function licences() {
  const texts = [];
  for (const name of BUNDLED) {
    const { version, license } = JSON.parse(await readFile(here(`node_modules/${name}/package.json`), "utf8"));
    if (license !== "MIT") throw new Error(`${name} is now under ${license}`);
    const text = (await readFile(here(`node_modules/${name}/LICENSE`), "utf8")).trim().replace(/\r\n/g, "\n");
    texts.push({ name, version, text });
  }
  return texts;
}

const script = await bundle("src/main.ts");
const style = await bundle("src/style.css");
const texts = await licences();
// Inside a script element these would end it or change how the rest is read.
for (const forbidden of [/<\/script/i, /<script/i, /<!--/]) {
  if (forbidden.test(script)) throw new Error(`the bundle contains ${forbidden}`);
}
if (/<\/style/i.test(style)) throw new Error("the style sheet contains </style");

const notice = texts.map(({ name, version, text }) => `${name} ${version}\n\n${text}`).join("\n\n");
if (notice.includes("--")) throw new Error("a licence text cannot stand in an HTML comment");

const markup = (await readFile(here("src/page.html"), "utf8")).replace(/^\s+/gm, "");
let page = fill(markup, "/*NOTICE*/", `This page contains the following libraries.\n\n${notice}`);
page = fill(page, "/*STYLE*/", style);
page = fill(page, "/*SCRIPT*/", script);
for (const [placeholder, count] of Object.entries(PLACEHOLDERS)) {
  const found = page.split(placeholder).length - 1;
  if (found !== count) throw new Error(`${placeholder} occurs ${found} times in the template`);
}
// A file that is written is compiled again, with all of the library.
if (page !== (await readFile(TEMPLATE, "utf8").catch(() => null))) await writeFile(TEMPLATE, page);

const list = texts.map(({ name, version, text }) => `## ${name} ${version}\n\n\`\`\`text\n${text}\n\`\`\`\n`);
await writeFile(LICENSES, `# Libraries in the page\n\nWritten by the build; the page itself carries the same texts.\n\n${list.join("\n")}`);
console.log(`script ${script.length} B, style ${style.length} B, template ${Buffer.byteLength(page)} B`);

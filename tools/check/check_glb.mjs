// Runs the Khronos glTF validator over .glb files: `node check_glb.mjs FILE...`
// Any error or warning fails; infos are printed.
import { readFile } from "node:fs/promises";
import validator from "gltf-validator";

const SEVERITIES = ["error", "warning", "info", "hint"];
const WARNING = 1;

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node check_glb.mjs FILE...");
  process.exit(2);
}
let failed = false;
for (const file of files) {
  const bytes = new Uint8Array(await readFile(file));
  // Without a limit the many like messages of a long animation would hide others.
  const { issues, info } = await validator.validateBytes(bytes, { uri: file, format: "glb", maxIssues: 0 });
  const counts = new Map();
  for (const { code, severity, message, pointer } of issues.messages) {
    failed ||= severity <= WARNING;
    const seen = counts.get(code) ?? 0;
    counts.set(code, seen + 1);
    if (seen < 5) console.log(`${file}: ${SEVERITIES[severity]} ${code} at ${pointer}: ${message}`);
  }
  for (const [code, count] of counts) if (count > 5) console.log(`${file}: ${code}: ${count} in all`);
  console.log(
    `${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos; ` +
      `${info.animationCount} animations, ${info.totalVertexCount} vertices, ${info.totalTriangleCount} triangles`,
  );
}
process.exit(failed ? 1 : 0);

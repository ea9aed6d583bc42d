// Bundles the page into one file, dist/page.html: markup, style, program, and the licences of what is bundled.

import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const common = { bundle: true, minify: true, write: false, legalComments: "inline", target: "es2022" };
const program = await build({ ...common, entryPoints: ["src/main.ts"], format: "iife", metafile: true });
const style = await build({ ...common, entryPoints: ["src/style.css"] });

/** The packages whose code is in the bundle. */
const packages = new Set(
  Object.keys(program.metafile.inputs)
    .filter((input) => input.includes("node_modules/"))
    .map((input) => input.split("node_modules/").at(-1).split("/").slice(0, input.includes("node_modules/@") ? 2 : 1).join("/")),
);

/** Name, version, licence and notice of a package. */
async function notices(name) {
  const folder = `node_modules/${name}`;
  const { version, license } = JSON.parse(await readFile(`${folder}/package.json`, "utf8"));
  const entries = await readdir(folder, { recursive: true, withFileTypes: true });
  const files = entries
    .filter((entry) => entry.isFile() && /^(licen[cs]e|notice|copying)/i.test(entry.name))
    .map((entry) => `${entry.parentPath ?? entry.path}/${entry.name}`)
    .filter((file) => !file.slice(folder.length).includes("node_modules"))
    .sort();
  if (!files.some((file) => /(licen[cs]e|copying)/i.test(file))) throw new Error(`${name} has no licence file`);
  const texts = await Promise.all(files.map((file) => readFile(file, "utf8")));
  return [`${name} ${version} (${license})`, ...texts.map((text) => text.trim())].join("\n\n");
}

const licences = (await Promise.all([...packages].sort().map(notices))).join(`\n\n${"—".repeat(20)}\n\n`);
const escaped = licences.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

const parts = { STYLE: style.outputFiles[0].text, PROGRAM: program.outputFiles[0].text, LICENCES: escaped };
const template = await readFile("src/page.html", "utf8");
const page = template.replace(/%(STYLE|PROGRAM|LICENCES)%/g, (_, name) => parts[name]);
for (const mark of ["%STICKSLIP_TITLE%", "%STICKSLIP_DATA%"]) {
  if (page.split(mark).length !== 2) throw new Error(`${mark} must stand in the page once`);
}
await mkdir("dist", { recursive: true });
// A file that is the same keeps its date, and what embeds it is not built again.
const before = await readFile("dist/page.html", "utf8").catch(() => "");
if (before !== page) await writeFile("dist/page.html", page);
console.log(`dist/page.html: ${Math.round(page.length / 1024)} KiB with ${[...packages].sort().join(", ")}`);

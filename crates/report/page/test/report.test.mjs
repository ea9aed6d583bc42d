// The page in a browser, made by the program that is told in STICKSLIP from the scenes of the repository: what is drawn is
// what the results say, with a mouse and without one, on a screen and on paper, and no network is asked for anything.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, afterEach, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const program = resolve(process.env.STICKSLIP ?? "../../../target/release/stickslip");
const scenes = resolve("../../../scenes");
const folder = mkdtempSync(join(tmpdir(), "stickslip-report-"));
const inFolder = (name) => join(folder, name);
const stickslip = (...words) => execFileSync(program, words, { cwd: folder, stdio: ["ignore", "pipe", "ignore"] });
const read = (name) => JSON.parse(readFileSync(inFolder(name), "utf8"));
const write = (name, value) => writeFileSync(inFolder(name), JSON.stringify(value));

const HOSTILE = "</script><img src=x onerror=\"document.title='taken'\"><!--";
const FLAGS = [
  "--headless",
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

let browser;
let open = [];

before(async () => {
  const [hoffmann, cubic, shroud] = ["hoffmann-2017", "cubic", "shroud"].map((name) => join(scenes, `${name}.json`));
  stickslip("sweep", hoffmann, "-o", "one.json");
  stickslip("sweep", hoffmann, "--harmonics", "7", "--frequencies", "20:120:101", "-o", "seven.json");
  stickslip("continue", cubic, "-o", "cubic.json");
  stickslip("sweep", shroud, "-o", "shroud.json");
  stickslip("report", "seven.json", "--scene", hoffmann, "-o", "seven.html");
  stickslip("report", "one.json", "seven.json", "--scene", hoffmann, "-o", "two.html");
  stickslip("report", "cubic.json", "--scene", cubic, "-o", "cubic.html");
  stickslip("report", "shroud.json", "--scene", shroud, "-o", "shroud.html");

  const failed = read("seven.json");
  for (const key of ["displacement", "contacts"]) delete failed.points[40][key];
  Object.assign(failed.points[40], { status: "failed", reason: "the iteration did not converge from any start" });
  write("failed.json", failed);
  stickslip("report", "failed.json", "-o", "failed.html");

  const named = (value) => ({ ...value, scene: HOSTILE, notes: [HOSTILE], dofs: [HOSTILE, "w2"] });
  const hostile = named(read("seven.json"));
  for (const point of hostile.points) {
    point.displacement = { [HOSTILE]: point.displacement.w1, w2: point.displacement.w2 };
    point.contacts = { [HOSTILE]: point.contacts.root };
  }
  write("hostile.json", hostile);
  stickslip("report", "hostile.json", "-o", "hostile.html");

  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Opens a report; whatever it asks a network for is refused and counted. */
async function show(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, offline: true, ...options });
  const address = pathToFileURL(inFolder(name)).href;
  const seen = { requests: [], errors: [] };
  await context.route("**/*", (route) => {
    if (route.request().url() === address) return route.continue();
    seen.requests.push(route.request().url());
    return route.abort();
  });
  const page = await context.newPage();
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) seen.errors.push(message.text());
  });
  page.on("pageerror", (error) => seen.errors.push(error.message));
  await page.goto(address);
  await page.waitForFunction(() => document.querySelectorAll("#chart-response svg path").length > 0);
  open.push({ context, seen });
  return page;
}

afterEach(async () => {
  const pages = open;
  open = [];
  for (const { context, seen } of pages) {
    await context.close();
    assert.deepEqual(seen, { requests: [], errors: [] });
  }
});

const choice = (page) => page.evaluate(() => window.stickslip.choice());
const option = (page, chart) => page.evaluate((chart) => window.stickslip.options()[chart], chart);
const status = (page) => page.locator(".status").textContent();
const PREFIX = { "": 1, m: 1e-3, µ: 1e-6, n: 1e-9 };

/** What the drawn loop says: largest and smallest displacement in m, and the energy in it in J. */
async function loop(page, chart = "loop", line = 0) {
  const drawn = await option(page, chart);
  const unit = (name, basic) => PREFIX[name.match(new RegExp(` in (.?)${basic}$`))[1]];
  const [x, y] = [unit(drawn.xAxis[0].name, "m"), unit(drawn.yAxis[0].name, "N")];
  const points = drawn.series[line].data.map(([w, f]) => [w * x, f * y]);
  const w = points.map(([w]) => w);
  const area = points.slice(1).reduce((sum, [w, f], i) => sum + ((f + points[i][1]) / 2) * (w - points[i][0]), 0);
  return { amplitude: (Math.max(...w) - Math.min(...w)) / 2, area };
}

/** The lines that the browser draws of a loop. */
const drawnLoop = (page, chart = "loop") =>
  page.evaluate((chart) => [...document.querySelectorAll(`#chart-${chart} svg path`)].map((path) => path.getAttribute("d")).join(), chart);

const close = (a, b, tolerance) => assert.ok(Math.abs(a / b - 1) < tolerance, `${a} and ${b}`);

async function clickPoint(page, at, amplitude) {
  const name = (await option(page, "response")).yAxis[0].name;
  const unit = PREFIX[name.match(/ in (.?)m$/)[1]];
  const [x, y] = await page.evaluate((value) => window.stickslip.pixel("response", value), [at, amplitude / unit]);
  await page.locator("#chart-response").click({ position: { x, y } });
}

/** |W_1| of a dof at a point. */
const first = (point, dof) => Math.hypot(...point.displacement[dof].find(([k]) => k === 1).slice(1));

test("a click on a curve shows the loop of that point as the result has it", async () => {
  const { points } = read("seven.json");
  const page = await show("seven.html");
  let before = await drawnLoop(page);
  for (const index of [15, 60]) {
    const point = points[index];
    await clickPoint(page, point.frequency, first(point, "w2"));
    assert.deepEqual(await choice(page), { result: 0, point: index });
    assert.ok((await status(page)).includes(`${point.frequency} Hz`));
    // 128 instants miss a rounded tip by (π/128)²/2 at most, and more harmonics make it sharper.
    const { amplitude, area } = await loop(page);
    close(amplitude, point.contacts.root.amplitude, 3e-3);
    close(area, point.contacts.root.dissipation, 1e-2);
    const now = await drawnLoop(page);
    assert.notEqual(now, before);
    before = now;
  }
});

test("the keyboard alone reaches every point", async () => {
  const { points } = read("seven.json");
  const page = await show("seven.html");
  const focused = () => page.evaluate(() => document.activeElement?.getAttribute("name") ?? "");
  let presses = 0;
  while ((await focused()) !== "point") {
    assert.ok(++presses < 40, "the slider is not reached by the tabulator key");
    await page.keyboard.press("Tab");
  }
  const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
  assert.equal(outline, "solid");
  await page.keyboard.press("Home");
  assert.equal((await choice(page)).point, 0);
  const before = await drawnLoop(page);
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowRight");
  assert.equal((await choice(page)).point, 3);
  assert.notEqual(await drawnLoop(page), before);
  close((await loop(page)).amplitude, points[3].contacts.root.amplitude, 3e-3);
  const said = await page.evaluate(() => document.activeElement.getAttribute("aria-valuetext"));
  assert.equal(said, `${points[3].frequency} Hz, point 4 of ${points.length}`);
  await page.keyboard.press("End");
  assert.equal((await choice(page)).point, points.length - 1);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.equal((await choice(page)).point, points.length - 2);
  // A place that is written down.
  const place = page.locator("input[name=place]");
  await place.fill("75.2");
  await place.press("Enter");
  assert.equal(points[(await choice(page)).point].frequency, 75);
});

test("the table says what the result says", async () => {
  const { points } = read("seven.json");
  const page = await show("seven.html");
  const place = page.locator("input[name=place]");
  await place.fill("55");
  await place.press("Enter");
  const point = points[(await choice(page)).point];
  assert.equal(point.frequency, 55);
  const cells = await page.locator("#numbers td").allTextContents();
  const shown = (value, unit) => cells.some((cell) => Math.abs(parseFloat(cell) / value - 1) < 1e-4 && cell.includes(unit));
  assert.ok(shown(first(point, "w1") * 1e6, "µm") && shown(first(point, "w2") * 1e6, "µm"), cells.join("; "));
  assert.ok(shown(point.contacts.root.amplitude * 1e6, "µm"), cells.join("; "));
  assert.ok(cells.some((cell) => cell.includes("an estimate")));
});

test("a part of the range fills the picture, and the whole comes back", async () => {
  const page = await show("seven.html");
  const range = async () => (await option(page, "response")).dataZoom.map((zoom) => [zoom.startValue, zoom.endValue])[0];
  const path = () => drawnLoop(page, "response");
  const whole = await path();
  for (const [name, value] of [["from", "40"], ["to", "60"]]) {
    await page.locator(`input[name=${name}]`).fill(value);
    await page.locator(`input[name=${name}]`).press("Enter");
  }
  assert.deepEqual(await range(), [40, 60]);
  assert.notEqual(await path(), whole);
  const { points } = read("seven.json");
  const inside = points.filter((point) => point.frequency >= 39 && point.frequency <= 61);
  const most = Math.max(...inside.map((point) => first(point, "w2"))) * 1e6;
  close((await option(page, "response")).yAxis[0].max, most * 1.1, 1e-9);
  await page.getByRole("button", { name: "whole range" }).click();
  assert.deepEqual(await range(), [20, 120]);
  assert.equal(await path(), whole);
  await page.getByLabel("linear", { exact: true }).check();
  assert.equal((await option(page, "response")).yAxis[0].type, "value");
  // The wheel zooms with Ctrl alone; otherwise it turns the page.
  const box = await page.locator("#chart-response").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -400);
  await page.keyboard.up("Control");
  await page.waitForFunction(() => window.stickslip.options().response.dataZoom[0].endValue < 120);
});

test("two results lie over each other, curves and loops", async () => {
  const [one, seven] = [read("one.json"), read("seven.json")];
  const page = await show("two.html");
  const names = (await option(page, "response")).series.map((series) => series.name);
  for (const name of ["one: w1", "one: w2", "seven: w1", "seven: w2", "hoffmann-2017: w2 without contacts"]) {
    assert.ok(names.includes(name), names.join());
  }
  const legend = await page.locator("#chart-response svg text").allTextContents();
  assert.ok(legend.includes("one: w1") && legend.includes("seven: w1"), legend.join());
  await page.locator("select[name=result]").selectOption({ label: "seven" });
  const place = page.locator("input[name=place]");
  await place.fill("55");
  await place.press("Enter");
  const point = (result) => result.points.find((point) => point.frequency === 55);
  close((await loop(page, "loop", 0)).amplitude, point(seven).contacts.root.amplitude, 3e-3);
  // The other result is not kept at every point; the nearest kept one is within a step.
  close((await loop(page, "loop", 1)).amplitude, point(one).contacts.root.amplitude, 2e-2);
});

test("a curve is drawn through its folds in its order", async () => {
  const { points } = read("cubic.json");
  const page = await show("cubic.html");
  const { series } = await option(page, "response");
  const places = series.find((line) => line.name === "w2").data.map(([at]) => at);
  assert.deepEqual(places, points.map((point) => point.parameter));
  assert.ok(places.some((at, i) => i > 0 && at < places[i - 1]));
  // Folds known from another program: 43.262 Hz and 43.219 Hz.
  const folds = [...new Set(series.find((line) => line.name === "folds").data.map(([at]) => at.toFixed(2)))].sort();
  assert.deepEqual(folds, ["43.22", "43.26"]);
});

test("a contact in several directions shows each of them and its path", async () => {
  const { points } = read("shroud.json");
  const page = await show("shroud.html");
  const place = page.locator("input[name=place]");
  await place.fill("99");
  await place.press("Enter");
  const contact = points.find((point) => point.frequency === 99).contacts.shroud;
  let energy = 0;
  for (const name of ["tangential1", "tangential2", "normal"]) {
    const { amplitude, area } = await loop(page, `loop-${name}`);
    close(amplitude, contact.directions[name].amplitude, 3e-3);
    energy += area;
  }
  close(energy, contact.dissipation, 2e-2);
  assert.equal(await page.locator("#chart-path svg").count(), 1);
});

test("a point that was not solved is marked and has no numbers", async () => {
  const page = await show("failed.html");
  const at = read("failed.json").points[40].frequency;
  const mark = (await option(page, "response")).series.find((series) => series.name === "not solved");
  assert.deepEqual(mark.data.map(([place]) => place), [at]);
  const place = page.locator("input[name=place]");
  await place.fill(String(at));
  await place.press("Enter");
  assert.match(await status(page), /not solved\. the iteration did not converge/);
  assert.equal(await page.locator("#chart-loop").count(), 0);
  const text = await page.locator("main").innerText();
  assert.match(text, /101, 1 of them not solved/);
  assert.match(text, /no motion to show/);
});

test("names are texts, whatever they hold", async () => {
  const page = await show("hostile.html");
  assert.equal(await page.title(), HOSTILE);
  assert.equal(await page.locator("h1").textContent(), HOSTILE);
  assert.equal(await page.locator("img").count(), 0);
  // The box at the pointer is made from names too.
  const box = await page.locator("#chart-response").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => document.querySelector("#chart-response .tip")?.textContent.includes("onerror"));
  assert.equal(await page.locator("img").count(), 0);
  assert.equal(await page.title(), HOSTILE);
});

/** The least contrast of a text with what is behind it (WCAG 2), and which text it is. */
const contrast = (page) =>
  page.evaluate(() => {
    const parts = (colour) => (colour.match(/[\d.]+/g) ?? []).map(Number);
    const light = (colour) => {
      const [r, g, b] = parts(colour).map((part) => (part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const behind = (element) => {
      for (let at = element; at; at = at.parentElement) {
        const colour = getComputedStyle(at).backgroundColor;
        if ((parts(colour)[3] ?? 1) > 0.99) return colour;
      }
      return "rgb(255, 255, 255)";
    };
    let worst = [Infinity, ""];
    for (const element of document.querySelectorAll("body *")) {
      const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
      const style = getComputedStyle(element);
      if (!own || ["SCRIPT", "STYLE", "NOSCRIPT", "OPTION"].includes(element.tagName) || element.getClientRects().length === 0) continue;
      const [a, b] = [light(element.closest("svg") ? style.fill : style.color), light(behind(element))];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (ratio < worst[0]) worst = [ratio, `${element.tagName} ${element.textContent.slice(0, 40)}`];
    }
    return worst;
  });

test("texts can be read in light, in the dark and on paper", async () => {
  for (const name of ["shroud.html", "two.html"]) {
    const page = await show(name);
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    for (const [media, colorScheme, paper] of [
      ["screen", "light", "rgb(255, 255, 255)"],
      ["screen", "dark", "rgb(20, 23, 28)"],
      ["print", "dark", "rgb(255, 255, 255)"],
    ]) {
      await page.emulateMedia({ media, colorScheme });
      // The pictures follow.
      const ink = media === "screen" && colorScheme === "dark" ? "232, 234, 237" : null;
      await page.waitForFunction((ink) => {
        const fill = getComputedStyle(document.querySelector("#chart-response svg text")).fill;
        return ink ? fill.includes(ink) : !fill.includes("232, 234, 237");
      }, ink);
      assert.equal(await ground(), paper);
      const [ratio, which] = await contrast(page);
      assert.ok(ratio >= 4.5, `${media}, ${colorScheme}: ${ratio} of ${which}`);
    }
  }
});

test("on paper pictures fit and controls are gone", async () => {
  const page = await show("shroud.html");
  await page.emulateMedia({ media: "print" });
  await page.waitForFunction(() => document.querySelector("#chart-response svg").getBoundingClientRect().width <= 700);
  assert.equal(await page.locator(".controls:visible").count(), 0);
  const cut = await page.evaluate(() => getComputedStyle(document.querySelector("figure")).breakInside);
  assert.equal(cut, "avoid");
  await page.emulateMedia({ media: "screen" });
  const paper = await page.pdf({ format: "A4" });
  assert.equal(paper.subarray(0, 5).toString(), "%PDF-");
});

test("a narrow window needs no scrolling sideways", async () => {
  for (const name of ["shroud.html", "two.html"]) {
    const page = await show(name, { viewport: { width: 400, height: 800 } });
    const [needed, there] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(needed <= there, `${name}: ${needed} px`);
  }
});

test("every picture has a text, and the licences of the program are there", async () => {
  const page = await show("shroud.html");
  const texts = await page.evaluate(() => [...document.querySelectorAll("[role=img]")].map((image) => image.getAttribute("aria-label")));
  assert.ok(texts.length >= 8 && texts.every((text) => text.length > 20), texts.join("\n"));
  assert.ok(texts[0].includes("1:x at most 1.226 mm at 99 Hz"), texts[0]);
  const notices = await page.locator("footer pre").textContent();
  for (const words of ["Apache License", "Apache ECharts", "Baidu Inc.", "zrender"]) assert.ok(notices.includes(words), words);
});

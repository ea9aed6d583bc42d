// The page: results, the chosen point and its period, and what is known about them.

import { options, pixel } from "./chart";
import { type Page, type Result, readPage } from "./data";
import { element, section, table } from "./dom";
import { estimates } from "./estimates";
import { PeriodView } from "./period";
import { PointView } from "./point";
import { type Choice, Response } from "./response";
import { place, show, withUnit } from "./words";

const page = readPage();
const main = document.getElementById("main") ?? document.body;
const names = [...new Set(page.results.map((result) => result.scene))];
text("title", names.join(", "));
text("subtitle", subtitle());

const notes = page.results.flatMap((result) => result.notes.map((note) => [result.label, note] as const));
if (notes.length > 0) {
  const several = page.results.length > 1;
  const lines = notes.map(([label, note]) => element("li", {}, several ? `${label}: ${note}` : note));
  main.append(section("What you should know", element("ul", { class: "notes" }, ...lines)));
}

let choice = first(page);
const views: { mark(choice: Choice): void }[] = [];
const choose = (next: Choice) => {
  choice = next;
  views.forEach((view) => view.mark(next));
};

const held = (title: string) => {
  const holder = section(title);
  main.append(holder);
  return holder;
};
const responseHolder = held("Response");
const response = new Response(page, choice, choose, responseHolder);
const pointHolder = held("Chosen point");
const point = new PointView(page, choice, choose);
pointHolder.append(point.root);
const periodHolder = held("One period at the chosen point");
periodHolder.classList.add("long");
const period = new PeriodView(page, choice, periodHolder);
views.push(response, point, period);
held("Error estimates").append(estimates(page));
if (page.results.some((result) => result.peaks.length > 0)) held("Peaks").append(...page.results.flatMap(peaks));
held("Results").append(...page.results.map(facts));
plans();

Object.assign(window, { stickslip: { page, options, pixel, choice: () => choice } });

function text(id: string, content: string): void {
  const found = document.getElementById(id);
  if (found) found.textContent = content;
}

function subtitle(): string {
  const count = page.results.length === 1 ? "one result" : `${page.results.length} results`;
  return `${count} of stickslip ${page.version}; lengths in m, forces in N, frequencies in Hz, angles in rad`;
}

/** The highest point of the first result. */
function first(page: Page): Choice {
  const rows = page.results[0]?.points.amplitude ?? [];
  let best = { point: 0, value: -1 };
  rows.forEach((row) =>
    row.forEach((value, point) => {
      if (value !== null && value > best.value) best = { point, value };
    }),
  );
  return { result: 0, point: best.point };
}

function peaks(result: Result): HTMLElement[] {
  if (result.peaks.length === 0) return [];
  const linear = result.peaks.some((peak) => peak.linear);
  const pair = (peak: [number, number] | null) =>
    peak ? [place(peak[0], result.parameter), withUnit(peak[1], "m")] : ["–", "–"];
  const rows = result.peaks.map((peak) => {
    const lower = peak.contact && peak.linear ? `${show(100 * (1 - peak.contact[1] / peak.linear[1]), 3)} %` : "–";
    return [peak.dof, ...pair(peak.contact), ...(linear ? [...pair(peak.linear), lower] : [])];
  });
  const head = ["dof", "at", "amplitude", ...(linear ? ["without contacts at", "amplitude without", "lower by"] : [])];
  const caption = page.results.length > 1 ? result.label : `Peaks of |W_${result.harmonic}|`;
  return [table(caption, head, rows, ["", "number", "number", "number", "number", "number"])];
}

function facts(result: Result): HTMLElement {
  const kind = { sweep: "a sweep", curve: "a response curve", mode: "a nonlinear mode" }[result.kind];
  return table(`${result.label}: ${kind} of ${result.scene}`, [], result.facts.map((fact) => [fact.what, fact.value]));
}

/** Plan and text of every scene that is known. */
function plans(): void {
  const seen = new Set<string>();
  const known = page.results.filter((result) => result.plan);
  if (known.length > 0) {
    const holder = held("Plan: what the scene needs, and what it leaves out");
    holder.classList.add("long");
    known.forEach((result) => {
      const rows = (result.plan ?? []).map((step) => [step.what, step.used ? "used" : "left out", step.why]);
      holder.append(table(known.length > 1 ? result.label : result.scene, ["step", "use", "why"], rows, ["", "word", ""]));
    });
  }
  page.results.forEach((result) => {
    if (!result.scene_text || seen.has(result.scene_text)) return;
    seen.add(result.scene_text);
    const holder = held(`Scene ${result.scene}`);
    holder.classList.add("long");
    holder.append(element("pre", { tabindex: "0", role: "region", "aria-label": "The scene's file" }, result.scene_text));
  });
}

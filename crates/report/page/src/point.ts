// The chosen point: how it is chosen without a mouse, and its numbers.

import type { Page, Result } from "./data";
import { element, table } from "./dom";
import type { Choice } from "./response";
import { place, show, withUnit } from "./words";

export class PointView {
  readonly root = element("div");
  private readonly results = element("select", { name: "result" });
  private readonly slider = element("input", { type: "range", min: "0", name: "point" });
  private readonly wanted = element("input", { type: "number", step: "any", name: "place" });
  private readonly status = element("p", { class: "status", role: "status", "aria-live": "polite" });
  private readonly tables = element("div", { class: "numbers", id: "numbers" });

  constructor(
    private readonly page: Page,
    private choice: Choice,
    private readonly choose: (choice: Choice) => void,
  ) {
    page.results.forEach((result, i) => this.results.append(element("option", { value: String(i) }, result.label)));
    this.results.addEventListener("change", () => this.switchTo(Number(this.results.value)));
    this.slider.addEventListener("input", () => this.go(this.slider.valueAsNumber));
    this.wanted.addEventListener("change", () => this.near(this.wanted.valueAsNumber));
    const step = (text: string, by: number) => {
      const button = element("button", { type: "button" }, text);
      button.addEventListener("click", () => this.go(this.choice.point + by));
      return button;
    };
    const { name, unit } = page.results[0]?.parameter ?? { name: "frequency", unit: "Hz" };
    const result = element("label", {}, "Result", this.results);
    result.hidden = page.results.length < 2;
    this.root.append(
      element(
        "div",
        { class: "controls" },
        result,
        element("label", { class: "wide" }, "Point", this.slider),
        step("‹ previous", -1),
        step("next ›", 1),
        element("label", {}, name, this.wanted, unit),
      ),
      this.status,
      this.tables,
    );
    this.draw();
  }

  mark(choice: Choice): void {
    this.choice = choice;
    this.draw();
  }

  private result(): Result | undefined {
    return this.page.results[this.choice.result];
  }

  private go(point: number): void {
    const last = (this.result()?.points.parameter.length ?? 1) - 1;
    this.choose({ result: this.choice.result, point: Math.min(Math.max(point, 0), last) });
  }

  /** The point nearest to a place; of several the one nearest in the order of the result. */
  private near(wanted: number): void {
    const places = this.result()?.points.parameter ?? [];
    if (!Number.isFinite(wanted)) return this.draw();
    const distance = (i: number) => Math.abs((places[i] ?? Infinity) - wanted);
    const best = places.reduce((best, _, i) => {
      const closer = distance(i) < distance(best);
      const same = distance(i) === distance(best) && Math.abs(i - this.choice.point) < Math.abs(best - this.choice.point);
      return closer || same ? i : best;
    }, 0);
    this.go(best);
  }

  /** Another result at the same place. */
  private switchTo(result: number): void {
    const at = this.result()?.points.parameter[this.choice.point];
    this.choice = { result, point: 0 };
    this.near(at ?? 0);
  }

  private draw(): void {
    const result = this.result();
    if (!result) return;
    const { points } = result;
    const i = this.choice.point;
    const count = points.parameter.length;
    const at = place(points.parameter[i] ?? 0, result.parameter);
    this.results.value = String(this.choice.result);
    this.slider.max = String(count - 1);
    this.slider.value = String(i);
    this.slider.setAttribute("aria-valuetext", `${at}, point ${i + 1} of ${count}`);
    this.wanted.value = String(Number((points.parameter[i] ?? 0).toPrecision(9)));
    this.status.textContent = this.sentence(result, at);
    this.status.classList.toggle("failed", points.status[i] === "failed");
    this.tables.replaceChildren(...this.numbers(result, at));
  }

  private sentence(result: Result, at: string): string {
    const { points } = result;
    const i = this.choice.point;
    const where = this.page.results.length > 1 ? `${result.label}, ${at}` : at;
    if (points.status[i] === "failed") {
      return `${where}: not solved. ${points.reason[i] ?? ""}`;
    }
    const amplitudes = result.dofs.slice(0, 4).map((dof, d) => `${dof} ${withUnit(points.amplitude[d]?.[i], "m")}`);
    const rest = result.dofs.length > 4 ? ", …" : "";
    const states = result.contacts.slice(0, 4).map((contact) => `${contact.name}: ${STATES[contact.state[i] ?? ""] ?? contact.state[i] ?? "–"}`);
    return `${where}: ${amplitudes.join(", ")}${rest}. ${states.length > 0 ? `${states.join("; ")}.` : ""}`;
  }

  private numbers(result: Result, at: string): HTMLElement[] {
    const { points } = result;
    const i = this.choice.point;
    const estimate = (value: number | null | undefined) =>
      value === null || value === undefined ? "no estimate was made" : value === 0 ? "none" : `${show(value, 2)} (relative, an estimate)`;
    const rows: string[][] = [
      ["status", points.status[i] ?? ""],
      ["number in the result", `${i + 1} of ${points.parameter.length}`],
    ];
    if (result.parameter.name !== "frequency") rows.push(["frequency", `${show(points.frequency[i], 7)} Hz`]);
    const reason = points.reason[i];
    if (reason) rows.push(["why not solved", reason]);
    rows.push(["harmonics", String(points.harmonics[i] ?? "")], ["Newton steps", String(points.iterations[i] ?? "")]);
    if (points.status[i] !== "failed") {
      rows.push(
        ["residual (relative to the excitation)", show(points.residual[i], 2)],
        ["truncation error", estimate(points.truncation[i])],
        ["sampling error", estimate(points.sampling[i])],
      );
    }
    const solutions = points.solutions[i];
    if (solutions !== null && solutions !== undefined) rows.push(["solutions at this frequency", String(solutions)]);
    const stable = points.stable[i];
    if (stable !== null && stable !== undefined) rows.push(["stability", stable ? "stable" : "unstable"]);
    if (points.fold[i]) rows.push(["fold", "the curve turns back here"]);
    const damping = points.damping_ratio[i];
    if (damping !== null && damping !== undefined) rows.push(["damping ratio", show(damping)]);
    const made = [table(`At ${at}`, [], rows)];
    if (points.status[i] === "failed") return made;

    const linear = points.linear;
    const dofs = result.dofs.map((dof, d) => [
      dof,
      withUnit(points.amplitude[d]?.[i], "m"),
      show(points.phase[d]?.[i]),
      ...(linear ? [withUnit(linear[d]?.[i], "m")] : []),
    ]);
    const columns = ["dof", `amplitude |W_${result.harmonic}|`, "phase in rad", ...(linear ? ["without contacts"] : [])];
    made.push(table("Displacements", columns, dofs, ["", "number", "number", "number"]));
    const contacts = result.contacts.flatMap((contact) =>
      contact.amplitude.map((row, d) => [
        [contact.name, contact.directions[d]].filter(Boolean).join(", "),
        d === 0 ? (STATES[contact.state[i] ?? ""] ?? contact.state[i] ?? "–") : "",
        withUnit(row[i], "m"),
        d === 0 ? withUnit(contact.dissipation[i], "J") : "",
        d === 0 ? (contact.extrapolated[i] ? "yes: the law is extrapolated" : "no") : "",
      ]),
    );
    if (contacts.length > 0) {
      made.push(
        table(
          "Contacts",
          ["contact", "state", "amplitude (half the range)", "dissipation a period", "beyond what was measured"],
          contacts,
          ["", "word", "number", "number", ""],
        ),
      );
    }
    return made;
  }
}

const STATES: Record<string, string> = {
  stick: "sticks",
  slip: "slips",
  mixed: "sticks and slips",
  held: "held at rest",
  apart: "apart",
};

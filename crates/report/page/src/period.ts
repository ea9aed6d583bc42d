// One period of the chosen point: loops of the contacts, waveforms, harmonics.

import { Chart, type Colours, type Option, axis, dash, decades, legend, tip } from "./chart";
import { type Page, type Period, Periods, type Result } from "./data";
import { element } from "./dom";
import type { Choice } from "./response";
import { largest, place, show, unitFor } from "./words";

/** A period and the result it is from. */
interface Shown {
  result: Result;
  index: number;
  period: Period;
}

const WITHOUT_MOTION = "There is no motion to show.";

export class PeriodView {
  readonly root = element("div");
  private readonly periods: Periods[];
  private readonly panels = element("div", { class: "panels" });
  private readonly note = element("p");
  private readonly contacts: HTMLSelectElement;
  private readonly picker: HTMLElement;
  private charts: Chart[] = [];
  /** What the charts show: contact and directions. */
  private layout = "";
  private shown: Shown[] = [];

  constructor(
    private readonly page: Page,
    private choice: Choice,
    parent: HTMLElement,
  ) {
    parent.append(this.root);
    this.periods = page.results.map((result) => new Periods(result));
    this.contacts = element("select", { name: "contact" });
    this.contacts.addEventListener("change", () => this.draw());
    this.picker = element("div", { class: "controls" }, element("label", {}, "Contact", this.contacts));
    this.root.append(this.note, this.picker, this.panels);
    this.offer();
    this.draw();
  }

  mark(choice: Choice): void {
    const other = choice.result !== this.choice.result;
    this.choice = choice;
    if (other) this.offer();
    this.draw();
  }

  private active(): Result | undefined {
    return this.page.results[this.choice.result];
  }

  /** The contacts of the result. */
  private offer(): void {
    const before = this.contacts.value;
    const names = this.active()?.contacts.map((contact) => contact.name) ?? [];
    this.contacts.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
    if (names.includes(before)) this.contacts.value = before;
    this.picker.hidden = names.length < 2;
  }

  /** The chosen period, and those of the other results at the nearest place. */
  private find(): Shown[] {
    const active = this.active();
    if (!active) return [];
    const at = active.points.parameter[this.choice.point] ?? 0;
    const amplitude = active.points.amplitude[0]?.[this.choice.point] ?? 0;
    const order = [this.choice.result, ...this.page.results.keys()].filter((index, i, all) => all.indexOf(index) === i);
    return order.flatMap((index) => {
      const result = this.page.results[index];
      if (!result) return [];
      let wanted = this.choice.point;
      if (index !== this.choice.result) {
        const { parameter, amplitude: rows } = result.points;
        const distance = (point: number): [number, number] => [
          Math.abs((parameter[point] ?? Infinity) - at),
          Math.abs((rows[0]?.[point] ?? 0) - amplitude),
        ];
        // At a fold there are several; the one whose amplitude is nearest.
        wanted = result.motions.points.reduce((best, point) => {
          const [a, b] = [distance(point), distance(best)];
          return a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]) ? point : best;
        }, result.motions.points[0] ?? 0);
      } else if (result.points.status[wanted] === "failed") {
        return [];
      }
      const period = this.periods[index]?.near(wanted);
      return period ? [{ result, index, period }] : [];
    });
  }

  private draw(): void {
    this.shown = this.find();
    const active = this.active();
    const own = this.shown.find((shown) => shown.index === this.choice.result);
    this.note.textContent = this.sentence(active, own);
    const contact = active?.contacts.find((contact) => contact.name === this.contacts.value);
    const directions = contact ? (contact.directions.length > 0 ? contact.directions : [""]) : [];
    const layout = own ? JSON.stringify([contact?.name, directions, this.choice.result]) : "";
    if (layout !== this.layout) {
      this.charts.forEach((chart) => chart.remove());
      this.charts = [];
      this.layout = layout;
      if (own) this.make(contact?.name ?? "", directions);
    } else {
      this.charts.forEach((chart) => chart.draw());
    }
  }

  private sentence(active: Result | undefined, own: Shown | undefined): string {
    if (!active) return WITHOUT_MOTION;
    const parts = [];
    if (!own) parts.push(active.points.status[this.choice.point] === "failed" ? "This point was not solved: it has no motion to show." : WITHOUT_MOTION);
    else if (own.period.point !== this.choice.point) {
      const at = active.points.parameter[own.period.point] ?? 0;
      parts.push(`Shown is the nearest point with a kept period, ${place(at, active.parameter)}.`);
    }
    if (active.motions.note) parts.push(active.motions.note);
    if (own && active.contacts.length > 0) {
      parts.push(
        active.motions.force === "law"
          ? "Forces are those of the contact laws at the motion of the result."
          : "Forces are the sum of the harmonics in the result, not the contact law's own; for those name the scene (--scene).",
      );
    }
    return parts.join(" ");
  }

  private make(contact: string, directions: string[]): void {
    const add = (name: string, option: (colours: Colours) => Option, text: () => string) =>
      this.charts.push(new Chart(name, false, option, text, this.panels));
    directions.forEach((direction) => {
      const name = ["loop", direction].filter(Boolean).join("-");
      add(name, (colours) => this.loop(colours, contact, direction), () => this.loopText(contact, direction));
    });
    if (directions.length > 2) {
      add("path", (colours) => this.path(colours, contact), () => `Path of contact ${contact} in its plane over one period: displacement in one tangential direction over that in the other.`);
    }
    add("displacement", (colours) => this.displacement(colours), () => this.waveText());
    if (directions.length > 0) {
      add("force", (colours) => this.force(colours, contact), () => `Force of contact ${contact} over one period${directions.length > 1 ? ", one line a direction" : ""}.`);
    }
    add("harmonics", (colours) => this.harmonics(colours), () => "Amplitude of each harmonic of the displacements, logarithmic.");
  }

  private direction(shown: Shown, contact: string, direction: string) {
    return shown.period.directions.find(
      (entry) => shown.result.contacts[entry.contact]?.name === contact && entry.name === direction,
    );
  }

  /** The name of a line, with that of its result where there are several. */
  private label(shown: Shown, name: string): string {
    return this.page.results.length < 2 ? name : `${shown.result.label}: ${name}`;
  }

  /** The name of a loop: with several results that of its own and the place it is from. */
  private loopLabel(shown: Shown, title: string): string {
    const at = place(shown.result.points.parameter[shown.period.point] ?? 0, shown.result.parameter);
    return this.page.results.length < 2 ? title : `${shown.result.label}, ${at}`;
  }

  private colour(colours: Colours, shown: Shown, line: number): string | undefined {
    const several = this.page.results.length > 1;
    return colours.series[(several ? shown.index : line) % colours.series.length];
  }

  private loop(colours: Colours, contact: string, direction: string): Option {
    const found = this.shown.flatMap((shown) => {
      const entry = this.direction(shown, contact, direction);
      return entry ? [{ shown, entry }] : [];
    });
    const x = unitFor(largest(found.flatMap(({ entry }) => [...entry.displacement])), "m");
    const y = unitFor(largest(found.flatMap(({ entry }) => [...entry.force])), "N");
    const title = [contact, direction].filter(Boolean).join(", ");
    return {
      ...this.plain(colours, this.page.results.length > 1 ? "lines" : "title"),
      xAxis: axis(colours, `relative displacement in ${x.name}`, { nameGap: 26, scale: true }),
      yAxis: axis(colours, `force in ${y.name}`, { scale: true }),
      series: found.map(({ shown, entry }, i) => ({
        name: this.loopLabel(shown, title),
        type: "line",
        symbol: "none",
        itemStyle: { color: this.colour(colours, shown, 0) },
        lineStyle: { color: this.colour(colours, shown, 0), width: 2, type: dash(i) },
        data: closed(entry.displacement, entry.force, x.factor, y.factor),
      })),
    };
  }

  private path(colours: Colours, contact: string): Option {
    const found = this.shown.flatMap((shown) => {
      const [first, second] = ["tangential1", "tangential2"].map((name) => this.direction(shown, contact, name));
      return first && second ? [{ shown, first, second }] : [];
    });
    const unit = unitFor(largest(found.flatMap(({ first, second }) => [...first.displacement, ...second.displacement])), "m");
    return {
      ...this.plain(colours, this.page.results.length > 1 ? "lines" : "title"),
      xAxis: axis(colours, `tangential1 in ${unit.name}`, { nameGap: 26, scale: true }),
      yAxis: axis(colours, `tangential2 in ${unit.name}`, { scale: true }),
      series: found.map(({ shown, first, second }, i) => ({
        name: this.loopLabel(shown, `${contact}, path`),
        type: "line",
        symbol: "none",
        itemStyle: { color: this.colour(colours, shown, 0) },
        lineStyle: { color: this.colour(colours, shown, 0), width: 2, type: dash(i) },
        data: closed(first.displacement, second.displacement, unit.factor, unit.factor),
      })),
    };
  }

  private displacement(colours: Colours): Option {
    const unit = unitFor(largest(this.shown.flatMap((shown) => shown.period.displacement.flatMap((row) => [...row]))), "m");
    return this.wave(
      colours,
      `displacement in ${unit.name}`,
      this.shown.flatMap((shown) =>
        shown.period.displacement.map((row, dof) => ({ shown, name: shown.result.dofs[dof] ?? "", row, line: dof })),
      ),
      unit.factor,
    );
  }

  private force(colours: Colours, contact: string): Option {
    const rows = this.shown.flatMap((shown) =>
      shown.period.directions
        .filter((entry) => shown.result.contacts[entry.contact]?.name === contact)
        .map((entry, line) => ({ shown, name: entry.name || contact, row: entry.force, line })),
    );
    const unit = unitFor(largest(rows.flatMap(({ row }) => [...row])), "N");
    return this.wave(colours, `force in ${unit.name}`, rows, unit.factor);
  }

  private wave(
    colours: Colours,
    name: string,
    rows: { shown: Shown; name: string; row: Float32Array; line: number }[],
    factor: number,
  ): Option {
    return {
      ...this.plain(colours, "lines"),
      xAxis: axis(colours, "part of a period", { nameGap: 26, min: 0, max: 1 }),
      yAxis: axis(colours, name, { scale: true }),
      series: rows.map(({ shown, name, row, line }) => ({
        name: this.label(shown, name),
        type: "line",
        symbol: "none",
        itemStyle: { color: this.colour(colours, shown, line) },
        lineStyle: { color: this.colour(colours, shown, line), width: 2, type: dash(line) },
        data: Array.from({ length: row.length + 1 }, (_, i) => [i / row.length, (row[i % row.length] ?? 0) / factor]),
      })),
    };
  }

  private harmonics(colours: Colours): Option {
    const rows = this.shown.flatMap((shown) =>
      shown.period.harmonics.map((row, dof) => ({ shown, dof, row, orders: shown.result.motions.orders })),
    );
    const unit = unitFor(largest(rows.flatMap(({ row }) => [...row])), "m");
    const orders = [...new Set(rows.flatMap(({ orders }) => orders))].sort((a, b) => a - b);
    return {
      ...this.plain(colours, "marks"),
      xAxis: axis(colours, "harmonic", { type: "category", data: orders.map(String), nameGap: 26 }),
      yAxis: axis(colours, `amplitude in ${unit.name}`, {
        ...decades(rows.flatMap(({ row }) => [...row].map((value) => value / unit.factor))),
        axisLabel: { color: colours.ink, hideOverlap: true, formatter: (value: number) => show(value, 2) },
      }),
      series: rows.map(({ shown, dof, row, orders: own }) => ({
        name: this.label(shown, shown.result.dofs[dof] ?? ""),
        type: "scatter",
        symbol: ["circle", "triangle", "rect", "diamond"][dof % 4],
        symbolSize: 9,
        itemStyle: { color: this.colour(colours, shown, dof) },
        data: orders.map((order) => {
          const value = row[own.indexOf(order)];
          return value !== undefined && value > 0 ? value / unit.factor : null;
        }),
      })),
    };
  }

  /** A legend: of lines, of marks, or, where there is one line, its name as a title. */
  private plain(colours: Colours, kind: "lines" | "marks" | "title"): Option {
    const more = {
      lines: {},
      marks: { itemStyle: { opacity: 1 }, itemWidth: 14 },
      title: { icon: "none", itemWidth: 0, textStyle: { color: colours.ink, fontWeight: 600 } },
    }[kind];
    return {
      legend: legend(colours, more),
      tooltip: {
        trigger: "item",
        ...tip(colours, (found) => {
          const { seriesName, value } = found as { seriesName: string; value: number | [number, number] };
          return [seriesName, Array.isArray(value) ? value.map((x) => show(x)).join(", ") : show(value)];
        }),
      },
    };
  }

  private loopText(contact: string, direction: string): string {
    const own = this.shown[0];
    const entry = own && this.direction(own, contact, direction);
    if (!own || !entry) return `Loop of contact ${contact}.`;
    const at = place(own.result.points.parameter[own.period.point] ?? 0, own.result.parameter);
    const name = [contact, direction].filter(Boolean).join(", ");
    const [w, f] = [entry.displacement, entry.force];
    const range = (row: Float32Array, basic: string) => {
      const unit = unitFor(largest(row), basic);
      return `${show(least(row) / unit.factor, 4)} to ${show(most(row) / unit.factor, 4)} ${unit.name}`;
    };
    return `Loop of ${name} at ${at}: force from ${range(f, "N")} over relative displacement from ${range(w, "m")}.`;
  }

  private waveText(): string {
    const own = this.shown[0];
    if (!own) return WITHOUT_MOTION;
    const at = place(own.result.points.parameter[own.period.point] ?? 0, own.result.parameter);
    return `Displacements of the dofs over one period at ${at}.`;
  }
}

const least = (row: Float32Array) => row.reduce((a, b) => Math.min(a, b), Infinity);
const most = (row: Float32Array) => row.reduce((a, b) => Math.max(a, b), -Infinity);

/** A closed curve through all instants. */
function closed(x: Float32Array, y: Float32Array, unitX: number, unitY: number): [number, number][] {
  return Array.from({ length: x.length + 1 }, (_, i) => [
    (x[i % x.length] ?? 0) / unitX,
    (y[i % y.length] ?? 0) / unitY,
  ]);
}

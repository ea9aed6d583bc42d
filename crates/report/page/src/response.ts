// The response: amplitudes of the output dofs over frequency (or over another entry), all results over one axis.

import { Chart, type Colours, ON_PAPER, type Option, axis, dash, decades, legend, markEntry, onPaper, tip } from "./chart";
import type { Maybe, Page } from "./data";
import { element } from "./dom";
import { largest, place, show, unitFor } from "./words";

/** A point of a result. */
export interface Choice {
  result: number;
  point: number;
}

const CROSS = "path://M-5,-4L-4,-5L0,-1L4,-5L5,-4L1,0L5,4L4,5L0,1L-4,5L-5,4L-1,0Z";

export class Response {
  readonly root: HTMLElement;
  private readonly chart: Chart;
  private logarithmic = true;
  private range: Maybe<[number, number]> = null;
  private readonly ends: [HTMLInputElement, HTMLInputElement];
  private readonly unit;

  constructor(
    private readonly page: Page,
    private choice: Choice,
    private readonly choose: (choice: Choice) => void,
    parent: HTMLElement,
  ) {
    this.unit = unitFor(largest(page.results.flatMap((result) => result.points.amplitude.flat())), "m");
    this.root = element("div");
    parent.append(this.root);
    this.ends = [this.end("from", 0), this.end("to", 1)];
    this.root.append(this.controls());
    this.chart = new Chart(
      "response",
      true,
      (colours) => this.option(colours),
      () => this.text(),
      this.root,
    );
    this.chart.view.on("datazoom", () => this.zoomed());
    this.chart.view.getZr().on("click", (event) => this.clicked(event.offsetX, event.offsetY));
    this.root.append(
      element(
        "p",
        { class: "hint" },
        "Click on a curve to choose a point. To zoom, drag the handles below the picture, hold Ctrl and turn the wheel, or \
write the ends of the range.",
      ),
    );
    this.showEnds();
  }

  /** Marks another point. */
  mark(choice: Choice): void {
    this.choice = choice;
    this.chart.draw();
  }

  private controls(): HTMLElement {
    const scale = (name: string, logarithmic: boolean) => {
      const input = element("input", { type: "radio", name: "scale", value: name });
      input.checked = logarithmic === this.logarithmic;
      input.addEventListener("change", () => {
        this.logarithmic = logarithmic;
        this.chart.draw();
      });
      return element("label", {}, input, name);
    };
    const whole = element("button", { type: "button" }, "whole range");
    whole.addEventListener("click", () => this.zoom(null));
    const [from, to] = this.ends;
    const { unit } = this.parameter();
    return element(
      "div",
      { class: "controls" },
      element("fieldset", {}, element("legend", {}, "Amplitude"), scale("logarithmic", true), scale("linear", false)),
      element("label", {}, "from", from, unit),
      element("label", {}, "to", to, unit),
      whole,
    );
  }

  private end(name: string, index: 0 | 1): HTMLInputElement {
    const input = element("input", { type: "number", step: "any", name });
    input.addEventListener("change", () => {
      const range: [number, number] = this.range ? [...this.range] : this.extent();
      if (!Number.isFinite(input.valueAsNumber)) return this.showEnds();
      range[index] = input.valueAsNumber;
      if (range[0] < range[1]) this.zoom(range);
      else this.showEnds();
    });
    return input;
  }

  private parameter() {
    return this.page.results[0]?.parameter ?? { name: "frequency", unit: "Hz" };
  }

  private extent(): [number, number] {
    const all = this.page.results.flatMap((result) => result.points.parameter);
    return [all.reduce((a, b) => Math.min(a, b), Infinity), all.reduce((a, b) => Math.max(a, b), -Infinity)];
  }

  private zoom(range: Maybe<[number, number]>): void {
    const [startValue, endValue] = range ?? this.extent();
    this.chart.view.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, startValue, endValue });
  }

  /** Takes the range from the picture; amplitudes fill its height. */
  private zoomed(): void {
    const zoom = (this.chart.view.getOption().dataZoom as { startValue: number; endValue: number }[])[0];
    if (!zoom) return;
    const whole = this.extent();
    const range: [number, number] = [zoom.startValue, zoom.endValue];
    this.range = range[0] <= whole[0] && range[1] >= whole[1] ? null : range;
    this.showEnds();
    this.chart.draw();
  }

  private showEnds(): void {
    const range = this.range ?? this.extent();
    this.ends.forEach((input, i) => {
      input.value = String(Number((range[i] ?? 0).toPrecision(7)));
    });
  }

  /** Chooses the point nearest to a place in the picture. */
  private clicked(x: number, y: number): void {
    if (!this.chart.view.containPixel({ gridIndex: 0 }, [x, y])) return;
    const shown = (this.chart.view.getOption().legend as { selected: Record<string, boolean> }[])[0]?.selected ?? {};
    let nearest: Maybe<Choice> = null;
    let least = Infinity;
    this.each((name, result, dof) => {
      if (shown[name] === false) return;
      const { parameter, amplitude } = result.points;
      parameter.forEach((place, point) => {
        const value = this.scaled(amplitude[dof]?.[point] ?? null);
        if (value === null) return;
        const at = this.chart.view.convertToPixel({ gridIndex: 0 }, [place, value]) as number[];
        const distance = Math.hypot((at[0] ?? 0) - x, (at[1] ?? 0) - y);
        if (distance < least) {
          least = distance;
          nearest = { result: this.page.results.indexOf(result), point };
        }
      });
    });
    if (nearest) this.choose(nearest);
  }

  private each(visit: (name: string, result: Page["results"][number], dof: number, index: number) => void): void {
    const several = this.page.results.length > 1;
    this.page.results.forEach((result, index) =>
      result.dofs.forEach((dof, i) => visit(several ? `${result.label}: ${dof}` : dof, result, i, index)),
    );
  }

  /** An amplitude in the unit of the axis; what a logarithm does not have is left out. */
  private scaled(amplitude: Maybe<number>): Maybe<number> {
    if (amplitude === null || (this.logarithmic && amplitude <= 0)) return null;
    return amplitude / this.unit.factor;
  }

  private option(colours: Colours): Option {
    const several = this.page.results.length > 1;
    const series: Option[] = [];
    const shownInLegend: (string | Option)[] = [];
    const add = (entry: Option & { name: string; type: string }) => {
      series.push(entry);
      shownInLegend.push(entry.type === "line" ? entry.name : markEntry(entry.name));
    };
    const line = (name: string, data: [number, Maybe<number>][], style: Option) =>
      add({ name, type: "line", data, symbol: data.length < 60 ? "circle" : "none", symbolSize: 4, ...style });
    this.each((name, result, dof, index) => {
      const colour = colours.series[(several ? index : dof) % colours.series.length];
      const at = (row: Maybe<number>[] | undefined) =>
        result.points.parameter.map((place, i): [number, Maybe<number>] => [place, this.scaled(row?.[i] ?? null)]);
      line(name, at(result.points.amplitude[dof]), {
        itemStyle: { color: colour },
        lineStyle: { color: colour, width: 2, type: dash(dof) },
      });
      // Results of one scene share it.
      const first = this.page.results.findIndex((other) => other.scene === result.scene && other.points.linear);
      if (result.points.linear && first === index) {
        line(`${several ? `${result.scene}: ` : ""}${result.dofs[dof] ?? ""} without contacts`, at(result.points.linear[dof]), {
          symbol: "none",
          itemStyle: { color: colours.muted },
          lineStyle: { color: colours.muted, width: 1, type: dash(dof + 1) },
        });
      }
    });
    const marks = (name: string, style: Option, wanted: (result: Page["results"][number], point: number) => boolean) => {
      const data: [number, number][] = [];
      this.each((_, result, dof) =>
        result.points.parameter.forEach((place, point) => {
          const value = this.scaled(result.points.amplitude[dof]?.[point] ?? null);
          if (value !== null && wanted(result, point)) data.push([place, value]);
        }),
      );
      if (data.length > 0) add({ name, type: "scatter", data, z: 4, ...style });
    };
    marks("folds", { symbol: "diamond", symbolSize: 9, itemStyle: { color: colours.ink } }, (result, point) => result.points.fold[point] === true);
    marks(
      "unstable",
      { symbol: "circle", symbolSize: 7, itemStyle: { color: colours.paper, borderColor: colours.warn, borderWidth: 1.5 } },
      (result, point) => result.points.stable[point] === false,
    );
    const others = this.page.results.flatMap((result) =>
      result.points.others.flatMap(({ point, amplitude }) =>
        amplitude.map((value) => [result.points.parameter[point], this.scaled(value)]).filter(([, value]) => value !== null),
      ),
    );
    if (others.length > 0) {
      add({ name: "other solutions", type: "scatter", data: others, symbol: "triangle", symbolSize: 7, itemStyle: { color: colours.muted }, z: 4 });
    }
    const failed = this.page.results.flatMap((result) =>
      result.points.parameter.filter((_, point) => result.points.status[point] === "failed").map((place) => [place, 0.03]),
    );
    if (failed.length > 0) {
      add({
        name: "not solved",
        type: "scatter",
        yAxisIndex: 1,
        data: failed,
        symbol: CROSS,
        symbolSize: 11,
        itemStyle: { color: colours.warn },
        z: 5,
      });
    }
    series.push(this.chosen(colours));
    const { name, unit } = this.parameter();
    const harmonics = new Set(this.page.results.map((result) => result.harmonic));
    const index = harmonics.size === 1 ? [...harmonics][0] : "k";
    // On paper all names are seen at once, in as many lines as they need.
    const letters = shownInLegend.reduce((sum, entry) => sum + (typeof entry === "string" ? entry : String(entry.name)).length, 0);
    const lines = onPaper() ? Math.ceil((7.5 * letters + 52 * shownInLegend.length) / ON_PAPER.tall) : 1;
    return {
      grid: { left: 12, right: 24, top: 22 + 22 * lines, bottom: onPaper() ? 12 : 44, outerBoundsMode: "same", outerBoundsContain: "all" },
      xAxis: axis(colours, unit ? `${name} in ${unit}` : name, { nameGap: 26, min: "dataMin", max: "dataMax" }),
      yAxis: [
        axis(colours, `amplitude |W_${index}| in ${this.unit.name}`, {
          ...this.height(),
          axisLabel: { color: colours.ink, formatter: (value: number) => show(value, 3) },
        }),
        { type: "value", show: false, min: 0, max: 1 },
      ],
      legend: legend(colours, { data: shownInLegend, type: onPaper() ? "plain" : "scroll" }),
      tooltip: {
        trigger: "axis",
        axisPointer: { type: "line", lineStyle: { color: colours.muted } },
        ...tip(colours, (found) => this.lines(found)),
      },
      dataZoom: [
        { type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl", moveOnMouseWheel: false, ...this.shownRange() },
        {
          type: "slider",
          show: !onPaper(),
          filterMode: "none",
          bottom: 8,
          height: 22,
          showDataShadow: false,
          borderColor: colours.line,
          fillerColor: `${colours.accent}33`,
          handleStyle: { color: colours.paper, borderColor: colours.accent },
          moveHandleStyle: { color: colours.muted },
          textStyle: { color: colours.ink },
          brushSelect: false,
          labelFormatter: (value: number) => show(value, 5),
          ...this.shownRange(),
        },
      ],
      series,
    };
  }

  /** Scale and ends of the axis of amplitudes. */
  private height(): Option {
    const zoomed = this.vertical();
    const [min, max] = zoomed ?? [null, null];
    if (zoomed || !this.logarithmic) return { type: this.logarithmic ? "log" : "value", min, max, interval: null };
    const rows = this.page.results.flatMap((result) => [...result.points.amplitude, ...(result.points.linear ?? [])]);
    return decades(rows.flat().map((value) => this.scaled(value)));
  }

  private shownRange(): Option {
    const [startValue, endValue] = this.range ?? this.extent();
    return { startValue, endValue };
  }

  /** The chosen point on the curves of its result. */
  private chosen(colours: Colours): Option {
    const result = this.page.results[this.choice.result];
    const at = result?.points.parameter[this.choice.point];
    const rows = result?.points.amplitude ?? [];
    const values = rows.map((row) => this.scaled(row[this.choice.point] ?? null));
    return {
      name: "chosen point",
      type: "scatter",
      z: 6,
      symbol: "circle",
      symbolSize: 12,
      silent: true,
      itemStyle: { color: "transparent", borderColor: colours.ink, borderWidth: 2.5 },
      data: at === undefined ? [] : values.filter((value) => value !== null).map((value) => [at, value]),
      markLine: {
        silent: true,
        symbol: "none",
        label: { show: false },
        lineStyle: { color: colours.ink, type: "solid", width: 1, opacity: 0.6 },
        data: at === undefined ? [] : [{ xAxis: at }],
      },
    };
  }

  /** The amplitudes between which a zoomed picture shows; null fits all. */
  private vertical(): Maybe<[number, number]> {
    if (!this.range) return null;
    const [from, to] = this.range;
    let [least, most] = [Infinity, 0];
    this.each((_, result, dof) => {
      const { parameter, amplitude } = result.points;
      parameter.forEach((place, i) => {
        // The neighbours of the range too, whose lines enter it.
        const near = [parameter[i - 1] ?? place, place, parameter[i + 1] ?? place];
        const value = this.scaled(amplitude[dof]?.[i] ?? null);
        if (value === null || Math.max(...near) < from || Math.min(...near) > to) return;
        [least, most] = [Math.min(least, value), Math.max(most, value)];
      });
    });
    if (!(most > 0) || !(least < most)) return null;
    return this.logarithmic ? [least / 1.1, most * 1.1] : [Math.max(0, least - 0.05 * (most - least)), most + 0.05 * (most - least)];
  }

  private lines(found: unknown): string[] {
    const entries = (Array.isArray(found) ? found : [found]) as { seriesName: string; value: [number, Maybe<number>] }[];
    const curves = entries.filter((entry) => !["chosen point", "not solved"].includes(entry.seriesName));
    const first = entries[0];
    if (!first) return [];
    const lines = curves.map((entry) => `${entry.seriesName}: ${entry.value[1] === null ? "–" : `${show(entry.value[1])} ${this.unit.name}`}`);
    const failed = entries.some((entry) => entry.seriesName === "not solved");
    return [place(first.value[0], this.parameter()), ...lines, ...(failed ? ["not solved"] : [])];
  }

  private text(): string {
    const { name, unit } = this.parameter();
    const [from, to] = this.range ?? this.extent();
    const span = `from ${show(from)} to ${show(to)} ${unit}`.trim();
    const highest: string[] = [];
    this.each((label, result, dof) => {
      let best = -1;
      result.points.amplitude[dof]?.forEach((value, i, row) => {
        if (value !== null && value > (row[best] ?? -1)) best = i;
      });
      const value = result.points.amplitude[dof]?.[best];
      const at = result.points.parameter[best];
      if (value !== null && value !== undefined && at !== undefined) {
        highest.push(`${label} at most ${show(value / this.unit.factor, 4)} ${this.unit.name} at ${place(at, result.parameter)}`);
      }
    });
    return `Amplitude over ${name}, ${span}: ${highest.slice(0, 6).join("; ")}${highest.length > 6 ? "; …" : ""}.`;
  }
}

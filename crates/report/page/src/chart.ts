// One picture: an ECharts chart in SVG, with a text beside it, in the colours of the page.

import { LineChart, ScatterChart } from "echarts/charts";
import {
  DataZoomComponent,
  GridComponent,
  LegendComponent,
  MarkLineComponent,
  TooltipComponent,
} from "echarts/components";
import * as echarts from "echarts/core";
import { SVGRenderer } from "echarts/renderers";
import { element } from "./dom";

echarts.use([
  LineChart,
  ScatterChart,
  DataZoomComponent,
  GridComponent,
  LegendComponent,
  MarkLineComponent,
  TooltipComponent,
  SVGRenderer,
]);

/** Options of ECharts; what the tree-shaken build has is known to this module alone. */
export type Option = echarts.EChartsCoreOption;

export interface Colours {
  paper: string;
  ink: string;
  muted: string;
  line: string;
  grid: string;
  accent: string;
  warn: string;
  /** Told apart by all common kinds of colour vision (Okabe and Ito), dark enough or light enough for the paper. */
  series: string[];
}

const LIGHT = ["#0072b2", "#d55e00", "#00795a", "#a4457f", "#7a5c00", "#2b2b2b"];
const DARK = ["#56b4e9", "#ff9d5c", "#2fd0a0", "#e39ac6", "#f0e442", "#d0d4d9"];
const DASHES = ["solid", "dashed", "dotted", [9, 3, 2, 3], [14, 4]] as const;

/** How the lines of a picture differ beside their colour. */
export function dash(index: number): string | number[] {
  const found = DASHES[index % DASHES.length] ?? "solid";
  return typeof found === "string" ? found : [...found];
}

const dark = matchMedia("(prefers-color-scheme: dark)");
const print = matchMedia("print");
/** Told by the browser before `print` matches. */
let printing = false;

/** On paper nothing can be turned, dragged or paged. */
export const onPaper = (): boolean => printing || print.matches;

export function colours(): Colours {
  const style = getComputedStyle(document.documentElement);
  const value = (name: string) => style.getPropertyValue(`--${name}`).trim();
  const paper = onPaper();
  return {
    paper: paper ? "#ffffff" : value("paper"),
    ink: paper ? "#000000" : value("ink"),
    muted: paper ? "#424a52" : value("muted"),
    line: paper ? "#b0b7bf" : value("line"),
    grid: paper ? "#dde1e5" : value("grid"),
    accent: paper ? "#00568f" : value("accent"),
    warn: paper ? "#9a3c00" : value("warn"),
    series: dark.matches && !paper ? DARK : LIGHT,
  };
}

/** Widths on paper in px: of a picture alone, and of one beside another. */
export const ON_PAPER = { tall: 690, small: 335 };

export class Chart {
  readonly figure: HTMLElement;
  readonly view: echarts.ECharts;
  private readonly holder: HTMLElement;
  private readonly caption: HTMLElement;

  constructor(
    readonly name: string,
    private readonly tall: boolean,
    private readonly option: (colours: Colours) => Option,
    private readonly text: () => string,
    parent: HTMLElement,
  ) {
    this.holder = element("div", { class: tall ? "chart tall" : "chart", role: "img", id: `chart-${name}` });
    // The same text, for those who see the picture.
    this.caption = element("figcaption", { "aria-hidden": "true" });
    this.figure = element("figure", {}, this.holder, this.caption);
    parent.append(this.figure);
    this.view = echarts.init(this.holder, null, { renderer: "svg" });
    new ResizeObserver(() => this.fit()).observe(this.holder);
    charts.add(this);
    this.draw();
  }

  /** Draws anew: other data, other colours. */
  draw(): void {
    const chosen = colours();
    this.view.setOption({ ...frame(chosen), ...this.option(chosen) }, { replaceMerge: ["series"] });
    const text = this.text();
    this.holder.setAttribute("aria-label", text);
    this.caption.textContent = text;
  }

  fit(): void {
    if (onPaper()) this.view.resize({ width: this.tall ? ON_PAPER.tall : ON_PAPER.small });
    else this.view.resize({ width: "auto" });
  }

  remove(): void {
    charts.delete(this);
    this.view.dispose();
    this.figure.remove();
  }
}

const charts = new Set<Chart>();

/** What all pictures share. */
function frame(chosen: Colours): Option {
  return {
    animation: false,
    backgroundColor: "transparent",
    textStyle: { color: chosen.ink, fontFamily: "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif" },
    grid: { left: 12, right: 24, top: 44, bottom: 12, outerBoundsMode: "same", outerBoundsContain: "all" },
    legend: legend(chosen),
  };
}

/** Names of lines and marks; `entries` where they are not all series in their order. */
export function legend(chosen: Colours, more: Option = {}): Option {
  return {
    type: "scroll",
    top: 4,
    textStyle: { color: chosen.ink },
    pageTextStyle: { color: chosen.ink },
    pageIconColor: chosen.accent,
    pageIconInactiveColor: chosen.line,
    inactiveColor: chosen.muted,
    itemWidth: 34,
    // Lines show how they are dashed, without the mark on them.
    itemStyle: { opacity: 0 },
    ...more,
  };
}

/** A mark's entry in a legend of lines. */
export function markEntry(name: string): Option {
  return { name, itemStyle: { opacity: 1 } };
}

/** Ticks of a logarithmic axis over `values`: whole decades, at most six of them named. */
export function decades(values: Iterable<number | null>): Option {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null || !(value > 0)) continue;
    [least, most] = [Math.min(least, value), Math.max(most, value)];
  }
  if (!(least <= most)) return { type: "log" };
  const from = Math.floor(Math.log10(least) + 1e-9);
  const to = Math.max(Math.ceil(Math.log10(most) - 1e-9), from + 1);
  const interval = Math.ceil((to - from) / 6);
  return { type: "log", min: 10 ** (to - interval * Math.ceil((to - from) / interval)), max: 10 ** to, interval };
}

export function axis(chosen: Colours, name: string, more: Option = {}): Option {
  return {
    type: "value",
    name,
    nameLocation: "middle",
    nameTextStyle: { color: chosen.ink },
    axisLabel: { color: chosen.ink, hideOverlap: true },
    axisLine: { show: true, lineStyle: { color: chosen.muted }, onZero: false },
    axisTick: { show: true },
    splitLine: { lineStyle: { color: chosen.grid } },
    ...more,
  };
}

/** A box at the pointer; its lines are texts. */
export function tip(chosen: Colours, lines: (found: unknown) => string[]): Option {
  return {
    backgroundColor: chosen.paper,
    borderColor: chosen.muted,
    textStyle: { color: chosen.ink },
    confine: true,
    transitionDuration: 0,
    formatter: (found: unknown) => {
      const box = element("div", { class: "tip" });
      lines(found).forEach((line) => box.append(element("div", {}, line)));
      return box;
    },
  };
}

function redraw(): void {
  for (const chart of charts) {
    chart.draw();
    chart.fit();
  }
}

dark.addEventListener("change", redraw);
print.addEventListener("change", redraw);
addEventListener("beforeprint", () => {
  printing = true;
  redraw();
});
addEventListener("afterprint", () => {
  printing = false;
  redraw();
});

/** The pictures by name, for scripts that look into the page. */
export function options(): Record<string, Option> {
  return Object.fromEntries([...charts].map((chart) => [chart.name, chart.view.getOption()]));
}

/** Where a value of a picture lies in its element, in px. */
export function pixel(name: string, value: [number, number]): number[] | undefined {
  const chart = [...charts].find((chart) => chart.name === name);
  return chart?.view.convertToPixel({ gridIndex: 0 }, value) as number[] | undefined;
}

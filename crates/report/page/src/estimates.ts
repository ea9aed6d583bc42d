// Error estimates over the axis of the results.

import { Chart, type Colours, type Option, axis, dash, decades, tip } from "./chart";
import type { Maybe, Page } from "./data";
import { element } from "./dom";
import { place, show } from "./words";

const KINDS = [
  ["truncation", "truncation error"],
  ["sampling", "sampling error"],
] as const;

export function estimates(page: Page): HTMLElement {
  const root = element(
    "div",
    {},
    element(
      "p",
      {},
      "Estimates, not bounds: the relative error of the displacements (l2 over all harmonics, the worst of the dofs) from having \
stopped at so many harmonics, and from evaluating the contact forces at samples.",
    ),
  );
  const several = page.results.length > 1;
  const positive = (row: Maybe<number>[]) => row.some((value) => value !== null && value > 0);
  const lines = page.results.flatMap((result, index) =>
    KINDS.filter(([kind]) => positive(result.points[kind])).map(([kind, name], line) => ({
      name: several ? `${result.label}: ${name}` : name,
      index,
      line,
      data: result.points.parameter.map((at, i): [number, Maybe<number>] => {
        const value = result.points[kind][i] ?? null;
        return [at, value !== null && value > 0 ? value : null];
      }),
    })),
  );
  const silent = page.results.filter((result) => !positive(result.points.truncation));
  if (silent.length > 0) {
    const which = several ? ` of ${silent.map((result) => result.label).join(", ")}` : "";
    root.append(
      element(
        "p",
        {},
        `For the points${which} no estimate of the truncation error was made. A sweep with several harmonics makes one, with one \
harmonic where the scene asks for it ("solver": {"estimate": true}); stickslip truncation compares with more harmonics.`,
      ),
    );
  }
  if (lines.length === 0) return root;
  const parameter = page.results[0]?.parameter ?? { name: "frequency", unit: "Hz" };
  const option = (colours: Colours): Option => ({
    xAxis: axis(colours, parameter.unit ? `${parameter.name} in ${parameter.unit}` : parameter.name, { nameGap: 26, min: "dataMin", max: "dataMax" }),
    yAxis: axis(colours, "relative error, estimated", {
      ...decades(lines.flatMap(({ data }) => data.map(([, value]) => value))),
      axisLabel: { color: colours.ink, hideOverlap: true, formatter: (value: number) => show(value, 2) },
    }),
    tooltip: {
      trigger: "axis",
      ...tip(colours, (found) => {
        const entries = found as { seriesName: string; value: [number, Maybe<number>] }[];
        const at = entries[0]?.value[0];
        return [at === undefined ? "" : place(at, parameter), ...entries.map((entry) => `${entry.seriesName}: ${show(entry.value[1], 2)}`)];
      }),
    },
    series: lines.map(({ name, index, line, data }) => {
      const colour = colours.series[(several ? index : line) % colours.series.length];
      return { name, type: "line", data, symbol: data.length < 60 ? "circle" : "none", symbolSize: 4, itemStyle: { color: colour }, lineStyle: { color: colour, width: 2, type: dash(line) } };
    }),
  });
  const worst = lines.map(({ name, data }) => {
    const top = data.reduce((a, b) => ((b[1] ?? 0) > (a[1] ?? 0) ? b : a));
    return `${name} at most ${show(top[1], 2)} at ${place(top[0], parameter)}`;
  });
  const holder = element("div");
  root.append(holder);
  // A picture needs its place in the page before it is drawn.
  queueMicrotask(() => new Chart("estimates", true, option, () => `Estimated errors: ${worst.join("; ")}.`, holder));
  return root;
}

// Elements. Texts are texts: no markup is ever made from data.

type Content = Node | string;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...content: Content[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...content);
  return made;
}

export function section(title: string, ...content: Content[]): HTMLElement {
  return element("section", {}, element("h2", {}, title), ...content);
}

/** What a column holds, where it is more than a text that may be wrapped. */
export type Column = "" | "number" | "word";

export function table(caption: string, head: string[], rows: string[][], columns: Column[] = []): HTMLElement {
  const kind = (i: number): Record<string, string> => (columns[i] ? { class: columns[i] } : {});
  const line = (row: string[]) =>
    element(
      "tr",
      {},
      ...row.map((text, i) =>
        i === 0 ? element("th", { scope: "row", ...kind(i) }, text) : element("td", kind(i), text),
      ),
    );
  const made = element(
    "table",
    {},
    element("caption", {}, caption),
    ...(head.length > 0
      ? [element("thead", {}, element("tr", {}, ...head.map((text, i) => element("th", { scope: "col", ...kind(i) }, text))))]
      : []),
    element("tbody", {}, ...rows.map(line)),
  );
  // What is wider than the window can be reached by keys too.
  return element("div", { class: "scroll", role: "region", "aria-label": caption, tabindex: "0" }, made);
}

// Elements in one call. Text is always text: nothing of a recording is ever read as HTML. Styles go through the object
// model, which a Content-Security-Policy allows where it refuses them as attributes.

type Attributes = Record<string, string | number | boolean | undefined>;
type Child = Node | string | undefined | false;

function filled<E extends HTMLElement | SVGElement>(element: E, attributes: Attributes, children: Child[]): E {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    if (key === "style") element.style.cssText = String(value);
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  for (const child of children) if (child !== undefined && child !== false) element.append(child);
  return element;
}

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  return filled(document.createElement(tag), attributes, children);
}

export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

export type HeadingLevel = 2 | 3 | 4;
export const heading = (level: HeadingLevel, ...children: Child[]): HTMLHeadingElement =>
  h(`h${level}`, {}, ...children);

/** Room to scroll in for what is too wide or too long; the keyboard stops there only where there is something to scroll. */
export function scrolling(name: string, content: HTMLElement): HTMLElement {
  const room = h("div", { class: "table-scroll" }, content);
  new ResizeObserver(() => {
    const needed = room.scrollWidth > room.clientWidth || room.scrollHeight > room.clientHeight;
    for (const [key, value] of [["tabindex", "0"], ["role", "group"], ["aria-label", name]] as const) {
      if (needed) room.setAttribute(key, value);
      else room.removeAttribute(key);
    }
  }).observe(room);
  return room;
}

/** What the cells of a table show, with minus signs that a spreadsheet reads. */
const cellsOf = (table: HTMLTableElement): string[][] =>
  [...table.rows].map((row) => [...row.cells].map((cell) => cell.innerText.replace(/\s+/g, " ").trim().replaceAll("−", "-")));

/** To the clipboard, for a spreadsheet and for a text. */
async function copied(table: HTMLTableElement): Promise<void> {
  const cells = cellsOf(table);
  const plain = cells.map((row) => row.join("\t")).join("\n");
  const rich = h("table", {}, ...cells.map((row) => h("tr", {}, ...row.map((cell) => h("td", {}, cell))))).outerHTML;
  await navigator.clipboard.write([new ClipboardItem({ "text/plain": new Blob([plain], { type: "text/plain" }), "text/html": new Blob([rich], { type: "text/html" }) })]);
}

/** A caption with a button that copies its table. */
export function captionOf(text: string): HTMLElement {
  const button = h("button", { type: "button", class: "copy-table", "aria-label": `Copy table: ${text}` }, "Copy table");
  button.addEventListener("click", async () => {
    const table = button.closest("table") as HTMLTableElement;
    button.textContent = await copied(table).then(() => "Copied", () => "The browser does not allow it");
    setTimeout(() => (button.textContent = "Copy table"), 2000);
  });
  return h("caption", {}, text, " ", button);
}

/** A table with a header row; the first cell of each row is its header. */
export function table(caption: string, head: Child[], rows: Child[][], className = ""): HTMLElement {
  return scrolling(
    caption,
    h(
      "table",
      { class: className, "aria-label": caption },
      captionOf(caption),
      h("thead", {}, h("tr", {}, ...head.map((cell) => (cell === "" ? h("td") : h("th", { scope: "col" }, cell))))),
      h(
        "tbody",
        {},
        ...rows.map((row) =>
          h("tr", {}, ...row.map((cell, k) => (k === 0 ? h("th", { scope: "row" }, cell) : h("td", {}, cell)))),
        ),
      ),
    ),
  );
}

/** Names and what belongs to them. */
export function facts(rows: [string, Child][]): HTMLElement {
  return h(
    "dl",
    { class: "facts" },
    ...rows.filter(([, value]) => value !== undefined && value !== "").map(([name, value]) =>
      h("div", {}, h("dt", {}, name), h("dd", {}, value)),
    ),
  );
}

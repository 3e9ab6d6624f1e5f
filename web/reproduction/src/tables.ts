// A table of the source and ours, cell by cell: ours above, the printed number below it, their difference on demand.
import type { Cell, Column, Exhibit, Table, Value } from "@mbk/shared/documents";
import { h, scrolling } from "@mbk/shared/dom";
import { data, fixed, significant } from "@mbk/shared/format";
import { download } from "@mbk/shared/sheet";
import { shortName, tableFile } from "./document";
import { agreements, chip, hidden, scripted } from "./words";

const wide = 8; // columns, from which on ± stands below its number
const minus = (text: string): string => text.replaceAll("-", "−");

/** As many decimals as the printed number has; those of the column where none is printed. */
export function decimalsOf(cell: Cell, column: Column): number {
  const number = /^[-−+]?\d+(?:\.(\d+))?$/.exec(cell.printed?.trim() ?? "");
  return number ? (number[1]?.length ?? 0) : column.decimals;
}

/** A spread that is not zero is never shown as zero. */
const spreadText = (spread: number, decimals: number): string => {
  const text = fixed(spread, decimals);
  return spread !== 0 && Number(text) === 0 ? significant(spread, 1) : text;
};

function signed(value: number, decimals: number): string {
  const text = fixed(value, decimals);
  if (value !== 0 && /^0(\.0*)?$/.test(text)) return `${value > 0 ? "+" : "−"}${significant(Math.abs(value), 1)}`;
  return value > 0 ? `+${text}` : text;
}

function mark(cell: Cell, erratum: string | undefined): HTMLElement | undefined {
  if (cell.agreement === "not compared") return undefined;
  const { sign, name } = agreements[cell.agreement];
  const linked = cell.agreement === "erratum" && erratum !== undefined;
  // The arrow keys lead from cell to cell, and Enter follows the link of the cell: it needs no stop of its own.
  return linked
    ? h("a", { class: `mark ${name}`, href: `#${erratum}`, tabindex: -1 }, h("span", { "aria-hidden": "true" }, sign), hidden(shortName(erratum)))
    : h("span", { class: `mark ${name}` }, h("span", { "aria-hidden": "true" }, sign), hidden(cell.agreement));
}

function oursOf(cell: Cell, column: Column, name: string): (Node | string)[] {
  if (typeof cell.ours === "string") return [h("span", { class: cell.ours.length > 30 ? "words sentence" : "words" }, ...scripted(cell.ours))];
  if (cell.ours === null) return [h("span", { class: "none" }, h("span", { "aria-hidden": "true" }, "–"), hidden("ours: none"))];
  const decimals = decimalsOf(cell, column);
  const number = [data(cell.ours, fixed(cell.ours, decimals), name)];
  if (cell.spread !== null) number.push(h("span", { class: "half" }, " ± ", data(cell.spread, spreadText(cell.spread, decimals), `${name}-spread`)));
  return number;
}

/** One sentence of everything that is known of a cell, with every digit. */
export function factsOf(table: Table, row: string, column: Column, cell: Cell): string {
  const unit = column.unit ? ` ${column.unit}` : "";
  const every = (value: Value): string => minus(String(value));
  const parts = [typeof cell.ours === "string" ? `ours: ${cell.ours}` : cell.ours === null ? "ours: none" : `ours ${every(cell.ours)}${unit}`];
  if (cell.spread !== null) parts.push(`± ${every(cell.spread)}${table.spread_is ? ` (${table.spread_is})` : ""}`);
  if (cell.range) parts.push(`range from rounding ${every(cell.range[0])} to ${every(cell.range[1])}`);
  parts.push(cell.printed === null ? "nothing printed" : `printed ${minus(cell.printed)}`);
  if (cell.difference !== null) parts.push(`difference ${cell.difference > 0 ? "+" : ""}${every(cell.difference)}`);
  if (cell.agreement !== "not compared") parts.push(cell.agreement === "erratum" && table.erratum ? shortName(table.erratum).toLowerCase() : cell.agreement);
  return `${row}, ${column.name}: ${parts.join("; ")}.`;
}

function cellElement(table: Table, row: string, column: Column, cell: Cell, name: string, erratum: string | undefined): HTMLElement {
  const decimals = decimalsOf(cell, column);
  const children: (Node | string | undefined)[] = [h("span", { class: "ours" }, ...oursOf(cell, column, name), mark(cell, erratum))];
  if (cell.range && cell.range[0] !== null && cell.range[1] !== null) {
    const [low, high] = cell.range;
    children.push(h("span", { class: "range" }, hidden("range from rounding "), "[", data(low, fixed(low, decimals + 1), `${name}-low`), ", ", data(high, fixed(high, decimals + 1), `${name}-high`), "]"));
  }
  if (cell.printed !== null) {
    const shown = minus(cell.printed);
    children.push(h("span", { class: "printed" }, hidden("printed "), cell.printed_value === null ? shown : data(cell.printed_value, shown, `${name}-printed`)));
  }
  if (cell.difference !== null) {
    children.push(h("span", { class: "difference" }, h("abbr", { title: "ours − printed" }, "Δ"), " ", data(cell.difference, signed(cell.difference, decimals + 1), `${name}-difference`)));
  }
  return h("td", { class: cell.agreement.replace(" ", "-"), title: factsOf(table, row, column, cell), tabindex: -1 }, ...children);
}

const field = (text: string): string => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** The same columns as the file beside the page. */
export function csvOf(table: Table): string {
  const lines = ["row,column,unit,printed,ours,difference,spread,range_low,range_high,agreement"];
  for (const row of table.rows) {
    row.cells.forEach((cell, k) => {
      const column = table.columns[k];
      const values = [row.name, column?.name ?? "", column?.unit ?? "", cell.printed, cell.ours, cell.difference, cell.spread, cell.range?.[0] ?? null, cell.range?.[1] ?? null, cell.agreement];
      lines.push(values.map((value) => (value === null ? "" : field(String(value)))).join(","));
    });
  }
  return `${lines.join("\n")}\n`;
}

/** Arrow keys, Home and End lead from cell to cell; what the cell holds stands below the table. */
function walkable(grid: HTMLTableElement, say: (text: string) => void): void {
  const rows = [...grid.tBodies[0]!.rows].map((row) => [...row.cells].filter((cell) => cell.tagName === "TD"));
  const first = rows[0]?.[0];
  if (!first) return;
  let stop = first;
  stop.tabIndex = 0;
  const place = (cell: HTMLElement): [number, number] => {
    const r = rows.findIndex((row) => row.includes(cell as HTMLTableCellElement));
    return [r, rows[r]?.indexOf(cell as HTMLTableCellElement) ?? -1];
  };
  grid.addEventListener("focusin", ({ target }) => {
    const cell = (target as HTMLElement).closest("td");
    if (!cell) return;
    stop.tabIndex = -1;
    stop = cell;
    stop.tabIndex = 0;
    say(cell.title);
  });
  grid.addEventListener("keydown", (event) => {
    const cell = (event.target as HTMLElement).closest("td");
    if (!cell) return;
    const [r, c] = place(cell);
    const last = (rows[r]?.length ?? 1) - 1;
    const to: Record<string, [number, number]> = {
      ArrowUp: [r - 1, c], ArrowDown: [r + 1, c], ArrowLeft: [r, c - 1], ArrowRight: [r, c + 1], Home: [r, 0], End: [r, last],
    };
    if (event.key === "Enter") return cell.querySelector<HTMLElement>("a")?.click();
    const [row, column] = to[event.key] ?? [];
    if (row === undefined || column === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const next = rows[row]?.[column];
    next?.focus();
  });
}

/** @param known  ids that a link can lead to */
export function tableBlock(exhibit: Exhibit, k: number, known: Set<string>): HTMLElement {
  const table = exhibit.tables[k] as Table;
  const id = `${exhibit.id}-table-${k + 1}`;
  const erratum = table.erratum !== null && known.has(table.erratum) ? table.erratum : undefined;
  const head = h("tr", {},
    table.what_rows_are ? h("th", { scope: "col" }, table.what_rows_are) : h("td", {}, hidden("row")),
    ...table.columns.map((column) => h("th", { scope: "col" }, ...scripted(column.name), column.unit ? h("span", { class: "unit" }, column.unit) : "")));
  const rows = table.rows.map((row, r) =>
    h("tr", {}, h("th", { scope: "row" }, ...scripted(row.name)),
      ...table.columns.map((column, c) => {
        const cell = row.cells[c];
        return cell ? cellElement(table, row.name, column, cell, `${id}-r${r + 1}c${c + 1}`, erratum) : h("td", {});
      })));
  const grid = h("table", { role: "grid", "aria-readonly": "true", "aria-labelledby": `${id}-title`, class: table.columns.length >= wide ? "wide" : "" },
    h("thead", {}, head), h("tbody", {}, ...rows));

  const file = tableFile(exhibit, k);
  const differences = h("button", { type: "button", class: "toggle", "aria-pressed": "false" }, "Show differences");
  const save = h("button", { type: "button", "aria-label": `Save CSV: ${table.title}` }, "Save CSV");
  save.addEventListener("click", () => download(`${file}.csv`, csvOf(table)));
  const facts = h("p", { class: "cell-facts", role: "status" });
  walkable(grid, (text) => (facts.textContent = text));

  const cells = table.rows.flatMap((row) => row.cells);
  const block = h("div", { class: "table-block", id },
    h("h4", { id: `${id}-title` }, ...scripted(table.title || shortName(exhibit.id))),
    h("p", { class: "table-notes" }, table.provenance === exhibit.provenance && exhibit.tables.length === 1 ? "" : chip(table.provenance),
      cells.some((cell) => cell.printed !== null) ? h("span", {}, "ours above, ", h("span", { class: "printed" }, "printed"), " below") : "",
      table.spread_is ? h("span", {}, `± ${table.spread_is}`) : "",
      table.erratum === null ? "" : h("span", {}, "Differences: ", erratum ? h("a", { href: `#${erratum}` }, shortName(erratum).toLowerCase()) : shortName(table.erratum).toLowerCase())),
    table.rows.length > 0 && table.columns.length > 0 ? scrolling(table.title, grid) : h("p", { class: "none" }, "This table has no numbers."),
    facts,
    h("div", { class: "tools", role: "group", "aria-label": `Tools: ${table.title}` },
      cells.some((cell) => cell.difference !== null) ? differences : "",
      save,
      h("span", { class: "files" }, "Files: ", h("a", { href: `tables/${file}.csv` }, "CSV"), " ", h("a", { href: `tables/${file}.json` }, "JSON"))));
  differences.addEventListener("click", () => showDifferences(block, !block.classList.contains("with-differences")));
  return block;
}

export function showDifferences(block: HTMLElement, shown: boolean): void {
  block.classList.toggle("with-differences", shown);
  block.querySelector(".toggle")?.setAttribute("aria-pressed", String(shown));
}

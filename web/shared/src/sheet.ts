// The numbers of a chart as a table and as a CSV file.
import type { Chart } from "./chart_data";
import type { Value } from "./documents";
import { captionOf, h, scrolling } from "./dom";
import { significant } from "./format";

interface Sheet {
  head: string[];
  rows: Value[][];
}

/** All series as columns; those that share their x share a column. */
function sheet(chart: Chart): Sheet {
  const head: string[] = [];
  const columns: Value[][] = [];
  const shared: Value[][] = [];
  for (const panel of chart.panels) {
    for (const series of panel.series) {
      if (!shared.includes(series.x)) {
        shared.push(series.x);
        head.push(`${chart.x.name} [${chart.x.unit}]`);
        columns.push(series.x);
      }
      const unit = panel.unit ? ` [${panel.unit}]` : "";
      head.push(panel.title === series.name ? `${series.name}${unit}` : `${panel.title}, ${series.name}${unit}`);
      columns.push(series.y);
      if (!series.between) continue;
      head.push(...["low", "high"].map((end) => `${panel.title}, ${series.between?.name}, ${end}${unit}`));
      columns.push(series.between.low, series.between.high);
    }
  }
  const length = Math.max(...columns.map((column) => column.length));
  const rows = Array.from({ length }, (_, i) => columns.map((column) => column[i] ?? null));
  return { head, rows: rows.filter((row) => row.some((value) => value !== null)) };
}

/** What a spreadsheet would take for a formula begins with an apostrophe. */
const quoted = (text: string): string => `"${(/^[=+\-@\t\r]/.test(text) ? `'${text}` : text).replaceAll('"', '""')}"`;

/** Words are quoted, numbers are not, and what is undefined is empty. */
export function csvOf(head: string[], rows: (Value | string | undefined)[][]): string {
  const lines = [head.map(quoted), ...rows.map((row) => row.map((value) => (typeof value === "string" ? quoted(value) : (value ?? ""))))];
  return `${lines.map((line) => line.join(",")).join("\n")}\n`;
}

export function csv(chart: Chart): string {
  const { head, rows } = sheet(chart);
  return csvOf(head, rows);
}

const longestTable = 60;

export function dataTable(chart: Chart): HTMLElement {
  const { head, rows } = sheet(chart);
  const step = Math.max(1, Math.ceil(rows.length / longestTable));
  const shown = rows.filter((_, i) => i % step === 0);
  const caption = `${chart.title}: ${step === 1 ? "every value" : `every ${step}th of ${rows.length} rows; the CSV file has all`}`;
  const cells = (row: Value[]) => row.map((value) => h("td", {}, value === null ? "" : significant(value, 5)));
  return scrolling(
    caption,
    h(
      "table",
      { class: "values" },
      captionOf(caption),
      h("thead", {}, h("tr", {}, ...head.map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, ...shown.map((row) => h("tr", {}, ...cells(row)))),
    ),
  );
}

export function download(name: string, text: string, type = "text/csv"): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  h("a", { href: address, download: name }).click();
  URL.revokeObjectURL(address);
}

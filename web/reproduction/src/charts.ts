// Charts as pictures of their own: nothing of an SVG can reach the page. Each opens larger, with its numbers.
import type { Axis, Chart, Exhibit, Value } from "@mbk/shared/documents";
import { h, scrolling } from "@mbk/shared/dom";
import { listed, plain, significant } from "@mbk/shared/format";
import { download } from "@mbk/shared/sheet";
import { chartFile, shortName } from "./document";

const pictureOf = (svg: string): string => `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;

function sizeOf(svg: string): { width: number; height: number } {
  const [, width, height] = /viewBox="0 0 ([\d.]+) ([\d.]+)"/.exec(svg) ?? [];
  return { width: Number(width ?? 760), height: Number(height ?? 560) };
}

const withUnit = (axis: Axis): string => (axis.unit ? `${axis.label} [${axis.unit}]` : axis.label);
const numbersOf = (values: Value[]): number[] => values.filter((value) => value !== null);

/** The title, the axes, and of each series how many points it has and from where to where they go. */
export function described(chart: Chart): string {
  const series = chart.series.map(({ name, x, y }) => {
    const [along, up] = [numbersOf(x), numbersOf(y)];
    if (along.length === 0 || up.length === 0) return `${name} (no points)`;
    const between = (values: number[]) => `${plain(values.reduce((a, b) => Math.min(a, b)), 4)} to ${plain(values.reduce((a, b) => Math.max(a, b)), 4)}`;
    return `${name} (${x.length} point${x.length === 1 ? "" : "s"}, ${between(up)} over ${between(along)})`;
  });
  const lines = [...chart.horizontal, ...chart.vertical].map(({ name, value }) => `${name} at ${plain(value, 4)}`);
  if (chart.identity) lines.push("identity line");
  return [
    chart.title,
    `${withUnit(chart.y)} over ${withUnit(chart.x)}`,
    series.length > 0 ? `Series: ${series.join("; ")}` : "No series",
    ...(lines.length > 0 ? [`Lines: ${listed(lines)}`] : []),
    ...chart.notes,
  ].map((sentence) => sentence.replace(/\.$/, "")).join(". ") + ".";
}

function rowsOf(chart: Chart): (Value | string)[][] {
  return chart.series.flatMap(({ name, x, y, intervals }) =>
    x.map((value, i) => [name, value, y[i] ?? null, intervals[i]?.[0] ?? null, intervals[i]?.[1] ?? null]));
}

const quoted = (text: string): string => `"${text.replaceAll('"', '""')}"`;

function csvOf(chart: Chart): string {
  const head = ["series", withUnit(chart.x), withUnit(chart.y), "low", "high"].map(quoted);
  const rows = rowsOf(chart).map((row) => row.map((value) => (value === null ? "" : typeof value === "string" ? quoted(value) : value)));
  return `${[head, ...rows].map((row) => row.join(",")).join("\n")}\n`;
}

const longestTable = 60;

function dataTable(chart: Chart): HTMLElement {
  const rows = rowsOf(chart);
  const step = Math.max(1, Math.ceil(rows.length / longestTable));
  const withIntervals = chart.series.some(({ intervals }) => intervals.length > 0);
  const columns = withIntervals ? 5 : 3;
  const caption = step === 1 ? "Every point" : `One of ${step} of ${rows.length} points; the CSV file has all`;
  const shown = (value: Value | string) => (value === null ? "" : typeof value === "string" ? value : significant(value, 5));
  return scrolling(`${chart.title}: numbers`,
    h("table", { class: "values" }, h("caption", {}, caption),
      h("thead", {}, h("tr", {}, ...["series", withUnit(chart.x), withUnit(chart.y), "low", "high"].slice(0, columns).map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, ...rows.filter((_, i) => i % step === 0).map((row) => h("tr", {}, ...row.slice(0, columns).map((value) => h("td", {}, shown(value))))))));
}

/** One dialog for all charts of an exhibit; ← and → go through them. */
function enlarge(exhibit: Exhibit, drawings: string[], from: number): void {
  let at = from;
  const title = h("h2", { id: "enlarged-title" });
  const content = h("div", { class: "enlarged" });
  const button = (text: string, label: string, act: () => void) => {
    const element = h("button", { type: "button", ...(label ? { "aria-label": label } : {}) }, text);
    element.addEventListener("click", act);
    return element;
  };
  const dialog = h("dialog", { "aria-labelledby": "enlarged-title" });
  const show = (k: number) => {
    at = (k + exhibit.charts.length) % exhibit.charts.length;
    const chart = exhibit.charts[at] as Chart;
    const drawing = drawings[at] ?? "";
    title.textContent = exhibit.charts.length > 1 ? `${shortName(exhibit.id)}, ${at + 1} of ${exhibit.charts.length}` : shortName(exhibit.id);
    const numbers = h("details", { class: "data-table" }, h("summary", {}, "Numbers"), dataTable(chart));
    content.replaceChildren(
      h("div", { class: "enlarged-picture", tabindex: 0, role: "group", "aria-label": "Picture" }, h("img", { src: pictureOf(drawing), alt: described(chart), ...sizeOf(drawing) })),
      h("div", { class: "tools" }, button("Save CSV", `Save CSV: ${chart.title}`, () => download(`${chartFile(exhibit, at)}.csv`, csvOf(chart)))),
      numbers);
  };
  const step = (by: number) => show(at + by);
  const several = exhibit.charts.length > 1;
  dialog.append(h("header", {}, title,
    several ? button("←", "Previous chart", () => step(-1)) : "",
    several ? button("→", "Next chart", () => step(1)) : "",
    button("Close", "", () => dialog.close())), content);
  dialog.addEventListener("keydown", (event) => {
    if (!several || (event.target as HTMLElement).closest(".enlarged-picture, .table-scroll")) return;
    if (event.key === "ArrowLeft") step(-1);
    if (event.key === "ArrowRight") step(1);
  });
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  show(from);
  dialog.showModal();
}

export function chartsBlock(exhibit: Exhibit, drawings: string[]): HTMLElement {
  const n = exhibit.charts.length;
  // Two beside each other can still be read; three are for an overview, of six participants, say.
  return h("div", { class: `charts${n > 1 ? " several" : ""}${n >= 6 && n % 3 === 0 ? " in-threes" : ""}` },
    ...exhibit.charts.map((chart, k) => {
      const drawing = drawings[k];
      if (!drawing) return h("p", { class: "none" }, `${chart.title}: no drawing.`);
      const open = h("button", { type: "button", class: "picture" },
        h("img", { src: pictureOf(drawing), alt: described(chart), decoding: "async", ...sizeOf(drawing) }),
        h("span", { class: "enlarge" }, "Enlarge"));
      open.addEventListener("click", () => enlarge(exhibit, drawings, k));
      return h("figure", {}, open,
        h("figcaption", { class: "files" }, `${chart.title}. `, h("a", { href: `figures/${chartFile(exhibit, k)}.svg`, "aria-label": `SVG file beside this page: ${chart.title}` }, "SVG")));
    }));
}

// Charts that can be zoomed, read aloud, read as a table, saved as CSV and printed.
import { LineChart } from "echarts/charts";
import {
  DataZoomComponent,
  GridComponent,
  MarkAreaComponent,
  MarkLineComponent,
  TooltipComponent,
} from "echarts/components";
import { type ECharts, init, use } from "echarts/core";
import { SVGRenderer } from "echarts/renderers";
import type { Value } from "./data";
import { h, scrolling, svg } from "./dom";
import { plain, significant, superscript } from "./format";

use([LineChart, GridComponent, TooltipComponent, DataZoomComponent, MarkAreaComponent, MarkLineComponent, SVGRenderer]);

// Okabe & Ito (2008); every line has a dash of its own besides, so that nothing hangs on colour.
export const styles = {
  measured: { color: "#000000", dash: "solid", width: 1.4 },
  predicted: { color: "#d55e00", dash: "dashed", width: 1.8 },
  residual: { color: "#0072b2", dash: "solid", width: 1.1 },
  first: { color: "#0072b2", dash: "solid", width: 1.6 },
  second: { color: "#d55e00", dash: "dashed", width: 1.6 },
  third: { color: "#009e73", dash: "dotted", width: 2 },
  ideal: { color: "#595959", dash: "dashed", width: 1 },
} as const;
type Style = (typeof styles)[keyof typeof styles];
const dashes: Record<string, string> = { solid: "", dashed: "7 4", dotted: "2 3" };

export interface Series {
  name: string;
  x: Value[];
  y: Value[];
  style: Style;
}

export interface Panel {
  title: string;
  unit: string;
  series: Series[];
  log?: boolean;
  range?: [number, number];
  /** Stretch of x that is shaded, with its name. */
  band?: { from: number; to: number; name: string };
  /** Stretch of y that is shaded, with its name. */
  level?: { from: number; to: number; name: string };
}

export interface Chart {
  id: string;
  title: string;
  howToRead: string;
  /** What the chart shows, for those who cannot see it. */
  description: string;
  x: { name: string; unit: string; log?: boolean };
  panels: Panel[];
  panelHeight?: number;
}

const font = '"Inter", system-ui, "Segoe UI", "Helvetica Neue", Arial, "DejaVu Sans", sans-serif';
const [top, gap, bottom, slider] = [26, 46, 44, 34];
const printWidth = 660; // of A4 between its margins [px]

/** 0.1, 1, 100 or 10⁻⁵ */
const powerOfTen = (value: number): string => {
  const exponent = Math.round(Math.log10(value));
  return Math.abs(exponent) < 3 ? plain(value) : `10${superscript(String(exponent))}`;
};

const number = (value: Value): number | "-" => (value === null ? "-" : value);

const paper = 0.78; // panels are that much lower on paper
const panelHeight = (chart: Chart, printed: boolean): number => (chart.panelHeight ?? 190) * (printed ? paper : 1);

function height(chart: Chart, printed: boolean): number {
  const panels = chart.panels.length * panelHeight(chart, printed) + (chart.panels.length - 1) * gap;
  return top + panels + bottom + (printed ? 0 : slider);
}

function extent(chart: Chart): [number, number] {
  const all = chart.panels.flatMap((panel) => panel.series.flatMap((series) => series.x));
  const known = all.filter((v): v is number => v !== null && (!chart.x.log || v > 0));
  let [low, high] = [Infinity, -Infinity];
  for (const v of known) {
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  return low < high ? [low, high] : [0, 1];
}

function options(chart: Chart, printed: boolean): Record<string, unknown> {
  const each = panelHeight(chart, printed);
  const text = { fontFamily: font, color: "#333333", fontSize: 12 };
  const line = { lineStyle: { color: "#8a8a8a" } };
  const [low, high] = extent(chart);
  const label = (value: number): string => plain(value, 4);
  const series = chart.panels.flatMap((panel, k) =>
    panel.series.map((one, index) => ({
      type: "line",
      name: one.name,
      xAxisIndex: k,
      yAxisIndex: k,
      data: one.x.map((x, i) => {
        const y = one.y[i] ?? null;
        return [number(x), panel.log && y !== null && y <= 0 ? "-" : number(y)];
      }),
      showSymbol: false,
      animation: false,
      silent: true,
      lineStyle: { color: one.style.color, width: one.style.width, type: one.style.dash, cap: "butt" },
      itemStyle: { color: one.style.color },
      ...(index === 0 ? shades(panel) : {}),
    })),
  );
  return {
    animation: false,
    textStyle: { fontFamily: font },
    grid: chart.panels.map((_, k) => ({ left: 74, right: 22, top: top + k * (each + gap), height: each })),
    xAxis: chart.panels.map((_, k) => ({
      type: chart.x.log ? "log" : "value",
      gridIndex: k,
      min: low,
      max: high,
      name: k === chart.panels.length - 1 ? `${chart.x.name} [${chart.x.unit}]` : "",
      nameLocation: "middle",
      nameGap: 26,
      nameTextStyle: text,
      axisLabel: { ...text, formatter: chart.x.log ? powerOfTen : label, hideOverlap: true, showMinLabel: !chart.x.log, showMaxLabel: false },
      axisLine: { ...line, onZero: false },
      axisTick: line,
      splitLine: { show: false },
    })),
    yAxis: chart.panels.map((panel, k) => ({
      type: panel.log ? "log" : "value",
      gridIndex: k,
      scale: !panel.range,
      ...(panel.range ? { min: panel.range[0], max: panel.range[1] } : {}),
      name: panel.unit ? `${panel.title} [${panel.unit}]` : panel.title,
      nameLocation: "end",
      nameGap: 9,
      nameTextStyle: { ...text, align: "left", fontWeight: 600, padding: [0, 0, 0, -66] },
      axisLabel: {
        ...text,
        formatter: panel.log ? powerOfTen : label,
        hideOverlap: true,
      },
      splitNumber: panel.log ? 6 : 4,
      splitLine: { lineStyle: { color: "#ececec" } },
    })),
    tooltip: {
      trigger: "axis",
      confine: true,
      renderMode: "html",
      transitionDuration: 0,
      textStyle: { ...text, fontSize: 12 },
      formatter: (points: { seriesName: string; value: [number, number]; seriesIndex: number }[]) => {
        const first = points[0];
        if (!first) return "";
        const lines = points.map((p) => h("div", {}, `${p.seriesName}: ${significant(p.value[1], 4)}`));
        return h("div", {}, h("strong", {}, `${chart.x.name} ${significant(first.value[0], 5)} ${chart.x.unit}`), ...lines);
      },
    },
    axisPointer: { link: [{ xAxisIndex: "all" }], lineStyle: { color: "#8a8a8a" } },
    dataZoom: [
      { type: "inside", xAxisIndex: chart.panels.map((_, k) => k), zoomOnMouseWheel: "ctrl", moveOnMouseWheel: false, filterMode: "none" },
      {
        type: "slider",
        show: !printed,
        xAxisIndex: chart.panels.map((_, k) => k),
        bottom: 4,
        height: 16,
        left: 74,
        right: 22,
        showDetail: false,
        brushSelect: false,
        showDataShadow: false,
        filterMode: "none",
        borderColor: "#b9b9b9",
        fillerColor: "rgba(0,114,178,0.14)",
        handleStyle: { color: "#ffffff", borderColor: "#0072b2" },
        moveHandleSize: 0,
      },
    ],
    series,
  };
}

const shadeColors = { band: "rgba(86,180,233,0.2)", level: "rgba(110,110,110,0.2)" };

function shades(panel: Panel): object {
  const areas: object[] = [];
  if (panel.band) areas.push([{ xAxis: panel.band.from, itemStyle: { color: shadeColors.band } }, { xAxis: panel.band.to }]);
  if (panel.level) areas.push([{ yAxis: panel.level.from, itemStyle: { color: shadeColors.level } }, { yAxis: panel.level.to }]);
  return areas.length ? { markArea: { silent: true, animation: false, label: { show: false }, data: areas } } : {};
}

/** Which dash is which. */
function legend(chart: Chart): HTMLElement {
  const seen = new Map(chart.panels.flatMap((panel) => panel.series).map((series) => [series.name, series.style]));
  const shaded = new Map(
    chart.panels.flatMap((panel) => [
      ...(panel.band ? [[panel.band.name, shadeColors.band] as const] : []),
      ...(panel.level ? [[panel.level.name, shadeColors.level] as const] : []),
    ]),
  );
  return h(
    "ul",
    { class: "legend" },
    ...[...seen].map(([name, style]) =>
      h(
        "li",
        {},
        svg(
          "svg",
          { width: 34, height: 10, "aria-hidden": "true" },
          svg("line", { x1: 1, y1: 5, x2: 33, y2: 5, stroke: style.color, "stroke-width": style.width + 0.4, "stroke-dasharray": dashes[style.dash] }),
        ),
        name,
      ),
    ),
    ...[...shaded].map(([name, color]) =>
      h(
        "li",
        {},
        svg("svg", { width: 22, height: 12, "aria-hidden": "true" }, svg("rect", { x: 0.5, y: 0.5, width: 21, height: 11, fill: color, stroke: "#8a8a8a", "stroke-width": 0.6 })),
        name,
      ),
    ),
  );
}

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
    }
  }
  const length = Math.max(...columns.map((column) => column.length));
  const rows = Array.from({ length }, (_, i) => columns.map((column) => column[i] ?? null));
  return { head, rows: rows.filter((row) => row.some((value) => value !== null)) };
}

function csv(chart: Chart): string {
  const { head, rows } = sheet(chart);
  const lines = [head.map((name) => `"${name.replaceAll('"', '""')}"`), ...rows.map((row) => row.map((v) => v ?? ""))];
  return `${lines.map((line) => line.join(",")).join("\n")}\n`;
}

const longestTable = 60;

function dataTable(chart: Chart): HTMLElement {
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
      h("caption", {}, caption),
      h("thead", {}, h("tr", {}, ...head.map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, ...shown.map((row) => h("tr", {}, ...cells(row)))),
    ),
  );
}

function download(name: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  h("a", { href: address, download: name }).click();
  URL.revokeObjectURL(address);
}

/** A chart that exists once it has been drawn. */
class Drawn {
  private shown: ECharts | undefined;
  private printed = false;
  constructor(
    private readonly chart: Chart,
    private readonly place: HTMLElement,
  ) {}

  draw(): void {
    if (this.shown) return;
    const width = this.place.clientWidth || printWidth;
    this.place.style.height = `${height(this.chart, false)}px`;
    this.shown = init(this.place, null, { renderer: "svg", width, height: height(this.chart, false) });
    this.shown.setOption(options(this.chart, false));
  }

  resize(): void {
    if (this.shown && !this.printed && this.place.clientWidth > 0) this.shown.resize({ width: this.place.clientWidth });
  }

  print(printed: boolean): void {
    this.draw();
    this.printed = printed;
    const tall = height(this.chart, printed);
    this.place.style.height = `${tall}px`;
    this.shown?.resize({ width: printed ? printWidth : this.place.clientWidth || printWidth, height: tall });
    const { start, end } = this.window();
    this.shown?.setOption(options(this.chart, printed));
    this.zoomTo(start, end);
  }

  /** What of the x axis is shown [%]. */
  window(): { start: number; end: number } {
    const zoom = (this.shown?.getOption() as { dataZoom?: { start?: number; end?: number }[] } | undefined)?.dataZoom?.[0];
    return { start: zoom?.start ?? 0, end: zoom?.end ?? 100 };
  }

  zoomTo(start: number, end: number): void {
    this.draw();
    const width = Math.min(Math.max(end - start, 0.5), 100);
    const from = Math.min(Math.max(start, 0), 100 - width);
    for (const dataZoomIndex of [0, 1]) {
      this.shown?.dispatchAction({ type: "dataZoom", dataZoomIndex, start: from, end: from + width });
    }
  }
}

const all: Drawn[] = [];

/** Draws what is on the screen now and whatever comes into view; opens and draws everything before it is printed. */
export function followPageAndPrinter(): void {
  addEventListener("resize", () => all.forEach((drawn) => drawn.resize()));
  const opened: HTMLDetailsElement[] = [];
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll<HTMLDetailsElement>("details[data-print]:not([open])")) {
      details.open = true;
      opened.push(details);
    }
    all.forEach((drawn) => drawn.print(true));
  });
  addEventListener("afterprint", () => {
    all.forEach((drawn) => drawn.print(false));
    for (const details of opened.splice(0)) details.open = false;
  });
}

/** The chart with its legend, tools, data table and one sentence on how to read it. */
export function figure(chart: Chart): HTMLElement {
  const place = h("div", { class: "chart", id: chart.id, role: "img", "aria-label": `${chart.title}. ${chart.description}` });
  const drawn = new Drawn(chart, place);
  all.push(drawn);
  new IntersectionObserver((entries, observer) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    drawn.draw();
    observer.disconnect();
  }, { rootMargin: "800px" }).observe(place);
  place.style.height = `${height(chart, false)}px`;

  const zoom = h("output", { class: "zoom", "aria-live": "polite" });
  const tool = (text: string, label: string, act: () => void) => {
    const button = h("button", { type: "button", "aria-label": `${label}: ${chart.title}`, title: label }, text);
    button.addEventListener("click", act);
    return button;
  };
  const view = (change: (start: number, end: number) => [number, number]) => () => {
    const { start, end } = drawn.window();
    drawn.zoomTo(...change(start, end));
    const now = drawn.window();
    zoom.textContent = now.end - now.start > 99.9 ? "all" : `${Math.round(now.start)}–${Math.round(now.end)} %`;
  };
  const table = h("details", { class: "data-table" }, h("summary", {}, "Data table"));
  table.addEventListener("toggle", () => {
    if (table.open && table.children.length === 1) table.append(dataTable(chart));
  });
  return h(
    "figure",
    { class: "chart-figure", "aria-label": chart.title },
    legend(chart),
    place,
    h(
      "div",
      { class: "tools", role: "group", "aria-label": `Tools: ${chart.title}` },
      tool("+", "Zoom in", view((s, e) => [s + (e - s) / 4, e - (e - s) / 4])),
      tool("−", "Zoom out", view((s, e) => [s - (e - s) / 2, e + (e - s) / 2])),
      tool("←", "Earlier, or lower", view((s, e) => [s - (e - s) / 2, e - (e - s) / 2])),
      tool("→", "Later, or higher", view((s, e) => [s + (e - s) / 2, e + (e - s) / 2])),
      tool("Show all", "Show all", view(() => [0, 100])),
      zoom,
      tool("Save CSV", "Save CSV", () => download(`${chart.id}.csv`, csv(chart))),
    ),
    table,
    h("figcaption", {}, h("strong", {}, "How to read this. "), chart.howToRead),
  );
}

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
import { type Chart, dashes, type Panel, type Series, type Shade, type Style, symbols } from "@mbk/shared/chart_data";
import type { Value } from "@mbk/shared/documents";
import { h, svg } from "@mbk/shared/dom";
import { plain, significant, superscript } from "@mbk/shared/format";
import { csv, dataTable } from "@mbk/shared/sheet";
import { savingButtons } from "./picture";

export type { Chart, Panel, Series, Style } from "@mbk/shared/chart_data";

use([LineChart, GridComponent, TooltipComponent, DataZoomComponent, MarkAreaComponent, MarkLineComponent, SVGRenderer]);

// Colours are those of the page, light or dark (shared/tokens.css); every line has a dash of its own besides, so
// that nothing hangs on colour.
export const styles = {
  measured: { color: "var(--ink)", dash: "solid", width: 1.4 },
  predicted: { color: "var(--second)", dash: "dashed", width: 1.8 },
  residual: { color: "var(--first)", dash: "solid", width: 1.1 },
  first: { color: "var(--first)", dash: "solid", width: 1.6 },
  second: { color: "var(--second)", dash: "dashed", width: 1.6 },
  third: { color: "var(--third)", dash: "dotted", width: 2 },
  ideal: { color: "var(--soft)", dash: "dashed", width: 1 },
} as const;

const colors = ["var(--first)", "var(--second)", "var(--third)", "var(--ink)", "var(--fourth)"];
const pick = <T>(all: T[], k: number): T => all[k % all.length] as T;

/** For the k-th of several recordings: a line, and a mark, unlike those of its neighbours without colour too. */
export const styleOf = (k: number): Style => ({ color: pick(colors, k), dash: pick(Object.keys(dashes) as Style["dash"][], k), width: 1.6 });
export const symbolOf = (k: number): keyof typeof symbols => pick(Object.keys(symbols) as (keyof typeof symbols)[], k);

const font = '"Inter", system-ui, "Segoe UI", "Helvetica Neue", Arial, "DejaVu Sans", sans-serif';
const [top, gap, bottom, slider] = [26, 46, 44, 34];
const printWidth = 660; // of A4 between its margins [px]

/** 0.1, 1, 100 or 10⁻⁵ */
const powerOfTen = (value: number): string => {
  const exponent = Math.round(Math.log10(value));
  return Math.abs(exponent) < 3 ? plain(value) : `10${superscript(String(exponent))}`;
};

/** Where a logarithmic axis has ticks: 0.1, 0.2, 0.5, 1 … ; only the powers of ten of many decades, round numbers of a small part of one. */
export function logarithmicTicks(low: number, high: number): number[] {
  const decades = low > 0 ? Math.log10(high / low) : 0;
  if (!(decades > 0 && decades < 300)) return [];
  if (decades < 0.6) {
    const rough = (high - low) / 5;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10);
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
  }
  const first = Math.floor(Math.log10(low));
  const factors = decades <= 4 ? [1, 2, 5] : [1];
  return Array.from({ length: Math.ceil(decades) + 2 }, (_, k) => factors.map((factor) => Number((factor * 10 ** (first + k)).toPrecision(12)))).flat()
    .filter((at) => at >= low * (1 - 1e-9) && at <= high * (1 + 1e-9));
}

const number = (value: Value): number | "-" => (value === null ? "-" : value);

const paper = 0.78; // panels are that much lower on paper
const panelHeight = (chart: Chart, printed: boolean): number => (chart.panelHeight ?? 190) * (printed ? paper : 1);

function height(chart: Chart, printed: boolean): number {
  const panels = chart.panels.length * panelHeight(chart, printed) + (chart.panels.length - 1) * gap;
  return top + panels + bottom + (printed ? 0 : slider);
}

function extent(chart: Chart): [number, number] {
  if (chart.x.range) return chart.x.range;
  const all = chart.panels.flatMap((panel) => panel.series.flatMap((series) => series.x));
  const known = all.filter((v): v is number => v !== null && (!chart.x.log || v > 0));
  let [low, high] = [Infinity, -Infinity];
  for (const v of known) {
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  return low < high ? [low, high] : [0, 1];
}

const pointsOf = (x: Value[], y: Value[], log = false): (number | "-")[][] =>
  x.map((at, i) => {
    const value = y[i] ?? null;
    return [number(at), log && value !== null && value <= 0 ? "-" : number(value)];
  });

function line(one: Series, panel: Panel, k: number, first: boolean, text: object): object {
  const dash = dashes[one.style.dash];
  return {
    type: "line",
    name: one.name,
    xAxisIndex: k,
    yAxisIndex: k,
    data: pointsOf(one.x, one.y, panel.log),
    showSymbol: one.marks !== undefined,
    symbol: one.marks,
    symbolSize: 8,
    animation: false,
    silent: true,
    ...(one.labels ? { label: { show: true, position: "right", ...text, formatter: ({ dataIndex }: { dataIndex: number }) => one.labels?.[dataIndex] ?? "" } } : {}),
    lineStyle: { color: one.style.color, width: one.style.width, type: dash ? dash.split(" ").map(Number) : "solid", cap: "butt", opacity: one.marks ? 0 : 1 },
    itemStyle: { color: one.style.color },
    ...(first ? shades(panel) : {}),
  };
}

/** The band around a line: what is between is stacked on its lower end. */
function shaded(one: Series, k: number): object[] {
  if (!one.between) return [];
  const { low, high } = one.between;
  const width = high.map((value, i) => (value === null || (low[i] ?? null) === null ? null : value - (low[i] as number)));
  return [low, width].map((y, part) => ({
    type: "line",
    name: "",
    xAxisIndex: k,
    yAxisIndex: k,
    data: pointsOf(one.x, y),
    stack: `band ${k} ${one.name}`,
    stackStrategy: "all",
    showSymbol: false,
    animation: false,
    silent: true,
    lineStyle: { opacity: 0 },
    ...(part === 1 ? { areaStyle: one.between?.shade ?? shadesOf.between } : {}),
  }));
}

function grids(chart: Chart, printed: boolean): object[] {
  const each = panelHeight(chart, printed);
  return chart.panels.map((_, k) => ({ left: 74, right: 22, top: top + k * (each + gap), height: each }));
}

function options(chart: Chart): Record<string, unknown> {
  const text = { fontFamily: font, color: "var(--label)", fontSize: 12 };
  const rule = { lineStyle: { color: "var(--axis)" } };
  const [low, high] = extent(chart);
  const ticks = logarithmicTicks(low, high);
  const label = (value: number): string => plain(value, 4);
  const series = chart.panels.flatMap((panel, k) =>
    panel.series.flatMap((one, index) => [...shaded(one, k), line(one, panel, k, index === 0, text)]));
  return {
    animation: false,
    textStyle: { fontFamily: font },
    grid: grids(chart, false),
    xAxis: chart.panels.map((_, k) => ({
      type: chart.x.log ? "log" : "value",
      gridIndex: k,
      min: low,
      max: high,
      name: k === chart.panels.length - 1 ? `${chart.x.name} [${chart.x.unit}]` : "",
      nameLocation: "middle",
      nameGap: 26,
      nameTextStyle: text,
      axisLabel: { ...text, formatter: label, hideOverlap: true, ...(chart.x.log ? { customValues: ticks } : { showMinLabel: !chart.x.range, showMaxLabel: false }) },
      axisLine: { ...rule, onZero: false },
      axisTick: { ...rule, ...(chart.x.log ? { customValues: ticks } : {}) },
      splitLine: { show: false },
    })),
    yAxis: chart.panels.map((panel, k) => ({
      type: panel.log ? "log" : "value",
      gridIndex: k,
      scale: !panel.range && !panel.zero,
      axisLine: { onZero: false },
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
      ...(panel.interval ? { interval: panel.interval } : {}),
      splitLine: { lineStyle: { color: "var(--grid)" } },
    })),
    tooltip: {
      trigger: "axis",
      confine: true,
      renderMode: "html",
      transitionDuration: 0,
      backgroundColor: "var(--paper)",
      borderColor: "var(--axis)",
      textStyle: { ...text, fontSize: 12 },
      formatter: (points: { seriesName: string; value: [number, number]; seriesIndex: number }[]) => {
        const first = points[0];
        if (!first) return "";
        const lines = points.filter((p) => p.seriesName).map((p) => h("div", {}, `${p.seriesName}: ${significant(p.value[1], 4)}`));
        return h("div", {}, h("strong", {}, `${chart.x.name} ${significant(first.value[0], 5)} ${chart.x.unit}`), ...lines);
      },
    },
    axisPointer: { link: [{ xAxisIndex: "all" }], lineStyle: { color: "var(--axis)" } },
    dataZoom: [
      { type: "inside", xAxisIndex: chart.panels.map((_, k) => k), zoomOnMouseWheel: "ctrl", moveOnMouseWheel: false, filterMode: "none" },
      {
        type: "slider",
        xAxisIndex: chart.panels.map((_, k) => k),
        bottom: 4,
        height: 16,
        left: 74,
        right: 22,
        showDetail: false,
        brushSelect: false,
        showDataShadow: false,
        filterMode: "none",
        borderColor: "var(--axis)",
        fillerColor: "var(--blue-wash)",
        handleStyle: { color: "var(--paper)", borderColor: "var(--first)" },
        moveHandleSize: 0,
      },
    ],
    series,
  };
}

const shadesOf: Record<"band" | "level" | "between", Shade> = { band: { color: "var(--sky)", opacity: 0.2 }, level: { color: "var(--axis)", opacity: 0.25 }, between: { color: "var(--first)", opacity: 0.18 } };

function shades(panel: Panel): object {
  const areas: object[] = [];
  if (panel.band) areas.push([{ xAxis: panel.band.from, itemStyle: shadesOf.band }, { xAxis: panel.band.to }]);
  if (panel.level) areas.push([{ yAxis: panel.level.from, itemStyle: shadesOf.level }, { yAxis: panel.level.to }]);
  return {
    ...(areas.length ? { markArea: { silent: true, animation: false, label: { show: false }, data: areas } } : {}),
    ...(panel.zero ? { markLine: { silent: true, animation: false, symbol: "none", label: { show: false }, lineStyle: { color: "var(--ink)", width: 1, type: "solid" }, data: [{ yAxis: 0 }] } } : {}),
  };
}

/** Which dash is which. */
function legend(chart: Chart): HTMLElement {
  const series = chart.panels.flatMap((panel) => panel.series);
  const seen = new Map(series.map((one) => [one.name, one]));
  const shaded = new Map([
    ...chart.panels.flatMap((panel) => [
      ...(panel.band ? [[panel.band.name, shadesOf.band] as const] : []),
      ...(panel.level ? [[panel.level.name, shadesOf.level] as const] : []),
    ]),
    ...series.flatMap((one) => (one.between ? [[one.between.name, one.between.shade ?? shadesOf.between] as const] : [])),
  ]);
  return h(
    "ul",
    { class: "legend" },
    ...[...seen].map(([name, { style, marks }]) =>
      h(
        "li",
        {},
        svg(
          "svg",
          { width: marks ? 12 : 34, height: 10, "aria-hidden": "true" },
          marks
            ? svg("path", { d: symbols[marks], fill: style.color })
            : svg("line", { x1: 1, y1: 5, x2: 33, y2: 5, stroke: style.color, "stroke-width": style.width + 0.4, "stroke-dasharray": dashes[style.dash] }),
        ),
        name,
      ),
    ),
    ...[...shaded].map(([name, { color, opacity }]) =>
      h(
        "li",
        {},
        svg("svg", { width: 22, height: 12, "aria-hidden": "true" }, svg("rect", { x: 0.5, y: 0.5, width: 21, height: 11, fill: color, "fill-opacity": opacity, stroke: "var(--axis)", "stroke-width": 0.6 })),
        name,
      ),
    ),
  );
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
    this.shown.setOption(options(this.chart));
    if (this.chart.x.log) this.shown.on("datazoom", () => this.placeTicks());
    new ResizeObserver(() => this.resize()).observe(this.place);
  }

  private resize(): void {
    if (!this.printed && this.place.clientWidth > 0 && this.place.clientWidth !== this.shown?.getWidth()) this.shown?.resize({ width: this.place.clientWidth });
  }

  /** Those of a logarithmic axis are of what is shown of it. */
  private placeTicks(): void {
    const [low, high] = extent(this.chart);
    const { start, end } = this.window();
    const at = (share: number): number => low * (high / low) ** (share / 100);
    const customValues = logarithmicTicks(at(start), at(end));
    this.shown?.setOption({ xAxis: this.chart.panels.map(() => ({ axisLabel: { customValues }, axisTick: { customValues } })) });
  }

  print(printed: boolean): void {
    this.draw();
    this.printed = printed;
    const tall = height(this.chart, printed);
    this.place.style.height = `${tall}px`;
    // What is shown of the x axis stays, and all is drawn once, by the new size.
    this.shown?.setOption({ grid: grids(this.chart, printed), dataZoom: [{}, { show: !printed }] }, { lazyUpdate: true });
    this.shown?.resize({ width: printed ? printWidth : this.place.clientWidth || printWidth, height: tall });
    this.shown?.getZr().flush(); // paper does not wait for the next frame
  }

  /** Does it while the chart is as on paper. */
  onPaper<T>(act: () => T): T {
    this.print(true);
    try {
      return act();
    } finally {
      this.print(false);
    }
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

const atOnce = 3000; // for charts before the page counts as loaded, at most [ms]

/** Draws every chart, so that a picture of the page and a search in it find all: most before the page counts as loaded, the rest while nothing else is to do. */
function drawAll(): void {
  const until = performance.now() + atOnce;
  const left = [...all];
  while (left.length > 0 && performance.now() < until) left.shift()?.draw();
  const idle = globalThis.requestIdleCallback ?? ((act: () => void) => setTimeout(act, 50));
  const next = () => {
    left.shift()?.draw();
    if (left.length > 0) idle(next, { timeout: 500 });
  };
  if (left.length > 0) idle(next, { timeout: 500 });
}

/** Draws the charts; opens what is printed, and puts it back. */
export function followPageAndPrinter(): void {
  drawAll();
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
    drawn.draw(); // before its turn
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
      ...savingButtons({ name: chart.id, title: chart.title, csv: () => csv(chart), around: (act) => drawn.onPaper(act) }),
    ),
    table,
    h("figcaption", {}, h("strong", {}, "How to read this. "), chart.howToRead),
  );
}

// Force and position as they come: the last seconds, each pixel column from its lowest to its highest sample.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { h } from "../../report/src/dom";
import { type Frame, column } from "./stream";

const span = 8; // [s]
const buckets = 800; // over the span
const kept = span + 1; // [s]

interface Line {
  label: string;
  colour: string;
  dash?: number[];
  from: number; // column
  scale: number;
  offset: number;
}

// Okabe and Ito's colours; dashes tell references apart without any
const blue = "#0072b2";
const vermilion = "#d55e00";
const dash = [7, 5];

/** One plot. Times are those of the trial. */
class Trace {
  readonly element: HTMLElement;
  private readonly plot: uPlot;
  private readonly drawing = h("div", { class: "trace-plot", "aria-hidden": true });
  private lines: Line[] = [];

  constructor(private readonly title: string, unit: string, labels: string[], least: number) {
    const series = labels.map((label, k) => ({
      label,
      stroke: k % 2 === 0 ? blue : vermilion,
      width: k < 2 ? 2 : 1.6,
      ...(k < 2 ? {} : { dash }),
      points: { show: false },
      spanGaps: false,
    }));
    const axis = { font: "16px system-ui, sans-serif", stroke: "#333", grid: { stroke: "#e4e4e4", width: 1 } };
    this.plot = new uPlot(
      {
        width: 600,
        height: 200,
        cursor: { show: false },
        legend: { show: false },
        scales: {
          x: { time: false },
          y: { range: (_, low, high) => [Math.min(low ?? 0, -least) * 1.05, Math.max(high ?? 0, least) * 1.05] },
        },
        axes: [{ ...axis, size: 34 }, { ...axis, size: 64 }],
        series: [{}, ...series],
      },
      [[], ...labels.map(() => [])],
      this.drawing,
    );
    this.element = h(
      "figure",
      { class: "trace" },
      h(
        "figcaption",
        {},
        h("strong", {}, `${title} [${unit}]`),
        ...labels.map((label, k) =>
          h("span", { class: `key ${k % 2 === 0 ? "x" : "y"} ${k < 2 ? "" : "dashed"}` }, label)),
      ),
      this.drawing,
    );
    new ResizeObserver(() => {
      const { clientWidth, clientHeight } = this.drawing;
      if (clientWidth > 0 && clientHeight > 0) this.plot.setSize({ width: clientWidth, height: clientHeight });
    }).observe(this.drawing);
  }

  show(lines: Line[]): void {
    this.lines = lines;
  }

  draw(samples: Samples, to: number): void {
    const columns = samples.envelope(this.lines, to - span, to);
    this.plot.setData(columns as unknown as uPlot.AlignedData, false);
    this.plot.batch(() => {
      this.plot.setScale("x", { min: to - span, max: to });
      const values = columns.slice(1).flat().filter((value) => value !== null) as number[];
      let [low, high] = [0, 0];
      for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
      this.plot.setScale("y", { min: low, max: high });
    });
    this.drawing.dataset["title"] = this.title;
  }
}

/** The samples of the last seconds. */
class Samples {
  private times = new Float64Array(1 << 16);
  private rows = new Float32Array(this.times.length * 13);
  private from = 0;
  private to = 0; // exclusive; both grow, and are taken modulo the capacity

  clear(): void {
    this.from = this.to;
  }

  add(frame: Frame): void {
    const capacity = this.times.length;
    for (let i = 0; i < frame.samples; ++i) {
      const at = this.to++ % capacity;
      this.times[at] = frame.time + (frame.values[i * frame.columns] as number);
      this.rows.set(frame.values.subarray(i * frame.columns, i * frame.columns + 13), at * 13);
    }
    this.from = Math.max(this.from, this.to - capacity);
    while (this.from < this.to && this.time(this.from) < this.latest() - kept) ++this.from;
  }

  latest(): number {
    return this.to > this.from ? this.time(this.to - 1) : 0;
  }

  /** For each bucket with samples its lowest and its highest value, of every line; null where samples are missing. */
  envelope(lines: Line[], from: number, to: number): (number | null)[][] {
    const width = (to - from) / buckets;
    const columns: (number | null)[][] = [[], ...lines.map((): (number | null)[] => [])];
    let i = this.from;
    while (i < this.to && this.time(i) < from) ++i;
    const lows = new Float64Array(lines.length);
    const highs = new Float64Array(lines.length);
    let last = -1;
    while (i < this.to) {
      const bucket = Math.floor((this.time(i) - from) / width);
      lows.fill(Infinity);
      highs.fill(-Infinity);
      const begin = i;
      for (; i < this.to && (i === begin || this.time(i) < from + (bucket + 1) * width); ++i) {
        const row = (i % this.times.length) * 13;
        lines.forEach((line, k) => {
          const value = line.scale * ((this.rows[row + line.from] as number) - line.offset);
          if (value < (lows[k] as number)) lows[k] = value;
          if (value > (highs[k] as number)) highs[k] = value;
        });
      }
      const middle = from + (bucket + 0.5) * width;
      if (last >= 0 && bucket > last + 5) {
        columns[0]?.push(middle - width);
        for (const each of columns.slice(1)) each.push(null);
      }
      columns[0]?.push(middle - 0.2 * width, middle + 0.2 * width);
      lines.forEach((_, k) => columns[k + 1]?.push(lows[k] as number, highs[k] as number));
      last = bucket;
    }
    return columns;
  }

  private time(i: number): number {
    return this.times[i % this.times.length] as number;
  }
}

export class Traces {
  readonly element: HTMLElement;
  private readonly samples = new Samples();
  private readonly force = new Trace("Force of the hand on the robot", "N", ["x", "y", "command x", "command y"], 2);
  private readonly position = new Trace("Position from the test location", "mm", ["x", "y", "reference x", "reference y"], 5);
  private trial = -1;
  private fresh = false;

  constructor() {
    this.element = h("div", { class: "traces" }, this.force.element, this.position.element);
  }

  /** What belongs to the trial: where home is, and what its reference is. */
  choose(home: [number, number], referenceUnit: "m" | "N"): void {
    const line = (label: string, from: number, scale: number, offset: number): Line =>
      ({ label, colour: "", from, scale, offset });
    const nothing = (label: string) => line(label, column.time, 0, 0);
    const forces = [line("x", column.force, 1, 0), line("y", column.force + 1, 1, 0)];
    const places = [line("x", column.hand, 1000, home[0]), line("y", column.hand + 1, 1000, home[1])];
    const referenced = ["x", "y"].map((axis, k) =>
      line(axis, column.reference + k, referenceUnit === "N" ? 1 : 1000, referenceUnit === "N" ? 0 : (home[k] as number)));
    this.force.show([...forces, ...(referenceUnit === "N" ? referenced : ["x", "y"].map(nothing))]);
    this.position.show([...places, ...(referenceUnit === "m" ? referenced : ["x", "y"].map(nothing))]);
    this.force.element.classList.toggle("with-reference", referenceUnit === "N");
    this.position.element.classList.toggle("with-reference", referenceUnit === "m");
  }

  add(frame: Frame): void {
    if (frame.trial !== this.trial || frame.time < this.samples.latest() - 1e-9) {
      this.samples.clear();
      this.trial = frame.trial;
    }
    this.samples.add(frame);
    this.fresh = true;
  }

  /** Where something came. True where it was drawn. */
  draw(): boolean {
    if (!this.fresh) return false;
    this.fresh = false;
    const to = Math.max(this.samples.latest(), span);
    this.force.draw(this.samples, to);
    this.position.draw(this.samples, to);
    return true;
  }
}

// Force and position as they come: the last seconds, each pixel column from its lowest to its highest sample.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { h } from "../../report/src/dom";
import { type Frame, column } from "./stream";

const span = 8; // [s]
const buckets = 400; // over the span
const width = span / buckets; // [s]
const columns = 13;

interface Line {
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
  private lines: (Line | undefined)[] = [];

  constructor(title: string, unit: string, labels: string[], least: number) {
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

  /** Which column each line shows; undefined: none. */
  show(lines: (Line | undefined)[]): void {
    this.lines = lines;
  }

  draw(samples: Samples, to: number): void {
    const table = samples.lines(this.lines);
    let [low, high] = [0, 0];
    for (const values of table.slice(1)) {
      for (const value of values) {
        if (value === null) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    this.plot.batch(() => {
      this.plot.setData(table as unknown as uPlot.AlignedData, false);
      this.plot.setScale("x", { min: to - span, max: to });
      this.plot.setScale("y", { min: low, max: high });
    });
  }
}

/** The last seconds, in buckets of time that stay where they are, so that nothing shimmers: of each column the lowest and
 * the highest sample. */
class Samples {
  private readonly capacity = buckets + 2;
  private readonly lows = new Float32Array(this.capacity * columns);
  private readonly highs = new Float32Array(this.capacity * columns);
  private readonly numbers = new Int32Array(this.capacity).fill(-1); // of the bucket in each place
  private last = -1;

  clear(): void {
    this.numbers.fill(-1);
    this.last = -1;
  }

  add(frame: Frame): void {
    const { values } = frame;
    for (let i = 0; i < frame.samples; ++i) {
      const row = i * frame.columns;
      const number = Math.floor((frame.time + (values[row] as number)) / width);
      const at = number % this.capacity;
      const place = at * columns;
      const fresh = this.numbers[at] !== number;
      this.numbers[at] = this.last = number;
      for (let k = 1; k < columns; ++k) {
        const value = values[row + k] as number;
        if (fresh || value < (this.lows[place + k] as number)) this.lows[place + k] = value;
        if (fresh || value > (this.highs[place + k] as number)) this.highs[place + k] = value;
      }
    }
  }

  latest(): number {
    return (this.last + 1) * width;
  }

  /** Time, and of every line the lowest and the highest value of each bucket; null where there is none. */
  lines(lines: (Line | undefined)[]): (number | null)[][] {
    const table: (number | null)[][] = [[], ...lines.map((): (number | null)[] => [])];
    for (let number = Math.max(0, this.last - buckets); number <= this.last; ++number) {
      const at = number % this.capacity;
      const there = this.numbers[at] === number;
      const middle = (number + 0.5) * width;
      (table[0] as number[]).push(middle - 0.2 * width, middle + 0.2 * width);
      lines.forEach((line, k) => {
        const low = line && there ? line.scale * ((this.lows[at * columns + line.from] as number) - line.offset) : NaN;
        const high = line && there ? line.scale * ((this.highs[at * columns + line.from] as number) - line.offset) : NaN;
        (table[k + 1] as (number | null)[]).push(Number.isFinite(low) ? low : null, Number.isFinite(high) ? high : null);
      });
    }
    return table;
  }
}

export class Traces {
  readonly element: HTMLElement;
  private readonly samples = new Samples();
  private readonly force = new Trace("Force of the hand on the robot", "N", ["x", "y", "command x", "command y"], 2);
  private readonly position = new Trace("Position from the test location", "mm", ["x", "y", "reference x", "reference y"], 5);
  private trial = -1;
  private newest = 0; // [s]
  private fresh = false;

  constructor() {
    this.element = h("div", { class: "traces" }, this.force.element, this.position.element);
  }

  /** What belongs to the trial: where home is, and what its reference is. */
  choose(home: [number, number], referenceUnit: "m" | "N"): void {
    const pair = (from: number, scale: number, offset = [0, 0]): Line[] =>
      [0, 1].map((axis) => ({ from: from + axis, scale, offset: offset[axis] as number }));
    const millimetres = 1000;
    const force = referenceUnit === "N" ? pair(column.reference, 1) : [];
    const place = referenceUnit === "m" ? pair(column.reference, millimetres, home) : [];
    this.force.show([...pair(column.force, 1), force[0], force[1]]);
    this.position.show([...pair(column.hand, millimetres, home), place[0], place[1]]);
    this.force.element.classList.toggle("with-reference", referenceUnit === "N");
    this.position.element.classList.toggle("with-reference", referenceUnit === "m");
  }

  add(frame: Frame): void {
    if (frame.trial !== this.trial || frame.time < this.newest) {
      this.samples.clear();
      this.trial = frame.trial;
    }
    this.samples.add(frame);
    this.newest = frame.time;
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

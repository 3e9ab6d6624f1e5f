// Lines over the last seconds. Drawn anew is only what is new: the picture moves to the left by whole pixels, and behind it
// come the newest columns; all of it is drawn where the scale or the size changes.
import { h } from "@mbk/shared/dom";
import { type Samples, span, width } from "./samples";

export interface Line {
  from: number; // column
  scale: number;
  offset: number;
}

interface Colours {
  paper: string;
  label: string;
  grid: string;
  lines: string[]; // x and y, then their references
}
function colours(): Colours {
  const style = getComputedStyle(document.documentElement);
  const token = (name: string) => style.getPropertyValue(name).trim();
  return { paper: token("--paper"), label: token("--label"), grid: token("--grid"), lines: ["--first", "--second", "--first-reference", "--second-reference"].map(token) };
}
const [left, right, above, below] = [64, 16, 8, 30]; // around the lines [CSS pixels]
const overhang = 7; // of a time's label, to the left of the lines
const fontSize = 16;
const [leastBetweenValues, leastBetweenTimes] = [36, 48]; // [CSS pixels]
const steps = [1, 2, 5, 10];
const ends = [1, 1.5, 2, 3, 4, 5, 6, 8, 10];

/** The smallest of these numbers, times a power of ten, that is not below the value. */
function roundUp(value: number, digits: number[]): number {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * (digits.find((digit) => digit * power >= value * (1 - 1e-9)) ?? 10);
}

export class Plot {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { "aria-hidden": true });
  private readonly paint = this.canvas.getContext("2d", { alpha: false }) as CanvasRenderingContext2D;
  private colours = colours();
  private sharp = devicePixelRatio;
  private lines: (Line | undefined)[] = [];
  private low: number; // ends of the scale
  private high: number;
  private whole = true; // all of it has to be drawn
  private moved = 0; // what went out at the left, since time 0 [pixels]
  private upTo = 0; // time at the right edge [s]
  private last = -1; // bucket that was drawn last, and may have grown since
  private labels: { time: number; half: number }[] = []; // that are shown below

  /** @param least  the scale holds at least that, to both sides   @param resized  draws the lines again */
  constructor(title: string, unit: string, names: string[], private readonly least: number, resized: () => void) {
    [this.low, this.high] = [-least, least];
    const drawing = h("div", { class: "trace-plot" }, this.canvas);
    this.element = h("figure", { class: "trace" },
      h("figcaption", {}, h("strong", {}, `${title} [${unit}]`),
        ...names.map((name, k) => h("span", { class: `key ${k % 2 === 0 ? "x" : "y"} ${k < 2 ? "" : "reference"}` }, name))),
      drawing, h("p", { class: "axis-title" }, "Time [s]"));
    new ResizeObserver(() => {
      const { clientWidth, clientHeight } = drawing;
      if (clientWidth <= left + right || clientHeight <= above + below) return; // not shown
      this.sharp = devicePixelRatio;
      this.canvas.width = Math.round(clientWidth * this.sharp);
      this.canvas.height = Math.round(clientHeight * this.sharp);
      this.clear();
      resized();
    }).observe(drawing);
    this.clear();
  }

  /** Which column each line shows; undefined: none. */
  show(lines: (Line | undefined)[]): void {
    this.lines = lines;
    this.whole = true;
  }

  /** The screen's user likes it dark now, or light again. */
  recolour(): void {
    this.colours = colours();
    this.clear();
  }

  /** Nothing but the axes, until there is something. */
  clear(): void {
    this.whole = true;
    this.begin(span);
  }

  draw(samples: Samples, to: number): void {
    this.choose(samples);
    const moved = Math.floor(to * this.perSecond) - this.moved;
    if (this.whole || moved < 0 || moved >= this.inside) {
      this.begin(to);
      this.draws(samples, samples.first, this.x0);
    } else {
      if (moved > 0) this.move(moved, to);
      // what the line drew before the last bucket stays; its ends are round, so that nothing of it reaches further
      const reach = Math.ceil(3 * this.sharp);
      const from = Math.max(this.x0, Math.floor(this.x((this.last - 0.5) * width)) - reach);
      this.emptied(from);
      const hidden = Math.ceil(reach / (width * this.perSecond)); // buckets that the reach covers
      this.draws(samples, Math.max(samples.first, this.last - 3 - hidden), from);
    }
    this.whole = false;
    this.last = samples.last;
  }

  private get x0(): number {
    return Math.round(left * this.sharp);
  }
  private get inside(): number {
    return this.canvas.width - Math.round((left + right) * this.sharp);
  }
  private get bottom(): number {
    return this.canvas.height - Math.round(below * this.sharp);
  }
  private get perSecond(): number {
    return this.inside / span;
  }
  private x(time: number): number {
    return this.x0 + this.inside + time * this.perSecond - this.moved;
  }
  private y(value: number): number {
    const top = above * this.sharp;
    return top + ((this.high - value) / (this.high - this.low)) * (this.bottom - top);
  }

  /** Ends of the scale that stay where they are for a while: a scale that moves cannot be read. */
  private choose(samples: Samples): void {
    let [low, high] = [-this.least, this.least];
    for (const line of this.lines) {
      if (!line) continue;
      for (let number = samples.first; number <= samples.last; ++number) {
        const [from, to] = [samples.low(number, line.from), samples.high(number, line.from)];
        for (const value of [line.scale * (from - line.offset), line.scale * (to - line.offset)]) {
          if (value < low) low = value;
          if (value > high) high = value;
        }
      }
    }
    const end = (now: number, requested: number): number => {
      const fits = roundUp(requested, ends);
      return fits > now || roundUp(1.3 * requested, ends) < now ? fits : now;
    };
    const [from, to] = [-end(-this.low, -low), end(this.high, high)];
    if (from !== this.low || to !== this.high) this.whole = true;
    [this.low, this.high] = [from, to];
  }

  /** The axes, without a line. */
  private begin(to: number): void {
    const { paint, canvas, sharp } = this;
    this.moved = Math.floor(to * this.perSecond);
    this.upTo = to;
    this.labels = [];
    paint.fillStyle = this.colours.paper;
    paint.fillRect(0, 0, canvas.width, canvas.height);
    this.emptied(this.x0);
    paint.font = `${fontSize * sharp}px system-ui, sans-serif`;
    paint.fillStyle = this.colours.label;
    paint.textAlign = "right";
    paint.textBaseline = "middle";
    const step = this.valueStep;
    for (let k = Math.ceil(this.low / step); k * step <= this.high; ++k) {
      const words = (k * step).toFixed(Math.max(0, -Math.floor(Math.log10(step)))).replace("-", "−");
      paint.fillText(words, this.x0 - 8 * sharp, this.y(k * step));
    }
    this.label(to - span, to);
  }

  private get valueStep(): number {
    const most = (this.bottom - above * this.sharp) / (leastBetweenValues * this.sharp);
    return roundUp((this.high - this.low) / Math.max(most, 1), steps);
  }
  private get timeStep(): number {
    return roundUp(Math.max(1, (leastBetweenTimes * this.sharp) / this.perSecond), steps);
  }

  /** Times behind `from`, up to `to`. */
  private label(from: number, to: number): void {
    const { paint, sharp } = this;
    paint.fillStyle = this.colours.label;
    paint.textAlign = "center";
    paint.textBaseline = "top";
    const step = this.timeStep;
    for (let k = Math.max(0, Math.floor(from / step)); k * step <= to; ++k) {
      if (k * step <= from && k > 0) continue;
      const words = String(k * step);
      const half = paint.measureText(words).width / 2 + sharp;
      if (this.x(k * step) - half < this.x0 - overhang * sharp) continue;
      paint.fillText(words, this.x(k * step), this.bottom + 8 * sharp);
      this.labels.push({ time: k * step, half });
    }
  }

  /** To the left, with the times; one that would be cut goes. */
  private move(by: number, to: number): void {
    const { paint, canvas, sharp, x0, bottom } = this;
    const kept = canvas.width - x0 - by;
    paint.drawImage(canvas, x0 + by, 0, kept, canvas.height, x0, 0, kept, canvas.height);
    paint.fillStyle = this.colours.paper;
    paint.fillRect(canvas.width - by, 0, by, canvas.height);
    this.moved += by;
    const begin = x0 - overhang * sharp;
    for (let first = this.labels[0]; first && this.x(first.time) - first.half < x0; first = this.labels[0]) {
      const end = Math.max(x0, Math.ceil(this.x(first.time) + first.half)); // what is left of the lines does not move
      paint.fillRect(begin, bottom + 1, end - begin, canvas.height - bottom - 1);
      this.labels.shift();
    }
    this.label(this.upTo, to);
    this.upTo = to;
  }

  /** From there to the right: the grid alone. */
  private emptied(from: number): void {
    const { paint, canvas, sharp, bottom } = this;
    const end = this.x0 + this.inside;
    const thin = Math.max(1, Math.round(sharp));
    paint.fillStyle = this.colours.paper;
    paint.fillRect(from, 0, canvas.width - from, bottom);
    paint.fillStyle = this.colours.grid;
    const values = this.valueStep;
    for (let k = Math.ceil(this.low / values); k * values <= this.high; ++k) {
      paint.fillRect(from, Math.round(this.y(k * values)), end - from, thin);
    }
    const times = this.timeStep;
    for (let k = Math.max(0, Math.floor((this.moved - this.inside) / this.perSecond / times)); ; ++k) {
      const x = Math.floor(this.x(k * times));
      if (x >= end) break;
      if (x >= from) paint.fillRect(x, Math.round(above * sharp), thin, bottom - Math.round(above * sharp));
    }
  }

  /** The lines from a bucket on, to the right of a pixel. */
  private draws(samples: Samples, first: number, from: number): void {
    const { paint, sharp } = this;
    paint.save();
    paint.beginPath();
    paint.rect(from, 0, this.x0 + this.inside - from, this.bottom);
    paint.clip();
    paint.lineJoin = "round";
    for (const [k, line] of this.lines.entries()) { // references, which are thinner, above what was measured: both are seen where they agree
      if (!line) continue;
      paint.strokeStyle = this.colours.lines[k] as string;
      paint.lineWidth = (k < 2 ? 2 : 1.25) * sharp;
      paint.beginPath();
      let drawing = false;
      let before = NaN; // twice the middle of the bucket before
      const to = (time: number, value: number): void => {
        const [x, y] = [this.x(time * width), this.y(line.scale * (value - line.offset))];
        if (drawing) paint.lineTo(x, y);
        else paint.moveTo(x, y);
        drawing = true;
      };
      for (let number = first; number <= samples.last; ++number) {
        const [low, high] = [samples.low(number, line.from), samples.high(number, line.from)];
        const falls = low + high < before;
        before = low + high;
        if (!Number.isFinite(before)) {
          drawing = false;
        } else if (k >= 2) { // one point, or it would be a band
          to(number + 0.5, before / 2);
        } else {
          to(number + 0.3, falls ? high : low);
          to(number + 0.7, falls ? low : high);
        }
      }
      paint.stroke();
    }
    paint.restore();
  }
}

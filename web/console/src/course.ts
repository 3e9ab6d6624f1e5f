// The whole of a trial as small as a line of text: its force over time, in which a window is drawn with the pointer.
import type { ExcludedWindow } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { column, type Frame } from "./stream";

const count = 300; // bins, whatever the duration

/** The largest force of the hand in each bin of time, whose width doubles where they do not suffice. */
export class Course {
  private readonly largest = new Float32Array(count); // [N]
  width = 0.02; // of a bin [s]

  add(frame: Frame): void {
    const { values } = frame;
    for (let row = 0; row < values.length; row += frame.columns) {
      const time = frame.time + (values[row] as number);
      while (time >= count * this.width) this.widen();
      const bin = Math.floor(time / this.width);
      const force = Math.hypot(values[row + column.force] as number, values[row + column.force + 1] as number);
      if (force > (this.largest[bin] as number)) this.largest[bin] = force;
    }
  }

  at(time: number): number {
    return this.largest[Math.floor(time / this.width)] ?? 0;
  }

  private widen(): void {
    for (let bin = 0; bin < count / 2; ++bin) this.largest[bin] = Math.max(this.largest[2 * bin] as number, this.largest[2 * bin + 1] as number);
    this.largest.fill(0, count / 2);
    this.width *= 2;
  }
}

const [width, height] = [720, 72]; // [px]

interface Shown {
  course: Course | undefined;
  duration: number; // [s]
  excluded: ExcludedWindow[];
  chosen: { from_s: number; to_s: number } | undefined;
}

/** A picture of a course, with what is excluded of it; where the pointer is dragged over it a window is chosen. */
export class CoursePicture {
  readonly element: HTMLElement;
  private readonly canvas = h("canvas", { width, height, "aria-hidden": true }); // the fields say the same
  private shown: Shown | undefined;

  constructor(choose: (from: number, to: number) => void) {
    this.element = h("figure", { class: "course" }, h("figcaption", {}, "Force of the hand [N] over the trial: drag to choose a window"), this.canvas);
    let from: number | undefined;
    const time = (event: PointerEvent) => Math.min(Math.max(event.offsetX / this.canvas.clientWidth, 0), 1) * (this.shown?.duration ?? 0);
    this.canvas.addEventListener("pointerdown", (event) => {
      from = time(event);
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (from === undefined) return;
      const to = time(event);
      choose(Math.min(from, to), Math.max(from, to));
    });
    for (const over of ["pointerup", "pointercancel"] as const) this.canvas.addEventListener(over, () => (from = undefined));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.shown && this.draw(this.shown));
  }

  draw(shown: Shown): void {
    const { course, duration, excluded, chosen } = (this.shown = shown);
    this.element.hidden = !course;
    if (!course) return;
    const paint = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    const style = getComputedStyle(document.documentElement);
    const fill = (token: string) => (paint.fillStyle = style.getPropertyValue(token));
    paint.clearRect(0, 0, width, height);
    const band = ({ from_s, to_s }: { from_s: number; to_s: number }) => paint.fillRect((width * from_s) / duration, 0, (width * (to_s - from_s)) / duration, height);
    const forces = Array.from({ length: width }, (_, x) => course.at(((x + 0.5) * duration) / width));
    const largest = Math.max(...forces, 1e-9);
    fill("--first");
    forces.forEach((force, x) => paint.fillRect(x, height - (height * force) / largest, 1, (height * force) / largest));
    paint.globalAlpha = 0.35;
    fill("--bad");
    excluded.forEach(band);
    fill("--ink");
    if (chosen) band(chosen);
    paint.globalAlpha = 1;
  }
}

// Force and position as they come: the last seconds, each pixel column from its lowest to its highest sample.
import { h } from "@mbk/shared/dom";
import { type Line, Plot } from "./plot";
import { Samples, span } from "./samples";
import { column, type Frame } from "./stream";

export class Traces {
  readonly element: HTMLElement;
  private readonly samples = new Samples();
  private readonly force = new Plot("Force of the hand on the robot", "N", ["x", "y", "−command x", "−command y"], 2, () => this.again(this.force));
  private readonly position = new Plot("Position from the test location", "mm", ["x", "y", "reference x", "reference y"], 5, () => this.again(this.position));
  private trial = -1;
  private newest = 0; // first sample of the newest frame [s]
  private fresh = false;

  constructor() {
    this.element = h("div", { class: "traces" }, this.force.element, this.position.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const plot of [this.force, this.position]) {
        plot.recolour();
        this.again(plot);
      }
    });
  }

  /** What belongs to the trial: where home is, and what its reference is. */
  choose(home: [number, number], referenceUnit: "m" | "N"): void {
    const pair = (from: number, scale: number, offset = [0, 0]): Line[] =>
      [0, 1].map((axis) => ({ from: from + axis, scale, offset: offset[axis] as number }));
    const millimetres = 1000;
    const force = referenceUnit === "N" ? pair(column.reference, -1) : []; // what the hand answers the robot's command with
    const place = referenceUnit === "m" ? pair(column.reference, millimetres, home) : [];
    this.force.show([...pair(column.force, 1), force[0], force[1]]);
    this.position.show([...pair(column.hand, millimetres, home), place[0], place[1]]);
    this.force.element.classList.toggle("with-reference", referenceUnit === "N");
    this.position.element.classList.toggle("with-reference", referenceUnit === "m");
  }

  add(frame: Frame): void {
    if (frame.trial !== this.trial || frame.time < this.newest) {
      this.samples.clear();
      for (const plot of [this.force, this.position]) plot.clear();
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
    for (const plot of [this.force, this.position]) this.again(plot);
    return true;
  }

  private again(plot: Plot): void {
    if (this.samples.last >= 0) plot.draw(this.samples, Math.max(this.samples.newest, span));
  }
}

// What the loop and the disk do: problems in front, the rest behind a summary.
import type { State, You } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { histogram, time } from "./histogram";
import { text } from "./words";

const period = 1000; // of a tick [µs]
const littleSpace = 1e9; // [bytes]

export class MachinePanel {
  readonly element: HTMLElement;
  private readonly problems = h("ul", { class: "problems", role: "status" });
  private readonly summary = h("summary", {});
  private readonly histograms = h("div", { class: "histograms" });
  private readonly facts = h("p", { class: "facts-line" });
  private readonly details = h("details", { class: "machine" }, this.summary, this.histograms, this.facts);
  private next = 0;
  private again: (() => void) | undefined;

  constructor() {
    this.element = h("section", { "aria-label": "Timing of the loop" }, this.problems, this.details);
    this.details.addEventListener("toggle", () => {
      this.next = 0;
      this.again?.();
    });
  }

  show(state: State, you: You): void {
    this.again = () => this.show(state, you);
    const problems = this.found(state);
    const shown = [...this.problems.children].map((item) => item.textContent);
    const words = problems.map((problem) => `▲ ${problem}`);
    if (shown.join("\n") !== words.join("\n")) this.problems.replaceChildren(...words.map((one) => h("li", {}, one)));
    text(this.summary, `Timing of the loop: ${state.ticks === 0 ? "no trial yet" : problems.length > 0 ? "see above" : "OK"}`);
    if (!this.details.open) return;
    text(this.facts, [
      `${state.ticks} ticks, ${state.dropped_ticks} dropped`,
      `${(state.disk_free_bytes / 1e9).toFixed(1)} GB free on the disk`,
      `${state.viewers} ${state.viewers === 1 ? "page" : "pages"} open`,
      you.dropped_frames > 0 ? `${you.dropped_frames} frames dropped by this page` : "",
    ].filter(Boolean).join(" · "));
    this.draw(state);
  }

  private found({ dropped_ticks, times, disk_free_bytes, ticks }: State): string[] {
    return [
      dropped_ticks > 0 && `${dropped_ticks} ${dropped_ticks === 1 ? "tick was" : "ticks were"} dropped: the recording has ${dropped_ticks === 1 ? "a gap" : "gaps"}`,
      ticks > 0 && times.lateness.p999_us > period && `One tick in a thousand is more than ${time(times.lateness.p999_us)} late`,
      disk_free_bytes > 0 && disk_free_bytes < littleSpace && `The disk is nearly full: ${(disk_free_bytes / 1e9).toFixed(2)} GB free`,
    ].filter((problem) => problem !== false);
  }

  /** Once a second: a second page on the same machine wants its part of the processor too. */
  private draw(state: State): void {
    const now = performance.now();
    if (now < this.next && state.running) return;
    this.next = now + 1000;
    this.histograms.replaceChildren(
      histogram("Computing a tick:", state.times.compute, period),
      histogram("Lateness of a tick:", state.times.lateness, period));
  }
}

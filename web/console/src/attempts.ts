// The trials that were performed: how good each is, and which are excluded, whole or in a window.
import type { ConsoleCommand, PerformedTrial } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { fixed } from "@mbk/shared/format";
import { Course, CoursePicture } from "./course";
import type { Frame } from "./stream";
import { clock, text } from "./words";

export const gradeSigns = { "": "…", recorded: "✓", good: "✓", poor: "▲", stopped: "■", tripped: "■" };
export const gradeWords = {
  "": "not judged yet", recorded: "completed, not measured", good: "completed and good", poor: "completed, but poor",
  stopped: "stopped", tripped: "safety stop",
};

/** "97.1 % in x, 95.0 % in y": what the model explains. */
const shares = (vaf: number[]): string => vaf.map((value, k) => `${fixed(value, 1)} % in ${"xy"[k]}`).join(", ");

const capital = (words: string): string => `${words.slice(0, 1).toUpperCase()}${words.slice(1)}`;

/** What a trial that is over is worth, with the reason. */
export function verdict({ grade, why, vaf }: PerformedTrial): HTMLElement {
  const reason = grade === "good" ? `The model explains ${shares(vaf)} of the force.` : why && `${capital(why)}.`;
  return h("div", { class: `verdict ${grade}` },
    h("p", { class: "verdict-title" }, h("span", { "aria-hidden": true }, `${gradeSigns[grade]} `), capital(gradeWords[grade])),
    reason ? h("p", {}, reason) : undefined);
}

const begin = 1; // a page that has seen a trial from then on has seen it whole [s]
const percent = (part: number, whole: number): string => `${(100 * part) / whole}%`;

export class AttemptsPanel {
  readonly element = h("section", { class: "attempts", "aria-labelledby": "attempts-title" });
  private attempts: PerformedTrial[] = [];
  private mayExclude = false;
  private chosen = 0; // number of an attempt; 0: none
  private readonly courses = new Map<number, Course>(); // of attempts that this page has seen from their begin
  private readonly picture = new CoursePicture((from, to) => {
    [this.from.value, this.to.value] = [from, to].map((time) => (Math.floor(100 * time) / 100).toFixed(2)) as [string, string];
    this.name();
  });
  private readonly list = h("ol", { class: "attempt-list" });
  private readonly none = h("p", { class: "not-yet" }, "No trial has been performed yet.");
  private readonly form = h("form", { class: "exclusion" });
  private readonly title = h("p", { class: "exclusion-title" });
  private readonly from = h("input", { type: "number", name: "from", min: 0, step: "any", inputmode: "decimal" });
  private readonly to = h("input", { type: "number", name: "to", min: 0, step: "any", inputmode: "decimal" });
  private readonly why = h("input", { type: "text", name: "why", maxlength: 300, required: true, autocomplete: "off" });
  private readonly exclude = h("button", { type: "submit" }, "Exclude the trial");
  private readonly include = h("button", { type: "button" }, "Include it again");
  private readonly excluded = h("ul", { class: "excluded-list" });

  constructor(private readonly tell: (command: ConsoleCommand) => boolean) {
    this.form.append(this.title, this.picture.element, this.excluded,
      h("label", {}, "from ", this.from, " s"), h("label", {}, "to ", this.to, " s"),
      h("p", { class: "hint" }, "Without times the whole trial is excluded."),
      h("label", { class: "why" }, "Reason ", this.why), h("div", { class: "exclusion-buttons" }, this.exclude, this.include));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.submit();
    });
    this.form.addEventListener("input", () => this.name());
    this.include.addEventListener("click", () => this.tell({ command: "include", attempt: this.chosen }));
    this.element.append(h("h2", { id: "attempts-title" }, "Performed trials"), this.none, this.list, this.form);
    this.draw();
  }

  /** Of the attempts of a trial in the list, the last one. */
  lastOf(trial: number): PerformedTrial | undefined {
    return this.attempts.filter((one) => one.trial === trial).at(-1);
  }
  get last(): PerformedTrial | undefined {
    return this.attempts.at(-1);
  }

  show(attempts: PerformedTrial[]): void {
    this.attempts = attempts;
    this.draw();
  }

  /** Samples of the trial that runs. */
  add(frame: Frame): void {
    const number = this.last?.number;
    if (number === undefined || this.last?.grade !== "") return;
    if (!this.courses.has(number) && frame.time < begin) this.courses.set(number, new Course());
    this.courses.get(number)?.add(frame);
  }

  allow(mayExclude: boolean): void {
    if (mayExclude === this.mayExclude) return;
    this.mayExclude = mayExclude;
    this.draw();
  }

  private submit(): void {
    const reason = this.why.value.trim();
    if (!reason) return;
    const window = this.window();
    if (this.tell({ command: "exclude", attempt: this.chosen, text: reason, ...window })) this.empty();
  }

  private empty(): void {
    this.from.value = this.to.value = this.why.value = "";
    this.name();
  }

  /** The window that is typed in; one end alone goes to that of the trial. */
  private window(): { from_s: number; to_s: number } | undefined {
    if (this.from.value === "" && this.to.value === "") return undefined;
    return { from_s: Number(this.from.value || 0), to_s: this.to.value === "" ? this.ofChosen()?.duration_s ?? 0 : Number(this.to.value) };
  }

  private name(): void {
    const chosen = this.ofChosen();
    if (chosen) this.picture.draw({ course: this.courses.get(chosen.number), duration: chosen.duration_s, excluded: chosen.windows, chosen: this.window() });
    text(this.exclude, this.window() ? "Exclude the window" : "Exclude the trial");
  }

  private ofChosen(): PerformedTrial | undefined {
    return this.attempts.find((one) => one.number === this.chosen);
  }

  private choose(number: number): void {
    this.chosen = this.chosen === number ? 0 : number;
    this.empty();
    this.draw();
    this.list.querySelector<HTMLElement>(`[data-attempt="${number}"]`)?.focus();
  }

  private draw(): void {
    this.none.hidden = this.attempts.length > 0;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset["attempt"] : undefined;
    this.list.replaceChildren(...[...this.attempts].reverse().map((one) => h("li", {}, this.row(one))));
    if (focused) this.list.querySelector<HTMLElement>(`[data-attempt="${focused}"]`)?.focus();
    const chosen = this.ofChosen();
    this.form.hidden = !chosen || chosen.grade === "" || !this.mayExclude;
    if (!chosen) return;
    text(this.title, `Trial ${chosen.number}, ${chosen.name}: ${chosen.duration_s.toFixed(1)} s`);
    for (const field of [this.from, this.to]) field.max = String(chosen.duration_s);
    const excluded = [
      ...(chosen.excluded ? [`Excluded: ${chosen.excluded}`] : []),
      ...chosen.windows.map(({ from_s, to_s, why }) => `${from_s} to ${to_s} s excluded: ${why}`),
    ];
    this.excluded.replaceChildren(...excluded.map((words) => h("li", {}, words)));
    this.include.hidden = excluded.length === 0;
    this.name();
  }

  private row(one: PerformedTrial): HTMLElement {
    const least = one.vaf.length > 0 ? Math.min(...one.vaf) : undefined;
    const button = h("button", {
      type: "button", class: `attempt ${one.grade} ${one.excluded ? "excluded" : ""}`, "data-attempt": one.number,
      "aria-pressed": String(one.number === this.chosen), title: one.why,
    },
      h("span", { class: "sign", "aria-hidden": true }, gradeSigns[one.grade]),
      h("span", { class: "attempt-name" }, `${one.number} ${one.name}`),
      h("span", { class: "quality" }, ...(least === undefined ? [] : [h("span", { class: "quality-bar", style: `width: ${percent(Math.max(least, 0), 100)}` })])),
      h("span", { class: "attempt-words" }, [
        one.excluded ? `excluded: ${one.excluded}` : one.duration_s > 0 ? gradeWords[one.grade] : "running",
        least !== undefined && `${fixed(least, 0)} % explained`,
        one.windows.length > 0 && `${one.windows.length} ${one.windows.length === 1 ? "window" : "windows"} excluded`,
        one.duration_s > 0 && clock(one.duration_s),
      ].filter(Boolean).join(" · ")));
    button.addEventListener("click", () => this.choose(one.number));
    return button;
  }
}

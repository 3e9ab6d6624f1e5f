// The operator's page: state, safety, and next actions.
import type { ConsoleCommand, ListedTrial, RobotState, State, You } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { AttemptsPanel, gradeSigns, verdict } from "./attempts";
import { ControlLine } from "./control";
import { EstimatePanel } from "./estimate";
import { MachinePanel } from "./machine";
import { Stream } from "./stream";
import { Traces } from "./traces";
import { clock, seconds, text } from "./words";

const signs = { waiting: "○", running: "▶", done: "✓", stopped: "■" };

/** Where the space bar writes, and stops nothing. */
const writes = (target: EventTarget | null): target is HTMLElement =>
  target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && (target.type === "text" || target.type === "number"));

/** State of the robot's motors in one line: during a trial the command, otherwise what the robot reports. */
function robotWords({ running, ticks, safety, robot: { motors, confirmed_off, stop_button, link, fault, sentence } }: State): string {
  if (running && confirmed_off !== false) {
    if (safety.enabled) return "The motors are commanded on.";
    return ticks === 0 ? "The trial is starting." : "The motors are commanded off; the robot has not confirmed it yet.";
  }
  const reported = { off: "reports its motors off", on: "reports its motors on", unknown: "has not reported whether its motors are on" }[motors];
  return [
    link ? `The robot ${reported}${confirmed_off ? ", confirmed after the stop" : ""}` : "The robot sends no states; what it is doing is not known",
    stop_button && "its stop button is pressed",
    fault !== 0 && `its fault code is ${fault}`,
  ].filter(Boolean).join("; ") + (sentence && confirmed_off !== false ? `. ${sentence}` : ".");
}

class OperatorPage {
  private state: State | undefined;
  private you: You = { type: "you", control: "nobody", may_control: false, dropped_frames: 0 };
  private connected = false;
  private pressed = false; // stop was pressed, and the answer is not there yet
  private shown = "";
  private readonly traces = new Traces();
  private readonly estimate = new EstimatePanel();
  private readonly machine = new MachinePanel();
  private readonly attempts = new AttemptsPanel((command) => this.tell(command));
  private readonly control = new ControlLine(() => this.tell({ command: "control" }));
  private frames = 0;
  private counted = performance.now();

  private readonly banner = h("div", { class: "banner", role: "status", "aria-live": "assertive" });
  private readonly bannerTitle = h("p", { class: "banner-title" });
  private readonly bannerWords = h("p", { class: "banner-words" });
  private readonly robot = h("p", { class: "robot" });
  private readonly alarm = h("div", { class: "alarm", role: "alert" }); // empty where there is none
  private readonly stopWord = h("span", {}, "STOP");
  private readonly stopHint = h("small", {}, "space bar");
  private readonly stop = h("button", { type: "button", class: "stop" }, h("span", { "aria-hidden": true }, "■ "), this.stopWord, this.stopHint);
  private readonly phase = h("p", { class: "phase" });
  private readonly progress = h("progress", { max: 1, value: 0, "aria-label": "Progress of the trial" });
  private readonly time = h("p", { class: "time" });
  private readonly trials = h("ol", { class: "trials" });
  private readonly verdict = h("div", { role: "status" });
  private readonly actions = h("div", { class: "actions", role: "group", "aria-label": "What next" });
  private readonly said = h("p", { class: "said", role: "status" });
  private readonly note = h("textarea", { id: "note", rows: 2, maxlength: 600 });
  private readonly addNote = h("button", { type: "submit" }, "Add the note");
  private readonly notes = h("ul", { class: "notes" });
  private readonly links = h("p", { class: "links" });

  private readonly stream = new Stream({
    state: (state) => {
      this.state = state;
      this.draw();
    },
    session: ({ attempts }) => {
      this.attempts.show(attempts);
      this.shown = "";
      this.draw();
    },
    estimate: (estimate) => this.estimate.show(estimate),
    frame: (frame) => {
      this.traces.add(frame);
      this.attempts.add(frame);
    },
    you: (you) => {
      this.you = you;
      this.draw();
    },
    refused: (why) => text(this.said, `Refused: ${why}.`),
    connected: (connected) => {
      this.connected = connected;
      this.draw();
    },
  });

  constructor(root: HTMLElement) {
    this.banner.append(h("div", {}, this.bannerTitle, this.bannerWords, this.robot));
    const notes = h("form", { class: "note-form" },
      h("label", { for: "note" }, "Note for the recording ", h("small", {}, "(the space bar types a space here; Esc leaves the field)")), this.note, this.addNote);
    notes.addEventListener("submit", (event) => {
      event.preventDefault();
      const words = this.note.value.trim();
      if (words && this.tell({ command: "note", text: words })) this.note.value = "";
      this.note.blur();
    });
    root.replaceWith(
      h("div", { class: "operator" },
        h("header", {}, this.alarm, this.banner, this.stop, this.control.element),
        h("main", {},
          h("section", { class: "now", "aria-labelledby": "now-title" },
            h("h1", { id: "now-title" }, "Trials"), this.phase, this.progress, this.time, this.verdict, this.actions, this.said, this.trials, notes, this.notes),
          h("div", { class: "signals" }, h("section", { "aria-label": "Live signals" }, this.traces.element),
            this.machine.element, this.attempts.element),
          this.estimate.element),
        h("footer", {}, this.links)));
    // when it goes down, not when it is let go; a click without a pointer is that of a keyboard or a reading aid
    this.stop.addEventListener("pointerdown", ({ button }) => button === 0 && this.pressStop());
    this.stop.addEventListener("click", ({ detail }) => detail === 0 && this.pressStop());
    addEventListener("keydown", (event) => this.key(event), { capture: true });
    addEventListener("keyup", (event) => {
      if (event.code === "Space" && !writes(event.target)) event.preventDefault();
    }, { capture: true });
    const paint = () => {
      if (this.traces.draw()) ++this.frames;
      requestAnimationFrame(paint);
    };
    requestAnimationFrame(paint);
    setInterval(() => this.count(), 1000);
    this.draw();
  }

  private key(event: KeyboardEvent): void {
    if (writes(event.target)) {
      if (event.key === "Escape") event.target.blur();
      return;
    }
    if (event.code !== "Space") return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) this.pressStop();
  }

  private pressStop(): void {
    this.pressed = this.tell({ command: "stop" });
    this.draw();
  }

  private tell(command: ConsoleCommand): boolean {
    text(this.said, "");
    const sent = this.stream.send(command);
    if (!sent) text(this.said, "Not sent: the connection is lost.");
    return sent;
  }

  /** Frames that were drawn in the last second: for whoever measures it. */
  private count(): void {
    const now = performance.now();
    document.documentElement.dataset["framesPerSecond"] = ((1000 * this.frames) / (now - this.counted)).toFixed(1);
    this.frames = 0;
    this.counted = now;
  }

  private draw(): void {
    const { state } = this;
    this.drawBanner(state);
    this.drawStop(state);
    this.control.show(this.you, this.connected, state);
    if (!state) return;
    const trial = state.trials[state.current] as ListedTrial;
    document.title = `${state.robot.confirmed_off === false ? "MOTORS NOT CONFIRMED OFF – " : state.safety.tripped ? "STOPPED – " : ""}${trial.name} – mbk console`;
    text(this.phase, state.over ? "the session is over" : state.running ? state.phase : this.waitingFor(state));
    this.progress.value = state.running && state.duration_s > 0 ? Math.min(state.time_s / state.duration_s, 1) : 0;
    text(this.time, state.running
      ? `${clock(state.time_s)} of about ${clock(state.duration_s)}${state.perturbing ? ` · perturbation ${seconds(state.perturbation_s)} of ${seconds(trial.duration_s)}` : ""}`
      : "");
    if (state.said) text(this.said, state.said);
    this.drawRarely(state);
    this.machine.show(state, this.you);
  }

  /** Loud while it has something to stop; after a stop it says that it is in effect, and still takes another one. */
  private drawStop(state: State | undefined): void {
    const inEffect = this.connected && state?.safety.tripped === true;
    this.stop.disabled = !this.connected || !state || state.over;
    this.stop.classList.toggle("in-effect", inEffect);
    text(this.stopWord, inEffect ? "STOPPED" : "STOP");
    text(this.stopHint, inEffect ? "in effect until reset" : this.controls ? "space bar" : "space bar, also on this page");
  }

  private get controls(): boolean {
    return this.you.control === "here";
  }

  private waitingFor(state: State): string {
    return { "": "analysing the recording", begin: "ready", after: "what next?", reset: "stopped" }[state.question];
  }

  private drawBanner(state: State | undefined): void {
    const [kind, title, words] = this.situation(state);
    if (!this.banner.classList.contains(kind)) this.banner.className = `banner ${kind}`;
    text(this.bannerTitle, title);
    text(this.bannerWords, words);
    text(this.robot, state && this.connected ? robotWords(state) : "");
    if (state) this.drawAlarm(state.robot);
  }

  /** Stays when the connection is lost: nothing has taken it back. */
  private drawAlarm({ confirmed_off, sentence }: RobotState): void {
    const words = confirmed_off === false ? ["MOTORS NOT CONFIRMED OFF — cut the motors' power with the hardware stop button", sentence].filter(Boolean) : [];
    const shown = [...this.alarm.children].map((line) => line.textContent);
    if (shown.join("\n") !== words.join("\n")) this.alarm.replaceChildren(...words.map((line) => h("p", {}, line)));
  }

  private situation(state: State | undefined): [string, string, string] {
    if (!this.connected && state?.over) return ["rest", "○ The session is over", "mbk has ended. This page can be closed."];
    if (!this.connected) {
      return ["lost", "✕ Connection lost", "The values shown are old, and this page cannot stop the robot. Use the hardware stop button, which cuts the motors' power, or the terminal. Reconnecting …"];
    }
    if (!state) return ["rest", "Connecting …", ""];
    if (state.safety.tripped) {
      this.pressed = false;
      return ["tripped", "■ Stopped", state.safety.sentence];
    }
    if (this.pressed) return ["tripped", "■ Stopping …", ""];
    if (state.over) return ["rest", "○ The session is over", "The reports can still be opened. Closing this page ends mbk."];
    if (!state.running) return this.atRest(state);
    if (state.robot.confirmed_off === false) return ["tripped", "■ The robot does not answer", state.robot.sentence];
    if (state.phase === "done") return ["care", "▲ The motors are commanded off", "The robot has not confirmed it yet."];
    if (state.safety.cut) return ["care", "▲ Running, torque limited", "The controller requests more torque than the safety gate allows."];
    return ["running", "▶ Running", "Within all limits."];
  }

  private atRest(state: State): [string, string, string] {
    if (state.robot.link && state.robot.stop_button) return ["care", "■ Stop button pressed", "Nothing moves until it is released."];
    const [kind, title] = this.motorsAtRest(state.robot);
    return [kind, title, state.question === "" ? "" : "Nothing moves until you start it."];
  }

  /** Off is what the robot reports, not what it was told. */
  private motorsAtRest({ motors, link }: RobotState): [string, string] {
    if (link && motors === "on") return ["care", "▲ The motors are on"];
    return ["rest", link && motors === "off" ? "○ The motors are off" : "○ No torque is commanded"];
  }

  /** What holds buttons and links is made anew only where it changes. */
  private drawRarely(state: State): void {
    const shown = JSON.stringify([state.trials, state.current, state.running, state.question, state.reset_code, state.over, state.notes, state.note_count, state.robot.link && state.robot.stop_button, this.you, this.connected]);
    if (shown === this.shown) return;
    this.shown = shown;
    const trial = state.trials[state.current] as ListedTrial;
    this.traces.choose(trial.home_m, trial.reference_unit);
    this.trials.replaceChildren(...state.trials.map((one, k) => this.listed(one, k, state)));
    const last = this.attempts.last;
    this.verdict.replaceChildren(...(!state.running && last && last.grade !== "" ? [verdict(last)] : []));
    this.attempts.allow(this.controls && this.connected);
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset["command"] : undefined;
    this.actions.replaceChildren(...this.buttons(state));
    this.actions.querySelector<HTMLElement>(`[data-command="${focused}"]`)?.focus();
    this.addNote.disabled = this.note.disabled = !this.connected || !this.controls;
    const earlier = state.note_count - state.notes.length;
    this.notes.replaceChildren(
      ...(earlier > 0 ? [h("li", { class: "earlier" }, `${earlier} earlier ${earlier === 1 ? "note" : "notes"}, not shown`)] : []),
      ...state.notes.map((note) => h("li", {}, note)));
    const link = (address: string, name: string) => h("a", { href: address, target: "_blank", rel: "noopener" }, name);
    this.links.replaceChildren(
      ...(this.you.may_control
        ? [link(state.participant, "Participant's screen"), " · ", link(state.viewing, "Viewing page (no control)"), " · "]
        : []),
      `The safety gate is software; a hardware stop button that cuts the motors' power remains necessary. ${state.software}`);
  }

  private listed(trial: ListedTrial, place: number, state: State): HTMLElement {
    const current = place === state.current;
    const grade = trial.progress === "done" ? this.attempts.lastOf(place)?.grade || "good" : "good";
    const token = encodeURIComponent(new URLSearchParams(location.search).get("token") ?? "");
    const words = trial.progress === "waiting" ? clock(trial.duration_s) : trial.progress === "running" ? "running" : trial.ending;
    return h("li", { class: `${trial.progress} ${trial.progress === "done" ? grade : ""}`, "aria-current": current ? "step" : undefined },
      h("span", { class: "sign", "aria-hidden": true }, trial.progress === "done" ? gradeSigns[grade] : signs[trial.progress]),
      h("span", {}, h("strong", {}, trial.name), h("small", {}, [trial.condition, words].filter(Boolean).join(" · ")),
        trial.report > 0 && h("a", { href: `/report/${trial.report}?token=${token}`, target: "_blank", rel: "noopener" }, `Open the report of ${trial.name}`),
        trial.report_missing && h("small", { class: "care-text" }, `no report: ${trial.report_missing}`)));
  }

  private buttons(state: State): HTMLElement[] {
    if (!this.controls || !this.connected || state.over) return [];
    const button = (command: ConsoleCommand["command"], words: string, more: Omit<ConsoleCommand, "command"> = {}, kind = "") => {
      const made = h("button", { type: "button", class: kind, "data-command": command }, words);
      made.addEventListener("click", () => this.tell({ command, ...more }));
      return made;
    };
    const last = state.current + 1 >= state.trials.length;
    const name = (k: number) => state.trials[k]?.name ?? "";
    if (state.running) return [button("end", "End this trial early")];
    switch (state.question) {
      case "begin":
        return [button("start", `Start: ${name(state.current)}`, {}, "main"), button("abort", "End the session without a trial")];
      case "after": {
        const grade = this.attempts.last?.grade ?? "";
        const repeat = grade === "poor" || grade === "stopped" || grade === "tripped"; // is what is suggested
        const next = button("next", last ? "Finish" : `Start the next: ${name(state.current + 1)}`, {}, repeat ? "" : "main");
        const again = button("repeat", "Repeat this trial", {}, repeat ? "main" : "");
        return [...(repeat ? [again, next] : [next, again]), ...(last ? [] : [button("abort", "End the session")])];
      }
      case "reset":
        if (state.robot.link && state.robot.stop_button) {
          const waits = button("reset", "Reset …");
          waits.disabled = true;
          waits.setAttribute("aria-describedby", "reset-waits");
          return [waits, h("p", { id: "reset-waits", class: "waits" }, "Reset is not possible while the robot's stop button is pressed. Release it first."), button("abort", "End the session")];
        }
        return state.reset_code
          ? [button("reset", "Confirm: cause cleared, participant OK; reset", { code: state.reset_code }, "main"), button("abort", "End the session")]
          : [button("reset", "Reset …"), button("abort", "End the session")];
      default:
        return [];
    }
  }
}

export function showOperator(root: HTMLElement): void {
  new OperatorPage(root);
}

// The participant's screen: the instruction, the handle and its target. Nothing else moves.
import type { ConsoleTexts, ListedTrial, PerformedTrial, State } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { column, type Frame, Stream } from "./stream";
import { text } from "./words";

interface View {
  mirrored: boolean; // left and right
  upsideDown: boolean; // away and near
  turned: 0 | 90 | 180 | 270; // counterclockwise [°]
  magnified: number;
}

const field = 0.05; // from the middle to the nearer edge, unmagnified [m]
const handleRadius = 0.008; // [m]
const targetRadius = 0.0125; // [m]
const ringWidth = 0.002; // [m]
const restRadius = 0.003; // of the mark in the middle [m]
const [background, target, handle, quiet] = ["#10212b", "#e8e2d0", "#f0b429", "#5d7482"];

/** The view stands behind the # of the address, so that a link keeps it. */
function readView(): View {
  const asked = new URLSearchParams(location.hash.slice(1));
  const turned = Number(asked.get("turned"));
  const magnified = Number(asked.get("magnified"));
  return {
    mirrored: asked.has("mirrored"),
    upsideDown: asked.has("upside-down"),
    turned: turned === 90 || turned === 180 || turned === 270 ? turned : 0,
    magnified: magnified >= 0.25 && magnified <= 4 ? magnified : 1,
  };
}

function writeView(view: View): void {
  const parts = [view.mirrored && "mirrored", view.upsideDown && "upside-down", view.turned > 0 && `turned=${view.turned}`,
    view.magnified !== 1 && `magnified=${view.magnified}`];
  history.replaceState(null, "", `${location.pathname}${location.search}#${parts.filter(Boolean).join("&")}`);
}

/** From metres about the target, x to the right and y away from the person, to the screen's, y down. */
export function onScreen([x, y]: [number, number], view: View): [number, number] {
  const angle = (view.turned * Math.PI) / 180;
  const [right, up] = [view.mirrored ? -x : x, view.upsideDown ? -y : y];
  return [Math.cos(angle) * right - Math.sin(angle) * up, -(Math.sin(angle) * right + Math.cos(angle) * up)];
}

/** What the page says, by the phase of the trial as a state names it. */
const phaseTexts: Record<string, string> = {
  "soft start": "start", "moving to the test location": "move", settling: "settle", returning: "return", "soft stop": "let_go", done: "let_go",
};
const gradeTexts = { "": "wait", recorded: "thanks", good: "thanks", poor: "again", stopped: "stopped", tripped: "stopped" };

/** What is drawn: the next picture is drawn only where that is another one. */
interface Picture {
  size: string; // of the canvas and of the view
  ring: string; // its colour
  steady: boolean; // a fixation mark instead of the handle
  at: [number, number] | undefined; // the handle [px from the middle]
}

const perMetre = (view: View, width: number, height: number): number => (view.magnified * Math.min(width, height)) / (2 * field);

class ParticipantPage {
  private view = readView();
  private state: State | undefined;
  private texts: ConsoleTexts | undefined;
  private last: PerformedTrial | undefined;
  private hand: [number, number] | undefined;
  private connected = false;
  private drawn: Picture | undefined;
  private readonly canvas = h("canvas", { role: "img", "aria-label": "A large ring at the target, and a disc at the handle" });
  private readonly paint = this.canvas.getContext("2d", { alpha: false }) as CanvasRenderingContext2D;
  private readonly words = h("p", { class: "instruction", role: "status" });

  constructor(root: HTMLElement) {
    document.title = "Target";
    document.documentElement.classList.add("participant-page");
    root.replaceWith(h("main", { class: "participant" }, this.canvas, this.words, this.settings()));
    new Stream({
      state: (state: State) => {
        this.state = state;
        if (!state.running) this.hand = undefined;
        this.say();
      },
      session: ({ attempts }) => {
        this.last = attempts.at(-1);
        this.say();
      },
      texts: (texts) => {
        this.texts = texts;
        document.documentElement.lang = texts.language;
        this.say();
      },
      frame: (frame: Frame) => {
        const last = (frame.samples - 1) * frame.columns + column.hand;
        this.hand = [frame.values[last] as number, frame.values[last + 1] as number];
      },
      connected: (connected) => {
        this.connected = connected;
        if (!connected) this.hand = undefined;
        this.say();
      },
    });
    const paint = () => {
      this.draw();
      requestAnimationFrame(paint);
    };
    requestAnimationFrame(paint);
  }

  private get trial(): ListedTrial | undefined {
    return this.state?.trials[this.state.current];
  }

  private say(): void {
    const key = this.textKey();
    const own = this.texts?.trials[this.trial?.name ?? ""]?.[key];
    text(this.words, own ?? this.texts?.sentences[key] ?? "");
    this.words.dataset["text"] = key;
  }

  private textKey(): string {
    const { state, trial } = this;
    if (!this.connected) return "old";
    if (!state || !trial || state.over) return state?.over && this.last ? gradeTexts[this.last.grade] : "wait";
    if (state.safety.tripped) return "stopped";
    if (state.running) return state.phase === "perturbing" ? trial.task : phaseTexts[state.phase] ?? "wait";
    return state.question === "begin" || !this.last ? "wait" : gradeTexts[this.last.grade];
  }

  private settings(): HTMLElement {
    const change = (to: Partial<View>) => {
      this.view = { ...this.view, ...to };
      writeView(this.view);
    };
    const box = (name: string, key: "mirrored" | "upsideDown") => {
      const input = h("input", { type: "checkbox", name: key, checked: this.view[key] });
      input.addEventListener("change", () => change({ [key]: input.checked }));
      return h("label", {}, input, ` ${name}`);
    };
    const turned = h("select", { name: "turned" }, ...[0, 90, 180, 270].map((degrees) =>
      h("option", { value: degrees, selected: degrees === this.view.turned }, `${degrees}°`)));
    turned.addEventListener("change", () => change({ turned: Number(turned.value) as View["turned"] }));
    const magnified = h("input", { type: "range", name: "magnified", min: 0.25, max: 4, step: 0.05, value: this.view.magnified });
    magnified.addEventListener("input", () => change({ magnified: Number(magnified.value) }));
    return h("details", { class: "view" }, h("summary", {}, "View"),
      h("div", {}, box("mirrored, left and right", "mirrored"), box("mirrored, near and far", "upsideDown"),
        h("label", {}, "turned by ", turned), h("label", {}, "size ", magnified)));
  }

  /** Of what is seen now. Where the participant shall let the robot move the arm, nothing that moves invites a correction. */
  private picture(): Picture {
    const { canvas, view, hand, trial } = this;
    const sharp = devicePixelRatio;
    const [width, height] = [Math.round(canvas.clientWidth * sharp), Math.round(canvas.clientHeight * sharp)];
    const steady = trial?.task === "relax";
    const shown = hand && trial && !steady ? onScreen([hand[0] - (trial.home_m[0] as number), hand[1] - (trial.home_m[1] as number)], view) : undefined;
    const scale = perMetre(view, width, height);
    return {
      size: `${width} ${height} ${view.magnified}`,
      ring: hand ? target : quiet,
      steady,
      at: shown && [Math.round(shown[0] * scale), Math.round(shown[1] * scale)],
    };
  }

  private draw(): void {
    const next = this.picture();
    const { drawn, canvas, paint } = this;
    if (drawn && next.size === drawn.size && next.ring === drawn.ring && next.steady === drawn.steady && String(next.at) === String(drawn.at)) return;
    const [width, height] = next.size.split(" ").map(Number) as [number, number];
    const scale = perMetre(this.view, width, height);
    const whole = drawn?.size !== next.size || drawn.steady !== next.steady;
    if (whole) [canvas.width, canvas.height] = [width, height];
    paint.setTransform(1, 0, 0, 1, Math.round(width / 2), Math.round(height / 2));
    paint.fillStyle = background;
    const reach = Math.ceil(handleRadius * scale) + 2; // of the disc, from its middle
    if (whole) paint.fillRect(-width, -height, 2 * width, 2 * height);
    else if (drawn?.at) paint.fillRect(drawn.at[0] - reach, drawn.at[1] - reach, 2 * reach, 2 * reach);
    const disc = (x: number, y: number, radius: number) => {
      paint.beginPath();
      paint.arc(x, y, radius * scale, 0, 2 * Math.PI);
    };
    paint.lineWidth = ringWidth * scale;
    paint.strokeStyle = background; // what was smoothed at its edges is gone before it is drawn over itself
    disc(0, 0, targetRadius);
    paint.lineWidth += 4;
    paint.stroke();
    paint.lineWidth -= 4;
    paint.strokeStyle = next.ring;
    paint.stroke();
    if (next.steady) {
      paint.fillStyle = next.ring;
      disc(0, 0, restRadius);
      paint.fill();
    }
    if (next.at) {
      paint.fillStyle = handle;
      disc(next.at[0], next.at[1], handleRadius);
      paint.fill();
      canvas.dataset["handle"] = next.at.join(" ");
    } else {
      delete canvas.dataset["handle"];
    }
    canvas.dataset["steady"] = String(next.steady);
    this.drawn = next;
  }
}

export function showParticipant(root: HTMLElement): void {
  new ParticipantPage(root);
}

// The participant's screen: where the handle is, and where it shall be. Nothing else moves.
import type { State } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { column, type Frame, Stream } from "./stream";

interface View {
  mirrored: boolean; // left and right
  upsideDown: boolean; // away and near
  turned: 0 | 90 | 180 | 270; // counterclockwise [°]
  magnified: number;
}

const field = 0.05; // from the middle to the nearer edge, unmagnified [m]
const handleRadius = 0.008; // [m]
const targetRadius = 0.0125; // [m]
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

class ParticipantPage {
  private view = readView();
  private home: [number, number] | undefined;
  private hand: [number, number] | undefined;
  private connected = false;
  private readonly canvas = h("canvas", { role: "img", "aria-label": "A large ring where the handle shall be, and a disc where it is" });
  private readonly words = h("p", { class: "please-wait", role: "status" });

  constructor(root: HTMLElement) {
    document.title = "Target";
    document.documentElement.classList.add("participant-page");
    root.replaceWith(h("main", { class: "participant" }, this.canvas, this.words, this.settings()));
    new Stream({
      state: (state: State) => {
        this.home = state.trials[state.current]?.home_m;
        if (!state.running) this.hand = undefined;
      },
      frame: (frame: Frame) => {
        const last = (frame.samples - 1) * frame.columns + column.hand;
        this.hand = [frame.values[last] as number, frame.values[last + 1] as number];
      },
      connected: (connected) => {
        this.connected = connected;
        if (!connected) this.hand = undefined;
      },
    });
    const paint = () => {
      this.draw();
      requestAnimationFrame(paint);
    };
    requestAnimationFrame(paint);
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

  private draw(): void {
    const { canvas } = this;
    const sharp = devicePixelRatio;
    const [width, height] = [canvas.clientWidth * sharp, canvas.clientHeight * sharp];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const paint = canvas.getContext("2d") as CanvasRenderingContext2D;
    const perMetre = (this.view.magnified * Math.min(width, height)) / (2 * field);
    paint.fillStyle = background;
    paint.fillRect(0, 0, width, height);
    paint.translate(width / 2, height / 2);
    const circle = ([x, y]: [number, number], radius: number) => {
      paint.beginPath();
      paint.arc(x * perMetre, y * perMetre, radius * perMetre, 0, 2 * Math.PI);
    };
    const { hand, home } = this;
    paint.lineWidth = 0.002 * perMetre;
    paint.strokeStyle = hand ? target : quiet;
    circle([0, 0], targetRadius);
    paint.stroke();
    if (hand && home) {
      const at = onScreen([hand[0] - home[0], hand[1] - home[1]], this.view);
      paint.fillStyle = handle;
      circle(at, handleRadius);
      paint.fill();
      canvas.dataset["handle"] = at.map((metres) => metres.toFixed(5)).join(" ");
    } else {
      delete canvas.dataset["handle"];
    }
    paint.setTransform(1, 0, 0, 1, 0, 0);
    const words = !this.connected ? "Please wait. The picture is not up to date." : hand ? "" : "Please wait.";
    if (this.words.textContent !== words) this.words.textContent = words;
  }
}

export function showParticipant(root: HTMLElement): void {
  new ParticipantPage(root);
}

// What the server sends, and what it is told: one WebSocket that opens itself again after it was lost.
import type { ConsoleCommand, ConsoleMessage, ConsoleTexts, LiveEstimate, PerformedTrials, State, You } from "@mbk/shared/documents";

/** Columns of a frame, as mbk/experiment/console/frame.h says. */
export const column = { time: 0, hand: 1, force: 3, reference: 5, acceleration: 7, torque: 9, compute: 11, late: 12 };

export interface Frame {
  trial: number;
  time: number; // of the first sample [s]
  samples: number;
  columns: number;
  values: Float32Array; // sample by sample
}

const headerBytes = 32;

export function decode(bytes: ArrayBuffer): Frame | undefined {
  const view = new DataView(bytes);
  if (bytes.byteLength < headerBytes || view.getUint32(0, true) !== 0x464b424d || view.getUint16(4, true) !== 1) return undefined;
  const columns = view.getUint16(6, true);
  const samples = view.getUint32(8, true);
  if (bytes.byteLength !== headerBytes + 4 * columns * samples) return undefined;
  return {
    trial: view.getUint32(12, true),
    time: view.getFloat64(16, true),
    samples,
    columns,
    values: new Float32Array(bytes, headerBytes, columns * samples),
  };
}

export interface Listener {
  state(state: State): void;
  session?(session: PerformedTrials): void;
  texts?(texts: ConsoleTexts): void;
  estimate?(estimate: LiveEstimate): void;
  frame(frame: Frame): void;
  you?(you: You): void;
  refused?(why: string): void;
  connected(connected: boolean): void;
}

/** By this the page is known when it is loaded again, so that it keeps control; of this tab alone. */
function pageKey(): string {
  const kept = sessionStorage.getItem("page");
  if (kept) return kept;
  const made = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  sessionStorage.setItem("page", made);
  return made;
}

const againAfter = 1000; // [ms]
const silence = 3000; // states come ten times a second; after so long without one the line is dead [ms]

export class Stream {
  private socket: WebSocket | undefined;
  private heard = 0;

  constructor(private readonly listener: Listener) {
    this.open();
    setInterval(() => {
      if (this.socket?.readyState === WebSocket.OPEN && performance.now() - this.heard > silence) this.lose();
    }, silence / 4);
  }

  /** False where it could not be sent. */
  send(command: ConsoleCommand): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(command));
    return true;
  }

  private open(): void {
    const token = new URLSearchParams(location.search).get("token") ?? "";
    const socket = new WebSocket(`ws://${location.host}/stream?token=${encodeURIComponent(token)}&page=${pageKey()}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => {
      if (socket !== this.socket) return;
      this.heard = performance.now();
      this.receive(data);
    };
    socket.onopen = () => {
      this.heard = performance.now();
      this.listener.connected(true);
    };
    socket.onclose = () => {
      if (socket === this.socket) this.lose();
    };
    this.socket = socket;
  }

  private lose(): void {
    const socket = this.socket;
    this.socket = undefined;
    socket?.close();
    this.listener.connected(false);
    setTimeout(() => this.open(), againAfter);
  }

  private receive(data: ArrayBuffer | string): void {
    if (data instanceof ArrayBuffer) {
      const frame = decode(data);
      if (frame) this.listener.frame(frame);
      return;
    }
    const message: ConsoleMessage = JSON.parse(data);
    if (message.type === "state") this.listener.state(message);
    else if (message.type === "session") this.listener.session?.(message);
    else if (message.type === "texts") this.listener.texts?.(message);
    else if (message.type === "estimate") this.listener.estimate?.(message);
    else if (message.type === "you") this.listener.you?.(message);
    else if (message.type === "refused") this.listener.refused?.(message.why);
  }
}

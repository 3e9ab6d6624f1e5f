// What a chart is made of.
import type { Value } from "./documents";

export const dashes = { solid: "", dashed: "7 4", dotted: "2 3", dashdot: "9 3 2 3" } as const;
export const symbols = { circle: "M 1 5 a 4 4 0 1 0 8 0 a 4 4 0 1 0 -8 0", diamond: "M 5 0 L 10 5 L 5 10 L 0 5 Z", rect: "M 1 1 H 9 V 9 H 1 Z", triangle: "M 5 1 L 9.5 9 H 0.5 Z" } as const;

export interface Style {
  color: string;
  dash: keyof typeof dashes;
  width: number;
}

export interface Shade {
  color: string;
  opacity: number;
}

export interface Series {
  name: string;
  x: Value[];
  y: Value[];
  style: Style;
  /** A mark for each value instead of a line. */
  marks?: keyof typeof symbols;
  /** What is written beside each value. */
  labels?: string[];
  /** What is shaded around the line. */
  between?: { low: Value[]; high: Value[]; name: string; shade?: Shade };
}

export interface Panel {
  title: string;
  unit: string;
  series: Series[];
  log?: boolean;
  range?: [number, number];
  /** Between two lines of the grid. */
  interval?: number;
  /** Segment of x that is shaded, with its name. */
  band?: { from: number; to: number; name: string };
  /** Segment of y that is shaded, with its name. */
  level?: { from: number; to: number; name: string };
  /** A line at zero. */
  zero?: boolean;
}

export interface Chart {
  id: string;
  title: string;
  howToRead: string;
  /** What the chart shows, for those who cannot see it. */
  description: string;
  x: { name: string; unit: string; log?: boolean; range?: [number, number] };
  panels: Panel[];
  panelHeight?: number;
}

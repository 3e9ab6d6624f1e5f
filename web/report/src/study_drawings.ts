// Drawings of a study: forest plots, courses over sessions, ellipses of people. They draw themselves on paper as on the screen.
import type { Course, OutcomeCourses, SessionChange, SessionMatrix, Value } from "@mbk/shared/documents";
import { h, svg } from "@mbk/shared/dom";
import { significant } from "@mbk/shared/format";
import { among, ticks, tickText, withUnit } from "./outcomes";

export interface ForestRow {
  name: string;
  value: Value;
  low: Value;
  high: Value;
  /** What is written at the right. */
  text: string;
  /** Of all rows together. */
  whole?: boolean;
}

const known = (values: Value[]): number[] => values.filter((v): v is number => v !== null && Number.isFinite(v));

/** Low and high end of what is drawn, with room at both. */
function range(values: number[], room = 0.06): [number, number] {
  if (values.length === 0) return [0, 1];
  let [low, high] = [Infinity, -Infinity];
  for (const one of values) [low, high] = [Math.min(low, one), Math.max(high, one)];
  const extra = low < high ? room * (high - low) : Math.max(Math.abs(low) * 0.1, 1e-9);
  return [low - extra, high + extra];
}

/** Values with their intervals, one a row, over one axis; a diamond for all of them together. */
export function forest(label: string, axisName: string, rows: ForestRow[], reference?: number): SVGSVGElement {
  const [line, top, width] = [20, 8, 660];
  const room = (texts: string[]) => 6.9 * Math.max(...texts.map(({ length }) => length));
  const left = Math.min(16 + room(rows.map(({ name }) => name)), 240);
  const right = Math.max(width - 18 - room(rows.map(({ text }) => text)), left + 150);
  const height = top + rows.length * line + 46;
  const all = known(rows.flatMap(({ value, low, high }) => [value, low, high]));
  const [low, high] = range(reference === undefined ? all : [...all, reference], 0.03);
  const x = (value: number) => left + ((value - low) / (high - low)) * (right - left);
  const marks = ticks(low, high, 5);
  const step = marks.length > 1 ? (marks[1] as number) - (marks[0] as number) : 1;
  const bottom = top + rows.length * line + 4;
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label, class: "forest" },
    ...marks.map((at) => svg("line", { x1: x(at), x2: x(at), y1: top - 4, y2: bottom, class: "grid" })),
    reference !== undefined && svg("line", { x1: x(reference), x2: x(reference), y1: top - 4, y2: bottom, class: "origin" }),
    svg("line", { x1: left, x2: right, y1: bottom, y2: bottom, class: "origin" }),
    ...marks.map((at) => svg("text", { x: x(at), y: bottom + 16, "text-anchor": "middle" }, tickText(at, step))),
    svg("text", { x: (left + right) / 2, y: bottom + 34, "text-anchor": "middle", class: "title" }, axisName),
    ...rows.flatMap(({ name, value, low: from, high: to, text, whole }, k) => {
      const y = top + (k + 0.5) * line;
      const shapes: (SVGElement | false)[] = [
        svg("text", { x: left - 10, y: y + 4, "text-anchor": "end", class: whole ? "title" : "" }, name),
        svg("text", { x: right + 12, y: y + 4, class: whole ? "title" : "" }, text),
      ];
      if (value === null) return shapes;
      if (whole) {
        const [a, b] = from === null || to === null ? [x(value) - 5, x(value) + 5] : [x(from), x(to)];
        shapes.push(svg("path", { d: `M ${a} ${y} L ${x(value)} ${y - 6} L ${b} ${y} L ${x(value)} ${y + 6} Z`, class: "whole" }));
      } else {
        shapes.push(
          from !== null && to !== null && svg("line", { x1: x(from), x2: x(to), y1: y, y2: y, class: "interval" }),
          svg("rect", { x: x(value) - 3.5, y: y - 3.5, width: 7, height: 7, class: "value" }));
      }
      return shapes;
    }));
}

export const verdictMarks: Record<SessionChange["verdict"] | "first", { shape: "circle" | "diamond"; filled: boolean }> = {
  first: { shape: "circle", filled: true },
  "within-error": { shape: "circle", filled: true },
  unknown: { shape: "circle", filled: true },
  uncertain: { shape: "diamond", filled: false },
  "beyond-error": { shape: "diamond", filled: true },
};

export function mark(x: number, y: number, kind: keyof typeof verdictMarks): SVGElement {
  const { shape, filled } = verdictMarks[kind];
  const className = `mark ${kind}${filled ? "" : " hollow"}`;
  if (shape === "circle") return svg("circle", { cx: x, cy: y, r: 3.6, class: className });
  return svg("path", { d: `M ${x - 5.5} ${y} L ${x} ${y - 5.5} L ${x + 5.5} ${y} L ${x} ${y + 5.5} Z`, class: className });
}

/** All that the panels of an outcome span, so that they can be compared; not below 0 where nothing measured is. */
export function commonRange(courses: Course[]): [number, number] {
  const [low, high] = range(known(courses.flatMap(({ sessions, changes }) => [
    ...sessions.map(({ mean }) => mean),
    ...changes.flatMap(({ first, mdc95 }) => (first === null || mdc95 === null ? [] : [first - mdc95, first + mdc95])),
  ])));
  const positive = courses.every(({ sessions }) => sessions.every(({ mean }) => mean === null || mean >= 0));
  return positive && low < 0 ? [0, high] : [low, high];
}

/** The sessions of one person, with what the first may differ by through error of measurement alone. */
export function coursePanel(outcome: OutcomeCourses, course: Course, [low, high]: [number, number], all: number[], size: "small" | "large"): SVGSVGElement {
  const large = size === "large";
  const [width, height] = large ? [460, 250] : [190, 128];
  const marks = ticks(low, high, large ? 6 : 3);
  const step = marks.length > 1 ? (marks[1] as number) - (marks[0] as number) : 1;
  const left = 12 + 7 * Math.max(...marks.map((at) => tickText(at, step).length));
  const [right, top, bottom] = large ? [width - 14, 12, height - 42] : [width - 8, 8, height - 22];
  const [first = 1, last = 1] = [all[0], all.at(-1)];
  const x = (session: number) => (first === last ? (left + right) / 2 : left + 14 + ((session - first) / (last - first)) * (right - left - 28));
  const y = (value: number) => bottom - ((Math.max(value, low) - low) / (high - low)) * (bottom - top);
  const verdicts = new Map(course.changes.map(({ last_session, verdict }) => [last_session, verdict]));
  const band = course.changes.filter(({ first: value, mdc95 }) => value !== null && mdc95 !== null);
  const drawn = course.sessions.filter((one): one is typeof one & { mean: number } => one.mean !== null);
  const edge = (sign: 1 | -1) => {
    const ends = band.map(({ last_session, first: value, mdc95 }) => `${x(last_session).toFixed(1)} ${y((value as number) + sign * (mdc95 as number)).toFixed(1)}`);
    const start = band[0];
    return start ? [`${x(start.first_session).toFixed(1)} ${y((start.first as number) + sign * (start.mdc95 as number)).toFixed(1)}`, ...ends] : ends;
  };
  const shown = all.length > (large ? 12 : 6) ? all.filter((_, k) => k % Math.ceil(all.length / (large ? 12 : 6)) === 0) : all;
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", class: `course ${size}`, "aria-label": described(outcome, course) },
    ...marks.map((at) => svg("line", { x1: left, x2: right, y1: y(at), y2: y(at), class: "grid" })),
    ...marks.map((at) => svg("text", { x: left - 6, y: y(at) + 4, "text-anchor": "end" }, tickText(at, step))),
    band.length > 0 && svg("path", { d: `M ${[...edge(1), ...edge(-1).reverse()].join(" L ")} Z`, class: "band" }),
    svg("line", { x1: left, x2: right, y1: bottom, y2: bottom, class: "origin" }),
    ...shown.map((session) => svg("text", { x: x(session), y: bottom + 15, "text-anchor": "middle" }, String(session))),
    large && svg("text", { x: (left + right) / 2, y: height - 6, "text-anchor": "middle", class: "title" }, "session"),
    svg("path", { d: drawn.map(({ session, mean }, k) => `${k === 0 ? "M" : "L"} ${x(session).toFixed(1)} ${y(mean).toFixed(1)}`).join(" "), class: "curve" }),
    ...drawn.map(({ session, mean }) => mark(x(session), y(mean), verdicts.get(session) ?? "first")),
    large && drawn[0] && band.length > 0 && svg("line", { x1: x(drawn[0].session), x2: right, y1: y(drawn[0].mean), y2: y(drawn[0].mean), class: "baseline" }));
}

/** For those who cannot see it. */
function described({ outcome, unit }: OutcomeCourses, { participant, sessions, changes }: Course): string {
  const values = sessions.map(({ session, mean, results }) => `session ${session}: ${mean === null ? "none" : withUnit(significant(mean), unit)}, ${results} result${results === 1 ? "" : "s"}`);
  const last = changes.at(-1);
  return `Participant ${participant}, ${outcome.replaceAll("_", " ")}. ${values.join("; ")}.${last ? ` Minimal detectable change: ${last.mdc95 === null ? "unknown" : withUnit(significant(last.mdc95), unit)}.` : ""}`;
}

export function courseLegend(outcomes: OutcomeCourses[]): HTMLElement {
  const withBand = outcomes.some(({ why_unknown }) => !why_unknown);
  const said = new Set(outcomes.flatMap(({ participants }) => participants.flatMap(({ changes }) => changes.map(({ verdict }) => verdict))));
  const entry = (drawing: SVGElement, text: string) =>
    h("li", {}, svg("svg", { width: 22, height: 14, "aria-hidden": "true", class: "course" }, drawing), text);
  return h("ul", { class: "legend" },
    withBand && entry(svg("rect", { x: 0.5, y: 1.5, width: 21, height: 11, class: "band" }), "first session ± minimal detectable change (95 %)"),
    entry(mark(11, 7, "first"), withBand ? "mean of a session" : "mean of a session; the measurement error is not known"),
    said.has("uncertain") && entry(mark(11, 7, "uncertain"), "beyond the band, which is itself uncertain"),
    said.has("beyond-error") && entry(mark(11, 7, "beyond-error"), "more than measurement error (95 %)"));
}

interface Axes {
  long: number;
  short: number;
  angle: number; // [°], counter-clockwise from x
}

/** The ellipse {S u : |u| = 1}; none where S is not positive definite. */
function axesOf([xx, xy, yy]: [number, number, number]): Axes | undefined {
  const [middle, half] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  if (!(middle - half > 0)) return undefined;
  return { long: middle + half, short: middle - half, angle: (Math.atan2(2 * xy, xx - yy) * 90) / Math.PI };
}

const triple = ({ symmetric }: SessionMatrix): [number, number, number] => symmetric as [number, number, number];

export const largestOf = (all: SessionMatrix[]): number => Math.max(0, ...all.map((one) => axesOf(triple(one))?.long ?? 0));

/** The ellipses of one person's sessions, one over the other. */
export function ellipsePanel(name: string, sessions: SessionMatrix[], largest: number, reference: number): SVGSVGElement {
  const radius = 92;
  const scale = largest > 0 ? radius / largest : 0;
  const end = radius + 6;
  const drawn = sessions.flatMap((one, k) => {
    const axes = axesOf(triple(one));
    if (!axes) return [];
    const kind = k === 0 ? "first" : k === sessions.length - 1 ? "last" : "between";
    return [svg("ellipse", { rx: (axes.long * scale).toFixed(2), ry: (axes.short * scale).toFixed(2), transform: `rotate(${(-axes.angle).toFixed(2)})`, class: `session ${kind}` })];
  });
  const words = sessions.map((one) => {
    const axes = axesOf(triple(one));
    return `session ${one.session}: ${axes ? `${significant(axes.long)} by ${significant(axes.short)} ${one.unit}, major axis at ${among(((axes.angle % 180) + 180) % 180, 10)}°` : "no ellipse"}`;
  });
  return svg("svg", { viewBox: `${-end} ${-end} ${2 * end} ${2 * end}`, role: "img", "aria-label": `${name}. ${words.join("; ")}`, class: "person-ellipses" },
    svg("line", { x1: -end, y1: 0, x2: end, y2: 0, class: "axis" }),
    svg("line", { x1: 0, y1: -end, x2: 0, y2: end, class: "axis" }),
    reference > 0 && svg("circle", { r: (reference * scale).toFixed(2), class: "reference" }),
    ...drawn,
    drawn.length === 0 && svg("text", { x: 0, y: -8, "text-anchor": "middle", class: "none" }, "no ellipse"),
    svg("circle", { r: 2.6, class: "hand" }));
}

export function ellipseLegend(sessions: number, reference: string): HTMLElement {
  const entry = (kind: string, text: string) =>
    h("li", {}, svg("svg", { width: 24, height: 12, "aria-hidden": "true", class: "person-ellipses" }, svg("line", { x1: 0, x2: 24, y1: 6, y2: 6, class: kind })), text);
  return h("ul", { class: "legend" }, entry("session first", "first session"), sessions > 2 && entry("session between", "between"), sessions > 1 && entry("session last", "last session"), entry("reference", reference));
}

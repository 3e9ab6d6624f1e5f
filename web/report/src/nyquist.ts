// The Nyquist plot: a curve in the complex plane, a metre of it as long across as up, in the region that holds it.
import type { Value } from "@mbk/shared/documents";
import { h, svg } from "@mbk/shared/dom";
import { plain, significant } from "@mbk/shared/format";
import { csvOf } from "@mbk/shared/sheet";
import { saveable } from "./picture";

/** A response, and the ellipse around it that holds it with 95 %, at each frequency. */
export interface Region {
  frequency_hz: Value[];
  real: Value[];
  imaginary: Value[];
  region95: { longer_half_axis: Value[]; shorter_half_axis: Value[]; angle_deg: Value[] };
}

interface Point {
  f: number;
  re: number;
  im: number;
  a: number;
  b: number;
  angle: number;
}

interface Box {
  left: number;
  right: number;
  low: number;
  high: number;
}

const [width, tallest, margin] = [660, 520, { left: 74, right: 22, top: 26, bottom: 44 }];

function points(response: Region): Point[] {
  const { frequency_hz: f, real, imaginary, region95: r } = response;
  return f.flatMap((at, k) => {
    const values = [at, real[k], imaginary[k], r.longer_half_axis[k], r.shorter_half_axis[k], r.angle_deg[k]];
    if (values.some((value) => value === null || value === undefined)) return [];
    const [known, re, im, a, b, angle] = values as [number, number, number, number, number, number];
    return [{ f: known, re, im, a, b, angle }];
  });
}

/** What is shown: the curve, and its region where that is not much larger. */
function boxOf(all: Point[]): Box {
  const ends = (value: (p: Point) => number): [number, number] => {
    const values = [...all.map(value), 0];
    const [low, high] = [Math.min(...values), Math.max(...values)];
    return [low, high];
  };
  const [left, right] = ends((p) => p.re);
  const [low, high] = ends((p) => p.im);
  const size = Math.max(right - left, high - low) || 1;
  const room = Math.min(0.5 * size, Math.max(...all.map((p) => p.a))) + 0.05 * size;
  return { left: left - room, right: right + room, low: low - room, high: high + room };
}

/** 1, 2 or 5 times a power of ten: about `count` of them make `length`. */
function step(length: number, count: number): number {
  const rough = length / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10);
}

function ticks(low: number, high: number, by: number): number[] {
  const first = Math.ceil(low / by);
  return Array.from({ length: Math.max(0, Math.floor(high / by) - first + 1) }, (_, k) => (first + k) * by);
}

const label = (p: Point): string => `${significant(p.f, 3)} Hz`;

/** Frequencies that are written on the curve, far enough from each other to be read. */
function marked(all: Point[], place: (p: Point) => [number, number]): Point[] {
  const apart = 70; // [px]
  const chosen: Point[] = [];
  const shown = all.filter((_, k) => k % Math.max(1, Math.floor(all.length / 40)) === 0);
  for (const p of shown) {
    const [x, y] = place(p);
    if (chosen.every((q) => Math.hypot(place(q)[0] - x, place(q)[1] - y) > apart && label(q) !== label(p))) chosen.push(p);
  }
  return chosen;
}

export function nyquist(response: Region, band: { from: number; to: number; name: string } | undefined, id: string, title: string, unit: string, name = "model"): HTMLElement {
  const all = points(response);
  if (all.length === 0) return h("p", {}, "There is no Nyquist plot: the response is undefined.");
  const inside = band ? all.filter((p) => p.f >= band.from && p.f <= band.to) : all;
  const box = boxOf(inside.length > 0 ? inside : all);
  const wide = width - margin.left - margin.right;
  const scale = Math.min(wide / (box.right - box.left), (tallest - margin.top - margin.bottom) / (box.high - box.low));
  const spare = (wide / scale - (box.right - box.left)) / 2;
  const [left, right] = [box.left - spare, box.right + spare];
  const height = margin.top + margin.bottom + scale * (box.high - box.low);
  const px = (re: number): number => margin.left + scale * (re - left);
  const py = (im: number): number => margin.top + scale * (box.high - im);
  const place = (p: Point): [number, number] => [px(p.re), py(p.im)];
  const path = (some: Point[]): string => some.map((p, k) => `${k === 0 ? "M" : "L"}${px(p.re).toFixed(1)} ${py(p.im).toFixed(1)}`).join("");
  const by = step(Math.min(right - left, box.high - box.low), 6);
  const clip = `${id}-clip`;
  const drawing = svg("svg", {
    viewBox: `0 0 ${width} ${height.toFixed(1)}`,
    class: "nyquist",
    role: "img",
    "aria-label": `${title}: from ${significant(all[0]?.re ?? null)} + ${significant(all[0]?.im ?? null)} j at ${significant(all[0]?.f ?? null)} Hz to ${significant(all.at(-1)?.re ?? null)} + ${significant(all.at(-1)?.im ?? null)} j at ${significant(all.at(-1)?.f ?? null)} Hz.`,
  },
    svg("clipPath", { id: clip }, svg("rect", { x: margin.left, y: margin.top, width: wide, height: height - margin.top - margin.bottom })),
    ...ticks(left, right, by).flatMap((v) => [
      svg("line", { x1: px(v), x2: px(v), y1: margin.top, y2: height - margin.bottom, class: v === 0 ? "origin" : "grid" }),
      svg("text", { x: px(v), y: height - margin.bottom + 17, "text-anchor": "middle" }, plain(v, 4)),
    ]),
    ...ticks(box.low, box.high, by).flatMap((v) => [
      svg("line", { y1: py(v), y2: py(v), x1: margin.left, x2: width - margin.right, class: v === 0 ? "origin" : "grid" }),
      svg("text", { x: margin.left - 8, y: py(v) + 4, "text-anchor": "end" }, plain(v, 4)),
    ]),
    svg("g", { "clip-path": `url(#${clip})` },
      svg("g", { class: "region" }, ...inside.map((p) => svg("ellipse", {
        rx: (scale * p.a).toFixed(2), ry: (scale * p.b).toFixed(2),
        transform: `translate(${px(p.re).toFixed(1)} ${py(p.im).toFixed(1)}) rotate(${(-p.angle).toFixed(2)})`,
      }))),
      band ? svg("path", { d: path(all), class: "beyond" }) : svg("g"),
      svg("path", { d: path(inside), class: "curve" }),
      ...marked(inside, place).flatMap((p) => [
        svg("circle", { cx: px(p.re), cy: py(p.im), r: 3, class: "mark" }),
        svg("text", { x: px(p.re) + 7, y: py(p.im) - 6, class: "mark-name" }, label(p)),
      ])),
    svg("text", { x: margin.left - 66, y: 15, class: "title" }, unit ? `Imaginary part [${unit}]` : "Imaginary part"),
    svg("text", { x: margin.left + wide / 2, y: height - 6, "text-anchor": "middle" }, unit ? `real part [${unit}]` : "real part"),
  );
  const key = (name: string, mark: SVGElement): HTMLElement => h("li", {}, mark, name);
  const stroke = (kind: string): SVGElement => svg("svg", { width: 34, height: 10, "aria-hidden": "true", class: "nyquist" }, svg("path", { d: "M1 5H33", class: kind }));
  const ofUnit = unit ? ` [${unit}]` : "";
  const numbers = () => csvOf(["frequency [Hz]", `real part${ofUnit}`, `imaginary part${ofUnit}`, `95 % region, longer half axis${ofUnit}`, `shorter half axis${ofUnit}`, "its angle [°]"],
    all.map(({ f, re, im, a, b, angle }) => [f, re, im, a, b, angle]));
  return saveable(h("figure", { class: "nyquist-figure", "aria-label": title },
    h("ul", { class: "legend" },
      key(band ? `${name}, in the excited band` : name, stroke("curve")),
      band ? key(`${name}, beyond it`, stroke("beyond")) : "",
      key("95 % region", svg("svg", { width: 22, height: 12, "aria-hidden": "true", class: "nyquist" }, svg("g", { class: "region" }, svg("rect", { x: 0.5, y: 0.5, width: 21, height: 11 }))))),
    drawing,
    h("figcaption", {}, h("strong", {}, "How to read this. "), "Each point is one frequency: its distance from the origin is the magnitude, its direction the phase. The shaded region holds the true curve at each frequency with 95 %.")), { name: id, title, csv: numbers });
}


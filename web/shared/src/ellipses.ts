// Ellipses to scale at the hand, with a reference circle and the posture under them (Dyck 2013, figs. 3.10, 3.11).
import { angleBetween } from "./directions";
import type { Ellipse, Posture, Result, Value } from "./documents";
import { h, svg } from "./dom";
import { fixed, plain, significant } from "./format";
import { matrices, type Trial, unitsOf } from "./result";
import { type Band, directions, ellipseBand } from "./uncertainty";

const radius = 92; // of the largest ellipse [px]
const armSize = 176; // of the posture's longer side [px]
const margin = 30;

/** The largest of 1, 2 and 5 times a power of ten that is no larger; 0 where there is none. */
export function niceBelow(value: number): number {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  const factor = [5, 2, 1].find((f) => f * power <= value * (1 + 1e-9)) ?? 1;
  return factor * power;
}

interface Frame {
  pixelsPerMetre: number;
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Room for circle and posture, with the hand at the origin and y up. */
function frameFor(posture: Posture | undefined): Frame {
  const half = radius + margin;
  const frame = { pixelsPerMetre: 0, left: -half, top: -half, right: half, bottom: half };
  const points = posture && posture.points_m.length > 1 ? relative(posture, 1) : [];
  if (points.length > 1) {
    const xs = points.map(([x]) => x);
    const ys = points.map(([, y]) => y);
    const size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
    frame.pixelsPerMetre = armSize / size;
    for (const [x, y] of points) {
      frame.left = Math.min(frame.left, x * frame.pixelsPerMetre - 34);
      frame.right = Math.max(frame.right, x * frame.pixelsPerMetre + 34);
      frame.top = Math.min(frame.top, -y * frame.pixelsPerMetre - 22);
      frame.bottom = Math.max(frame.bottom, -y * frame.pixelsPerMetre + 30);
    }
  }
  const { pixelsPerMetre, left, top } = frame;
  return { pixelsPerMetre, left, top, width: frame.right - left, height: frame.bottom - top };
}

/** The points of a posture from the hand. */
function relative(posture: Posture, scale: number): [number, number][] {
  const [x0, y0] = posture.points_m.at(-1) ?? [0, 0];
  return posture.points_m.map(([x, y]) => [scale * (x - x0), scale * (y - y0)]);
}

function drawPosture(posture: Posture, frame: Frame): SVGElement {
  const points = relative(posture, frame.pixelsPerMetre);
  const [first, middle, hand] = points as [[number, number], [number, number], [number, number]];
  const names = posture.of === "arm" ? ["shoulder", "elbow"] : ["base", "elbow"];
  const label = (text: string, [x, y]: [number, number], towards: number) =>
    svg("text", { x: x + towards * 14, y: -y + 4, "text-anchor": towards > 0 ? "start" : "end", class: "joint-name" }, text);
  const side = middle[0] >= (first[0] + hand[0]) / 2 ? 1 : -1;
  return svg(
    "g",
    { class: `posture ${posture.of}` },
    svg("polyline", { points: points.map(([x, y]) => `${x.toFixed(1)},${(-y).toFixed(1)}`).join(" "), class: "links" }),
    ...points.slice(0, 2).map(([x, y]) => svg("circle", { cx: x, cy: -y, r: 5, class: "joint" })),
    label(names[0] ?? "", first, first[0] > frame.left + frame.width - 90 ? -1 : 1),
    label(names[1] ?? "", middle, middle[0] + 14 + 40 > frame.left + frame.width ? -1 : side),
  );
}

/** Whether an interval of an orientation holds every angle: the ellipse may be round. */
export function anyAngle([low, high]: [Value, Value]): boolean {
  return low !== null && high !== null && high - low >= 179.999;
}

/** Arcs at both ends of the major axis that span the interval of its orientation. */
function orientationArcs(ellipse: Ellipse, r: number): SVGElement[] {
  const [low, high] = ellipse.interval95.orientation_deg;
  if (low === null || high === null || anyAngle([low, high])) return [];
  const at = (degrees: number, turn: number) => {
    const angle = ((degrees + turn) * Math.PI) / 180;
    return `${(r * Math.cos(angle)).toFixed(2)} ${(-r * Math.sin(angle)).toFixed(2)}`;
  };
  return [0, 180].map((turn) =>
    svg("path", {
      d: `M ${at(low, turn)} A ${r} ${r} 0 ${high - low > 180 ? 1 : 0} 0 ${at(high, turn)}`,
      class: "interval-arc",
    }),
  );
}

/** The reference circle's value, written beside it where neither the ellipse nor the limb is. */
function referenceLabel(text: string, r: number, angle: number, posture: Posture | undefined, frame: Frame): SVGElement {
  const [x, y] = posture && posture.points_m.length > 1 ? (relative(posture, frame.pixelsPerMetre).at(-2) ?? [0, 0]) : [0, 0];
  const limb = (Math.atan2(y, x) * 180) / Math.PI;
  const free = (degrees: number): number => {
    const fromLimb = x === 0 && y === 0 ? 180 : Math.abs(((degrees - limb + 540) % 360) - 180);
    return Math.min(angleBetween(degrees, angle), fromLimb);
  };
  const best = [40, 140, -140, -40].reduce((a, b) => (free(b) > free(a) ? b : a));
  const [dx, dy] = [Math.cos((best * Math.PI) / 180), -Math.sin((best * Math.PI) / 180)];
  return svg(
    "text",
    { x: (r * dx + 5 * Math.sign(dx)).toFixed(1), y: (r * dy + (dy > 0 ? 12 : -4)).toFixed(1), "text-anchor": dx > 0 ? "start" : "end", class: "reference-value" },
    text,
  );
}

/** The ring in which the ellipse lies. */
function bandPath(band: Band, scale: number): SVGElement {
  const ring = (radii: number[]) => radii.map((r, k) => {
    const angle = (2 * Math.PI * k) / directions;
    return `${k === 0 ? "M" : "L"} ${(r * scale * Math.cos(angle)).toFixed(1)} ${(-r * scale * Math.sin(angle)).toFixed(1)}`;
  }).join(" ");
  return svg("path", { d: `${ring(band.high)} Z ${ring(band.low)} Z`, "fill-rule": "evenodd", class: "ellipse-band" });
}

/** One drawing. `largest` is the value at the radius of the drawing, the same for all that are compared. */
function drawing(
  ellipse: Ellipse,
  title: string,
  unit: string,
  largest: number,
  reference: number,
  posture: Posture | undefined,
  band: Band | undefined,
): SVGSVGElement {
  const frame = frameFor(posture);
  const [small, large] = ellipse.eigenvalues;
  const scale = largest > 0 ? radius / largest : 0;
  const r = reference * scale;
  const angle = ellipse.orientation_deg;
  const shapes: SVGElement[] = [];
  let words = `no ellipse exists: the eigenvalues are ${significant(small)} and ${significant(large)} ${unit}`;
  if (small !== null && large !== null && small > 0 && angle !== null) {
    words = `semi-major axis ${significant(large)} ${unit} at ${fixed(angle, 0)}° from x, semi-minor axis ${significant(small)} ${unit}`;
    const [dx, dy] = [Math.cos((angle * Math.PI) / 180), -Math.sin((angle * Math.PI) / 180)];
    const [a, b] = [large * scale, small * scale];
    if (band) shapes.push(bandPath(band, scale));
    shapes.push(
      svg("ellipse", { rx: a.toFixed(2), ry: b.toFixed(2), transform: `rotate(${(-angle).toFixed(3)})`, class: "ellipse" }),
      svg("line", { x1: -a * dx, y1: -a * dy, x2: a * dx, y2: a * dy, class: "major" }),
      ...orientationArcs(ellipse, Math.min(a + 7, radius + 9)),
    );
  } else {
    shapes.push(svg("text", { x: 0, y: -14, "text-anchor": "middle", class: "none" }, "no ellipse"));
  }
  const end = radius + 12;
  return svg(
    "svg",
    {
      viewBox: `${frame.left.toFixed(1)} ${frame.top.toFixed(1)} ${frame.width.toFixed(1)} ${frame.height.toFixed(1)}`,
      role: "img",
      "aria-label": `${title} ellipse: ${words}${reference > 0 ? `; reference circle ${plain(reference)} ${unit}` : ""}`,
      class: "ellipse-drawing",
    },
    posture && posture.points_m.length > 1 && drawPosture(posture, frame),
    svg("line", { x1: -end, y1: 0, x2: end, y2: 0, class: "axis" }),
    svg("line", { x1: 0, y1: -end, x2: 0, y2: end, class: "axis" }),
    svg("text", { x: end + 4, y: 4, class: "axis-name" }, "x"),
    svg("text", { x: 0, y: -end - 6, "text-anchor": "middle", class: "axis-name" }, "y"),
    reference > 0 && svg("circle", { r: r.toFixed(2), class: "reference" }),
    ...shapes,
    svg("circle", { r: 3.2, class: "hand" }),
    reference > 0 && referenceLabel(`${plain(reference)} ${unit}`, r, angle ?? 0, posture, frame),
  );
}

const largestOf = (ellipses: (Ellipse | undefined)[]): number => {
  const values = ellipses.flatMap((ellipse) => ellipse?.eigenvalues.map((v) => Math.abs(v ?? 0)) ?? []);
  return Math.max(...values, 0);
};

/** Room for the band as well, up to twice the ellipse: what is wider is cut off by the edge of the drawing. */
const roomFor = (ellipses: (Ellipse | undefined)[], bands: (Band | undefined)[]): number => {
  const largest = largestOf(ellipses);
  return Math.min(Math.max(largest, ...bands.flatMap((band) => band?.high ?? [])), 2 * largest);
};

const bandLegend = (): HTMLElement =>
  h("ul", { class: "legend" }, h("li", {},
    svg("svg", { width: 22, height: 12, "aria-hidden": "true" }, svg("rect", { x: 0.5, y: 0.5, width: 21, height: 11, class: "ellipse-band" })),
    "95 % of 1000 ellipses drawn from the covariance, in each direction"));

const postureWords = {
  arm: "The participant's arm is drawn from the recording's metadata, seen from above, at its own scale.",
  robot: "The robot's links are drawn from its joint angles, seen from above, at their own scale; the recording does not describe the arm.",
  hand: "The recording does not give the lengths of the arm, so only the hand is drawn, at the centre.",
};

/** The three ellipses of a result beside each other; `bands` by default are those of its covariance. */
export function ellipsePanels(result: Result, posture?: Posture, bands = bandsOf(result)): HTMLElement | undefined {
  const { ellipses } = result;
  if (!ellipses) return undefined;
  const units = unitsOf(result);
  return h(
    "div",
    { class: "panels" },
    ...matrices.map(({ symbol, name, title }, k) => {
      const largest = largestOf([ellipses[name]]);
      return h(
        "div",
        { class: "panel" },
        h("p", { class: "panel-title" }, `${title} ${symbol}`),
        drawing(ellipses[name], title, units[symbol], roomFor([ellipses[name]], [bands[k]]), niceBelow(0.8 * largest), posture, bands[k]),
      );
    }),
  );
}

/** One of the three, over the arm. */
export function ellipseOf(trial: Trial, k: number): SVGSVGElement | undefined {
  const matrix = matrices[k];
  const ellipse = matrix && trial.result.ellipses?.[matrix.name];
  if (!ellipse) return undefined;
  const band = ellipseBand(matrix.symbol, trial.result);
  return drawing(ellipse, matrix.title, unitsOf(trial.result)[matrix.symbol], roomFor([ellipse], [band]), niceBelow(0.8 * largestOf([ellipse])), trial.recordings[0]?.posture, band);
}

const bandsOf = (result: Result): (Band | undefined)[] => matrices.map(({ symbol }) => ellipseBand(symbol, result));

/** The three ellipses of one trial. */
export function ellipsesOf(trial: Trial): HTMLElement | undefined {
  const posture = trial.recordings[0]?.posture;
  const bands = bandsOf(trial.result);
  const panels = ellipsePanels(trial.result, posture, bands);
  if (!panels) return undefined;
  const words = [postureWords[posture?.of ?? "hand"], posture?.note ? `(${posture.note}.)` : ""].join(" ");
  return h(
    "figure",
    { class: "ellipses" },
    bands.some((band) => band) ? bandLegend() : "",
    panels,
    h(
      "figcaption",
      {},
      h("strong", {}, "How to read this. "),
      "The longer the ellipse in a direction, the more force it takes to move the hand that way. The dashed circle shows equal stiffness, damping or inertia in all directions, with the value written on it. The arcs at the ends of the major axis span the 95 % interval of its direction. ",
      words,
    ),
  );
}

/** Ellipses of several trials side by side, each matrix at one scale. */
export function ellipsesSideBySide(trials: Trial[], nameOf: (trial: Trial) => string): HTMLElement | undefined {
  const drawn = trials.filter((trial) => trial.result.ellipses && trial.result.usable);
  if (drawn.length < 2) return undefined;
  return h(
    "figure",
    { class: "ellipses side-by-side" },
    drawn.some((trial) => trial.result.covariance) ? bandLegend() : "",
    ...matrices.map(({ symbol, name, title }) => {
      const compared = drawn.map((trial) => trial.result.ellipses?.[name]);
      const bands = drawn.map((trial) => ellipseBand(symbol, trial.result));
      const largest = largestOf(compared);
      const reference = niceBelow(0.8 * largest);
      return h(
        "div",
        { class: "comparison" },
        h("p", { class: "panel-title" }, `${title} ${symbol}`),
        h(
          "div",
          { class: "panels" },
          ...drawn.map((trial, k) => {
            const unit = unitsOf(trial.result)[symbol];
            const ellipse = trial.result.ellipses?.[name] as Ellipse;
            return h(
              "div",
              { class: "panel" },
              drawing(ellipse, `${nameOf(trial)}: ${title}`, unit, roomFor(compared, bands), reference, undefined, bands[k]),
              h("p", { class: "panel-name" }, nameOf(trial)),
            );
          }),
        ),
      );
    }),
    h(
      "figcaption",
      {},
      h("strong", {}, "How to read this. "),
      "Within a row all ellipses have the same scale and all dashed circles the same value, so sizes can be compared directly.",
    ),
  );
}

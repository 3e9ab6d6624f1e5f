// Ellipsoids of matrices with three axes: their outlines on the planes of the frame, and one view in perspective.
import type { Result, Value } from "./documents";
import { h, svg } from "./dom";
import { niceBelow } from "./ellipses";
import { fixed, plain, significant } from "./format";
import { axisNames } from "./result";

export type Ellipsoid = NonNullable<Result["ellipsoids"]>["stiffness"];
export type Principal = Ellipsoid["principal"][number];
export type Three = [number, number, number];

const radius = 58; // of the largest ellipsoid [px]
const axisEnd = radius + 7;
const [left, top] = [-axisEnd - 3, -axisEnd - 16];
const viewBox = `${left} ${top} ${-2 * left + 12} ${-top - left}`;
const frame: [Three, Three, Three] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

const dot = (a: Three, b: Three): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const times = (S: number[][], v: Three): Three => S.map((row) => dot(row as Three, v)) as Three;
const cross = (a: Three, b: Three): Three => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (factor: number, a: Three): Three => a.map((x) => factor * x) as Three;
const sum = (...all: Three[]): Three => [0, 1, 2].map((k) => all.reduce((total, one) => total + (one[k] as number), 0)) as Three;
const unit = (a: Three): Three => scaled(1 / Math.sqrt(dot(a, a)), a);

const isNumber = (value: Value | undefined): value is number => typeof value === "number";

/** The symmetric part of a matrix, where all its numbers are known. */
export function symmetricPart(Z: Value[][]): number[][] | undefined {
  if (Z.length !== 3 || !Z.flat().every(isNumber)) return undefined;
  return Z.map((row, j) => row.map((value, i) => ((value as number) + (Z[i]?.[j] as number)) / 2));
}

/** Eigenvalues of a symmetric 3×3 matrix, largest first, with their unit vectors, by Jacobi's rotations. */
export function eigenAxes(S: number[][]): { value: number; direction: Three }[] {
  let A = S.map((row) => [...row]);
  let V: number[][] = frame.map((row) => [...row]);
  const product = (X: number[][], Y: number[][]) => X.map((row) => Y.map((_, i) => row.reduce((total, x, k) => total + x * (Y[k]?.[i] as number), 0)));
  const at = (i: number, j: number) => A[i]?.[j] as number;
  for (let sweep = 0; sweep < 12; ++sweep) {
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]] as const) {
      const angle = 0.5 * Math.atan2(2 * at(p, q), at(q, q) - at(p, p));
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      const G: number[][] = frame.map((row) => [...row]);
      (G[p] as number[])[p] = (G[q] as number[])[q] = c;
      (G[p] as number[])[q] = s;
      (G[q] as number[])[p] = -s;
      A = product(G.map((row, j) => row.map((_, i) => G[i]?.[j] as number)), product(A, G));
      V = product(V, G);
    }
  }
  return [0, 1, 2].map((k) => ({ value: at(k, k), direction: V.map((row) => row[k]) as Three })).sort((a, b) => b.value - a.value);
}

/** The planes of the frame: across, then up. */
export const planes = ([[0, 1], [0, 2], [1, 2]] as const).map(([across, up]) =>
  ({ name: axisNames(3)[across] + (axisNames(3)[up] ?? ""), axes: [across, up] as const, right: frame[across], up: frame[up] }));

/** The outline {P S u : |u| = 1} on the plane that two unit vectors span, the rows of P: an ellipse of matrix P S² Pᵀ. */
export function outline(S: number[][], right: Three, up: Three): { long: number; short: number; angle: number } {
  const [a, b] = [times(S, right), times(S, up)];
  const [xx, xy, yy] = [dot(a, a), dot(a, b), dot(b, b)];
  const [middle, reach] = [(xx + yy) / 2, Math.hypot((xx - yy) / 2, xy)];
  return { long: Math.sqrt(middle + reach), short: Math.sqrt(Math.max(middle - reach, 0)), angle: (Math.atan2(2 * xy, xx - yy) * 90) / Math.PI };
}

/** What can be drawn of an ellipsoid; nothing where there is none. */
interface Drawn {
  S: number[][];
  axes: { value: number; direction: Three }[];
}

function drawable({ closed, symmetric_part, principal }: Ellipsoid): Drawn | undefined {
  const S = symmetricPart(symmetric_part);
  const axes = principal.flatMap(({ value, direction }) => (isNumber(value) && value > 0 && direction.every(isNumber) ? [{ value, direction: direction as Three }] : []));
  return closed && S && axes.length === 3 ? { S, axes } : undefined;
}

const maximum = ({ principal }: Ellipsoid): number => principal[0]?.value ?? 0;

/** Whether the cone of a direction contains every direction: its value may equal another. */
export const anyDirection = ({ half_angle95_deg: half }: Principal): boolean => half !== null && half >= 89.999;

/** "(0.83, 0.55, −0.02), within 8°" */
export function directionText(one: Principal): string {
  if (anyDirection(one)) return "any direction";
  const { direction, half_angle95_deg: half } = one;
  return `(${direction.map((component) => fixed(component, 2)).join(", ")})${half === null ? "" : `, within ${fixed(half, half < 1 ? 1 : 0)}°`}`;
}

export const noEllipsoid = (title: string): string => `${title} is not positive beyond its interval: no ellipsoid.`;

const px = (value: number): string => value.toFixed(2);

/** The outline on one plane, with the circle of equal values in all directions and the major axis. */
function projection({ S, axes }: Drawn, plane: (typeof planes)[number], words: string, scale: number, reference: number): SVGSVGElement {
  const { long, short, angle } = outline(S, plane.right, plane.up);
  const [across, up] = plane.axes.map((k) => axisNames(3)[k] ?? "");
  const tip = scaled(scale * (axes[0]?.value ?? 0), axes[0]?.direction ?? [0, 0, 0]);
  const [x, y] = [dot(tip, plane.right), -dot(tip, plane.up)];
  return svg("svg", { viewBox, role: "img", class: "ellipse-drawing projection", "data-plane": plane.name, "aria-label": `${words}, outline on the ${plane.name} plane: semi-axes ${significant(long)} and ${significant(short)}, the longer at ${fixed((angle + 180) % 180, 0)}° from ${across} towards ${up}` },
    svg("line", { x1: -axisEnd, y1: 0, x2: axisEnd, y2: 0, class: "axis" }),
    svg("line", { x1: 0, y1: -axisEnd, x2: 0, y2: axisEnd, class: "axis" }),
    reference > 0 && svg("circle", { r: px(reference * scale), class: "reference" }),
    svg("ellipse", { rx: px(long * scale), ry: px(short * scale), transform: `rotate(${(-angle).toFixed(3)})`, class: "ellipse" }),
    svg("line", { x1: px(-x), y1: px(-y), x2: px(x), y2: px(y), class: "major" }),
    svg("text", { x: axisEnd + 3, y: 4, class: "axis-name" }, across),
    svg("text", { x: 0, y: -axisEnd - 4, "text-anchor": "middle", class: "axis-name" }, up),
    svg("text", { x: left + 1, y: top + 12, class: "plane-name" }, plane.name),
    svg("circle", { r: 2.4, class: "hand" }));
}

// The eye of the perspective drawing, in the frame: beside +x, before −y and above.
const [azimuth, elevation] = [(-52 * Math.PI) / 180, (22 * Math.PI) / 180];
const distance = 4; // from the centre, in radii of the largest ellipsoid
const nearRadius = 0.86 * radius; // what is near looks larger
const towardsEye: Three = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
const rightOfEye: Three = [-Math.sin(azimuth), Math.cos(azimuth), 0];
const upOfEye = cross(towardsEye, rightOfEye);
export const eyeWords = "The drawing in perspective is seen from +x and −y, with z upwards.";

const turn = Array.from({ length: 73 }, (_, k) => (2 * Math.PI * k) / 72);
const circle = (a: Three, b: Three): Three[] => turn.map((t) => sum(scaled(Math.cos(t), a), scaled(Math.sin(t), b)));

/** Where the eye sees a point, in units of `largest`. */
function seen(point: Three, largest: number): [number, number] {
  const nearer = distance / (distance - dot(point, towardsEye) / largest);
  return [(nearer * dot(point, rightOfEye)) / largest, (-nearer * dot(point, upOfEye)) / largest];
}

/** The ellipsoid in perspective: its outline, and the ellipses through each pair of principal axes, dashed where hidden. */
function perspective({ S, axes }: Drawn, words: string, largest: number): SVGSVGElement {
  const place = (point: Three) => seen(point, largest).map((one) => px(nearRadius * one)).join(" ");
  const path = (points: Three[]) => points.map((point, k) => `${k === 0 ? "M" : "L"} ${place(point)}`).join(" ");
  // S⁻¹ e, with e the eye: the surface at S u faces the eye where u·S⁻¹e > 1
  const facing = sum(...axes.map(({ value, direction }) => scaled((distance * largest * dot(direction, towardsEye)) / value, direction)));
  const square = dot(facing, facing);
  const first = unit(cross(facing, Math.abs(facing[0]) > Math.abs(facing[2]) ? frame[2] : frame[0]));
  const second = unit(cross(facing, first));
  const rim = Math.sqrt(1 - 1 / square);
  const contour = circle(scaled(rim, first), scaled(rim, second)).map((u) => times(S, sum(scaled(1 / square, facing), u)));
  const sections = ([[0, 1], [0, 2], [1, 2]] as const).flatMap(([i, j]) => {
    const around = circle(axes[i]?.direction as Three, axes[j]?.direction as Three);
    return [false, true].map((visible) => svg("path", {
      d: around.slice(1).flatMap((u, k) => {
        const before = around[k] as Three;
        return (dot(sum(u, before), facing) > 2) === visible ? [path([times(S, before), times(S, u)])] : [];
      }).join(" "),
      class: visible ? "section" : "section hidden",
    }));
  });
  const name = (axis: Three, k: number) => {
    const [x, y] = seen(scaled(1.32 * largest, axis), largest);
    return svg("text", { x: px(nearRadius * x), y: px(nearRadius * y + 4), "text-anchor": "middle", class: "axis-name" }, axisNames(3)[k] ?? "");
  };
  return svg("svg", { viewBox, role: "img", class: "ellipse-drawing perspective", "aria-label": `${words}, in perspective` },
    ...frame.map((axis) => svg("path", { d: path([-1.15, 1.15].map((end) => scaled(end * largest, axis))), class: "axis" })),
    svg("path", { d: `${path(contour)} Z`, class: "ellipse" }),
    ...sections,
    ...frame.map(name),
    svg("circle", { r: 2.4, class: "hand" }));
}

const describedBy = (ellipsoid: Ellipsoid, title: string, unitName: string): string =>
  `${title} ellipsoid: ${ellipsoid.principal.map((one) => `${significant(one.value)} ${unitName} along ${directionText(one)}`).join("; ")}`;

/** Three outlines at one scale, and one view in perspective; a sentence where there is no ellipsoid. */
export function ellipsoidDrawings(ellipsoid: Ellipsoid, title: string, unitName: string): HTMLElement {
  const drawn = drawable(ellipsoid);
  if (!drawn) return h("p", { class: "no-ellipsoid" }, noEllipsoid(title));
  const largest = maximum(ellipsoid);
  const reference = niceBelow(0.8 * largest);
  return h("div", { class: "ellipsoid-drawings" },
    perspective(drawn, describedBy(ellipsoid, title, unitName), largest),
    ...planes.map((plane) => projection(drawn, plane, title, radius / largest, reference)),
    h("p", { class: "panel-note" }, `Dashed circle: ${plain(reference)} ${unitName}.`));
}

/** The ellipsoids of several results beside each other, in perspective and at one scale. */
export function ellipsoidsBesideEachOther(all: { name: string; ellipsoid: Ellipsoid; unitName: string }[], title: string): HTMLElement {
  const largest = Math.max(0, ...all.filter(({ ellipsoid }) => drawable(ellipsoid)).map(({ ellipsoid }) => maximum(ellipsoid)));
  return h("div", { class: "panels" }, ...all.map(({ name, ellipsoid, unitName }) => {
    const drawn = drawable(ellipsoid);
    return h("div", { class: "panel" },
      drawn ? perspective(drawn, `${name}: ${describedBy(ellipsoid, title, unitName)}`, largest) : h("p", { class: "no-ellipsoid" }, noEllipsoid(title)),
      h("p", { class: "panel-name" }, name));
  }));
}

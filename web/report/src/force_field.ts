// The force of the stiffness around the equilibrium: −K (x − x₀), and what of it springs could make (Dyck 2013, fig. 3.12).
import { h, heading, type HeadingLevel, svg, table } from "@mbk/shared/dom";
import { data, plain, significant } from "@mbk/shared/format";
import { type Trial, unitsOf } from "@mbk/shared/result";
import { csvOf } from "@mbk/shared/sheet";
import { saveable } from "./picture";

type Pair = [number, number];
type Square = [Pair, Pair];

const reach = 0.01; // of the grid from the equilibrium, in the unit of the position
const steps = [-1, -0.5, 0, 0.5, 1];
const half = 84; // of the grid [px]
const longest = 34; // arrow [px]

const force = (K: Square, [x, y]: Pair): Pair => [-(K[0][0] * x + K[0][1] * y), -(K[1][0] * x + K[1][1] * y)];
const size = ([x, y]: Pair): number => Math.hypot(x, y);

/** The matrix, and its symmetric and antisymmetric parts. */
function partsOf(K: Square): { name: string; key: string; matrix: Square; meaning: string }[] {
  const mean = (K[0][1] + K[1][0]) / 2;
  const k_a = (K[0][1] - K[1][0]) / 2;
  return [
    { name: "whole K", key: "whole", matrix: K, meaning: "the whole force" },
    { name: "symmetric part", key: "symmetric", matrix: [[K[0][0], mean], [mean, K[1][1]]], meaning: "elastic: it returns the energy that it stores" },
    { name: "antisymmetric part", key: "antisymmetric", matrix: [[0, k_a], [-k_a, 0]], meaning: "rotates around the equilibrium: a spring cannot produce it" },
  ];
}

function arrow([x, y]: Pair, [fx, fy]: Pair, perNewton: number): SVGElement {
  const [dx, dy] = [fx * perNewton, -fy * perNewton];
  const [x1, y1] = [x * half, -y * half];
  const length = Math.hypot(dx, dy);
  const head = Math.min(6, 0.45 * length);
  const [ux, uy] = length > 0 ? [dx / length, dy / length] : [0, 0];
  const at = (back: number, side: number) => `${(x1 + dx - back * ux - side * uy).toFixed(2)} ${(y1 + dy - back * uy + side * ux).toFixed(2)}`;
  return svg("g", { class: "force" },
    svg("line", { x1: x1.toFixed(2), y1: y1.toFixed(2), x2: (x1 + dx).toFixed(2), y2: (y1 + dy).toFixed(2) }),
    svg("path", { d: `M ${at(0, 0)} L ${at(head, head * 0.45)} L ${at(head, -head * 0.45)} Z` }));
}

function drawing(name: string, matrix: Square, perNewton: number, words: string): SVGSVGElement {
  const room = half + longest + 22;
  const axis = half + longest + 4;
  return svg("svg", { viewBox: `${-room} ${-room} ${2 * room} ${2 * room}`, role: "img", class: "force-field", "aria-label": `Force field of the ${name}: ${words}` },
    svg("line", { x1: -axis, y1: 0, x2: axis, y2: 0, class: "axis" }),
    svg("line", { x1: 0, y1: -axis, x2: 0, y2: axis, class: "axis" }),
    svg("text", { x: axis + 4, y: 4, class: "axis-name" }, "x"),
    svg("text", { x: 0, y: -axis - 5, "text-anchor": "middle", class: "axis-name" }, "y"),
    ...steps.flatMap((y) => steps.filter((x) => x !== 0 || y !== 0).map((x) => arrow([x, y], force(matrix, [x * reach, y * reach]), perNewton))),
    svg("circle", { r: 3.2, class: "hand" }));
}

/** Every arrow. */
function fieldCsv(parts: { name: string; matrix: Square }[], { x0, force: unit }: { x0: string; force: string }): string {
  return csvOf(["part of K", `x − x0 [${x0}]`, `y − y0 [${x0}]`, `force x [${unit}]`, `force y [${unit}]`],
    parts.flatMap(({ name, matrix }) => steps.flatMap((y) => steps.map((x) => {
      const at: Pair = [x * reach, y * reach];
      return [name, ...at, ...force(matrix, at)];
    }))));
}

export function forceFieldSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const K = trial.result.model.K;
  if (!trial.result.usable || trial.result.axes !== 2 || K.flat().length !== 4 || K.flat().some((value) => value === null)) return undefined;
  const units = unitsOf(trial.result);
  const parts = partsOf(K as Square);
  const largest = Math.max(...parts.flatMap(({ matrix }) => steps.flatMap((y) => steps.map((x) => size(force(matrix, [x * reach, y * reach]))))));
  if (!(largest > 0)) return undefined;
  const distance = units.x0 === "m" ? "1 cm" : `${plain(reach)} ${units.x0}`;
  const along: { axis: string; at: Pair }[] = [{ axis: "x", at: [reach, 0] }, { axis: "y", at: [0, reach] }];
  const rows = parts.map(({ name, key, matrix }): (Node | string)[] => [
    name,
    ...along.flatMap(({ axis, at }) => {
      const [fx, fy] = force(matrix, at);
      return [data(fx, significant(fx), `${key}-${axis}-fx`), data(fy, significant(fy), `${key}-${axis}-fy`)];
    }),
  ]);
  return h("section", { id: `${id}-force-field` },
    heading(level, "Force field of the stiffness"),
    saveable(h("figure", { class: "force-fields" },
      h("div", { class: "panels" }, ...parts.map(({ name, matrix, meaning }) => {
        const [fx, fy] = along.map(({ at }) => force(matrix, at)) as [Pair, Pair];
        const words = `${distance} along x the force is ${significant(fx[0])} and ${significant(fx[1])} ${units.force}, ${distance} along y ${significant(fy[0])} and ${significant(fy[1])} ${units.force}`;
        return h("div", { class: "panel" }, h("p", { class: "panel-title" }, name), drawing(name, matrix, longest / largest, words), h("p", { class: "panel-name" }, meaning));
      })),
      h("figcaption", {}, h("strong", {}, "How to read this. "),
        `Each arrow shows the force −K (x − x₀) of the limb at its tail, on a grid up to ${distance} from the equilibrium in the centre. All three panels have the same scale; the longest arrow is `, data(largest, significant(largest), "largest-force"), ` ${units.force}. Around a closed path the left and right fields can do work; the middle one cannot.`)), { name: `${id}-force-field`, title: "Force field of the stiffness", csv: () => fieldCsv(parts, units) }),
    table(`Force of the limb ${distance} from the equilibrium [${units.force}]`, ["", "along x: force x", "force y", "along y: force x", "force y"], rows, "numbers"));
}

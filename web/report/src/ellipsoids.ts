// Ellipsoids of a result with three axes: drawings, principal values, volume and antisymmetric part.
import { h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { anyDirection, directionText, ellipsoidDrawings, ellipsoidsBesideEachOther, eyeWords, type Ellipsoid, noEllipsoid } from "@mbk/shared/ellipsoids";
import { data, significant, valueWithInterval, withInterval } from "@mbk/shared/format";
import { matrices, type Trial, unitsOf } from "@mbk/shared/result";
import { csvOf } from "@mbk/shared/sheet";
import { fileOf } from "./data";
import { threeDigits } from "./passivity";
import { saveable } from "./picture";

export const cubed = (unit: string): string => `${/[·/]/.test(unit) ? `(${unit})` : unit}³`;

/** The volume with its unit; why there is none where there is no ellipsoid. */
export const volumeOf = ({ closed, volume, interval95 }: Ellipsoid, unit: string, name: string): HTMLElement | string =>
  closed ? h("span", {}, valueWithInterval(volume, interval95.volume, name), ` ${cubed(unit)}`) : "none";

const ellipsoidOf = (trial: Trial, name: (typeof matrices)[number]["name"]): Ellipsoid | undefined => trial.result.ellipsoids?.[name];
const drawnOf = (trials: Trial[]): Trial[] => trials.filter(({ result }) => result.ellipsoids && result.usable);

function ellipsoidsCsv(all: { name: string; trial: Trial }[]): string {
  return csvOf(["recording", "matrix", "unit", "principal value", "low", "high", "direction x", "direction y", "direction z", "half-angle of the 95 % cone [°]", "volume", "volume, low", "volume, high", "shape", "shape, low", "shape, high"],
    all.flatMap(({ name: recording, trial }) => matrices.flatMap(({ symbol, name }) => {
      const e = ellipsoidOf(trial, name);
      return (e?.principal ?? []).map(({ value, value95, direction, half_angle95_deg: half }) =>
        [recording, symbol, unitsOf(trial.result)[symbol], value, ...value95, ...direction, half, e?.volume, ...(e?.interval95.volume ?? []), e?.shape, ...(e?.interval95.shape ?? [])]);
    })));
}

function antisymmetryTable(trial: Trial): HTMLElement | undefined {
  const vectors = trial.result.antisymmetry_vectors;
  if (!vectors) return undefined;
  const rows = (["inertia", "stiffness"] as const).map((name): (Node | string)[] => {
    const { vector, vector95, size, size95, significant: found, percent } = vectors[name];
    const unit = unitsOf(trial.result)[name === "inertia" ? "M" : "K"];
    return [`${name} ${name === "inertia" ? "M" : "K"}`, ...vector.map((value, k) => valueWithInterval(value, vector95[k] ?? [null, null], `${name}-vector${k}`)),
      h("span", {}, valueWithInterval(size, size95, `${name}-vector-size`), ` ${unit}`),
      percent === null ? "undefined" : h("span", { class: "number" }, data(percent, significant(percent), `${name}-antisymmetry`), " %"),
      found ? h("strong", {}, "significant") : "not significant"];
  });
  return table("Antisymmetric part as the vector z with (Z − Zᵀ)/2 u = z × u, and its size relative to the geometric mean of the principal values; brackets are 95 % intervals", ["", "x", "y", "z", "size", "relative", ""], rows, "numbers overview");
}

export function ellipsoidsSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const { ellipsoids } = trial.result;
  if (!ellipsoids || !trial.result.usable) return undefined;
  const units = unitsOf(trial.result);
  const principal = matrices.flatMap(({ symbol, name }) => ellipsoids[name].principal.map((one, k): (Node | string)[] => [
    `${name} ${symbol}, ${["largest", "middle", "smallest"][k]}`, valueWithInterval(one.value, one.value95, `${name}-${k}`), units[symbol], directionText(one)]));
  const sizes = matrices.map(({ symbol, name }): (Node | string)[] => {
    const e = ellipsoids[name];
    return [`${name} ${symbol}`, volumeOf(e, units[symbol], `${name}-volume`), e.closed ? withInterval(e.shape, e.interval95.shape, `${name}-shape`, threeDigits(e.shape)) : noEllipsoid(symbol)];
  });
  const figure = h("figure", { class: "ellipsoids" },
    ...matrices.flatMap(({ symbol, name, title }) => [h("p", { class: "panel-title" }, `${title} ${symbol}`), ellipsoidDrawings(ellipsoids[name], title, units[symbol])]),
    h("figcaption", {}, h("strong", {}, "How to read this. "),
      `Move the hand over a unit sphere: the force of the symmetric part traces the ellipsoid. The outlines are its projections on the xy, xz and yz planes; the straight line is the projection of the longest axis. ${eyeWords} Its inner curves join the principal axes, dashed where they are hidden.`));
  return h("section", { id: `${id}-ellipsoids` },
    heading(level, "Ellipsoids"),
    saveable(figure, { name: `${id}-ellipsoids`, title: "Ellipsoids", csv: () => ellipsoidsCsv([{ name: fileOf(trial), trial }]) }),
    table("Principal values and directions of the symmetric parts; brackets are 95 % intervals", ["", "value", "unit", "direction (x, y, z)"], principal, "numbers principal"),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "A direction is a unit vector without an arrow: its opposite means the same. The angle after it is the half-angle of the 95 % cone around it.",
      Object.values(ellipsoids).some((e) => e.principal.some(anyDirection)) ? " “Any direction” means that the value may equal another, so its direction is not determined." : ""),
    table("Volume, and shape: the largest over the smallest principal value; brackets are 95 % intervals", ["", "volume", "shape"], sizes, "numbers narrow"),
    antisymmetryTable(trial));
}

/** A table of the ellipsoids of several results, and their drawings at one scale. */
export function ellipsoidsOfSeveral(trials: Trial[], nameOf: (trial: Trial) => string): HTMLElement[] {
  const drawn = drawnOf(trials);
  if (drawn.length === 0) return [];
  const rows = drawn.flatMap((trial) => matrices.map(({ symbol, name }): (Node | string)[] => {
    const e = ellipsoidOf(trial, name) as Ellipsoid;
    const [first] = e.principal;
    const unit = unitsOf(trial.result)[symbol];
    return [nameOf(trial), symbol, h("span", {}, valueWithInterval(first.value, first.value95, `${name}-largest`), ` ${unit}`), directionText(first), volumeOf(e, unit, `${name}-volume`)];
  }));
  const made = [table("Ellipsoids: largest principal value, its direction (x, y, z) and the volume; brackets are 95 % intervals", ["recording", "", "largest", "direction", "volume"], rows, "numbers overview")];
  if (drawn.length < 2) return made;
  return [...made, saveable(h("figure", { class: "ellipses side-by-side" },
    ...matrices.map(({ symbol, name, title }) => h("div", { class: "comparison" },
      h("p", { class: "panel-title" }, `${title} ${symbol}`),
      ellipsoidsBesideEachOther(drawn.map((trial) => ({ name: nameOf(trial), ellipsoid: ellipsoidOf(trial, name) as Ellipsoid, unitName: unitsOf(trial.result)[symbol] })), title))),
    h("figcaption", {}, h("strong", {}, "How to read this. "), `Within a row all ellipsoids have the same scale. ${eyeWords}`)), {
    name: "ellipsoids-side-by-side", title: "Ellipsoids side by side", csv: () => ellipsoidsCsv(drawn.map((trial) => ({ name: nameOf(trial), trial }))),
  })];
}

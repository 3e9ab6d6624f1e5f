// Parts of an exploration that belong to a protocol or to time: change, the first moment after onset, ramps and holds.
import type { AfterOnsetEstimate, Exploration, PlateauStiffnessEstimate, ReachPredictor, ReachStiffnessEstimate, StiffnessRegression, TimeCourseEstimate, Value } from "@mbk/shared/documents";
import { facts, h, heading, table } from "@mbk/shared/dom";
import { anyAngle } from "@mbk/shared/ellipses";
import { data, fixed, significant } from "@mbk/shared/format";
import { axisNames } from "@mbk/shared/result";
import { figure, type Panel, styles } from "./charts";
import { elementHeads, matrixRows } from "./matrix_rows";

export interface ImpedanceUnits {
  M: string;
  B: string;
  K: string;
}

const matrices = [["inertia", "M"], ["damping", "B"], ["stiffness", "K"]] as const;

/** value ± half width with the digits that the half width leaves. */
export const margin = (value: Value, half: Value, name: string): HTMLElement =>
  data(value, value === null ? "undefined" : half === null ? significant(value, 3) : `${significant(value, 3)} ± ${significant(half, 2)}`, name);

const milliseconds = (seconds: Value): string => `${significant(seconds === null ? null : 1000 * seconds, 3)} ms`;
const entries = (axes: number): string[] => elementHeads(axes, "value ± 95 %");
const chance = (p: Value): string => (p !== null && p < 1e-12 ? "p < 10⁻¹²" : `p = ${significant(p, 2)}`);

/** The k-th entry of a matrix that stands column by column. */
const entryName = (axes: number, k: number): string => (axes === 1 ? "" : `_${axisNames(axes)[k % axes]}${axisNames(axes)[Math.floor(k / axes)]}`);

export function courseSection(found: TimeCourseEstimate, { axes }: Exploration, units: ImpedanceUnits): HTMLElement {
  const panels = matrices.flatMap(([, symbol]): Panel[] => {
    const one = found[symbol];
    return (one.value ?? []).map((value, k) => {
      const half = one.half_width95?.[k] ?? [];
      const end = (sign: number): Value[] => value.map((v, i) => (v === null || (half[i] ?? null) === null ? null : v + sign * (half[i] as number)));
      const constant = one.constant[k % axes]?.[Math.floor(k / axes)] ?? null;
      return {
        title: `${symbol}${entryName(axes, k)}`,
        unit: units[symbol],
        series: [
          { name: "along it", x: found.at, y: value, style: styles.first, between: { low: end(-1), high: end(1), name: "95 % interval, pointwise" } },
          { name: "constant model", x: found.at, y: value.map(() => constant), style: styles.second },
        ],
      };
    });
  });
  const rows = matrices.flatMap(([name, symbol]) => matrixRows(`${name} ${symbol}`, axes,
    (i, j) => margin(found[symbol].constant[i]?.[j] ?? null, found[symbol].constant_half_width95[i]?.[j] ?? null, `constant-${symbol}${i}${j}`), () => [units[symbol]]));
  return h("section", { id: "course" }, heading(2, "Change over time"),
    h("p", {}, h("strong", {}, found.verdict === "changes" ? "The limb changes. " : "No change is detected. "), `${found.why.charAt(0).toUpperCase()}${found.why.slice(1)}. `,
      found.instruments ? "Instrumental variables: only the motion that the reference explains was used." : "Least squares, without a reference: biased if the force moves the robot."),
    panels.length > 0
      ? figure({
          id: "course-chart",
          title: `M, B and K over ${found.variable}`,
          howToRead: "Where the dashed line leaves the band, the value differs from that of a constant limb. The spline smooths sudden changes.",
          description: `${found.varying} along ${found.variable}.`,
          x: { name: found.variable, unit: found.unit },
          panels,
          panelHeight: 120,
        })
      : undefined,
    table("Constant model; ± is half of the 95 % interval", ["", ...entries(axes), "unit"], rows, "numbers"));
}

export function onsetSection(found: AfterOnsetEstimate, { axes }: Exploration, units: ImpedanceUnits): HTMLElement {
  const rows = matrices.flatMap(([name, symbol]) => {
    const one = found[symbol];
    return matrixRows(`${name} ${symbol}`, axes, (i, j) => margin(one.value[i]?.[j] ?? null, one.half_width95[i]?.[j] ?? null, `onset-${symbol}${i}${j}`),
      () => [units[symbol], one.identifiable ? "" : h("strong", {}, "not identifiable")]);
  });
  return h("section", { id: "onset" }, heading(2, "First milliseconds after onset"),
    h("p", {}, `The first ${milliseconds(found.window_s)} after ${found.onsets} onsets of the reference, before a voluntary response; ${found.omitted_onsets} more were omitted because the limb did not rest before them or the recording is too short.`),
    table("M, B and K of the limb alone; ± is half of the 95 % interval", ["", ...entries(axes), "unit", ""], rows, "numbers"),
    facts([["VAF", found.VAF.map((value) => `${fixed(value ?? NaN, 1)} %`).join(", ")]]));
}

/// Each entry of K with its 95 % interval.
function stiffnessRows(label: string, name: string, stiffness: StiffnessRegression, unit: string): (Node | string)[][] {
  const entry = (i: number, j: number): HTMLElement => {
    const [low, high] = stiffness.interval95[i]?.[j] ?? [null, null];
    return h("span", {}, data(stiffness.K[i]?.[j] ?? null, significant(stiffness.K[i]?.[j] ?? null, 3), `${name}-K${i}${j}`), ` [${significant(low ?? null, 3)}, ${significant(high ?? null, 3)}]`);
  };
  return matrixRows(label, stiffness.K.length, entry, () => [unit]);
}

const stiffnessHeads = (axes: number): string[] => ["", ...elementHeads(axes, "value [95 %]"), "unit"];

function ellipseWords({ ellipse }: StiffnessRegression): string | undefined {
  if (!ellipse) return undefined;
  const [shapeLow, shapeHigh] = ellipse.interval95.shape;
  const [turnLow, turnHigh] = ellipse.interval95.orientation_deg;
  if (anyAngle(ellipse.interval95.orientation_deg)) return `shape ${significant(ellipse.shape, 3)} [${significant(shapeLow ?? null, 3)}, ${significant(shapeHigh ?? null, 3)}], orientation any: may be a circle`;
  return `shape ${significant(ellipse.shape, 3)} [${significant(shapeLow ?? null, 3)}, ${significant(shapeHigh ?? null, 3)}], orientation ${fixed(ellipse.orientation_deg ?? NaN, 1)}° [${fixed(turnLow ?? NaN, 1)}, ${fixed(turnHigh ?? NaN, 1)}]`;
}

export function plateauSection(found: PlateauStiffnessEstimate, { axes }: Exploration, units: ImpedanceUnits): HTMLElement {
  const { stiffness } = found;
  return h("section", { id: "plateaus" }, heading(2, "Ramps and holds"),
    h("p", {}, `The force while the hand is held, ${milliseconds(found.plateau_s[0] ?? null)} to ${milliseconds(found.plateau_s[1] ?? null)} after the onset (${found.window_rule}), over ${stiffness.displacements} displacements in ${stiffness.directions} directions.`),
    found.usable
      ? table("Stiffness; brackets are 95 % intervals", stiffnessHeads(axes), stiffnessRows("stiffness K", "plateau", stiffness, units.K), "numbers")
      : h("p", { "data-name": "no-stiffness" }, "The stiffness is not usable and not shown; see the warnings."),
    facts([
      ["Ellipse", found.usable ? ellipseWords(stiffness) : undefined],
      ["Test of one stiffness for all directions", chance(stiffness.linear_p ?? null)],
      ["Displacement reached", `${fixed(100 * (stiffness.reached ?? NaN), 0)} % of the commanded displacement`],
    ]));
}

export function reachSection(found: ReachStiffnessEstimate, { axes }: Exploration, units: ImpedanceUnits): HTMLElement {
  const { own_past: own, mean_reach: mean } = found;
  const off = (by: ReachPredictor): string => `${fixed(1e3 * (by.prediction_error ?? NaN), 1)} mm`;
  return h("section", { id: "reaches" }, heading(2, "Stiffness while the hand reaches"),
    h("p", {}, `The force ${milliseconds(found.window_s[0] ?? null)} to ${milliseconds(found.window_s[1] ?? null)} after the event “${found.trigger}”, over ${own.stiffness.displacements} displacements in ${own.stiffness.directions} directions, relative to the undisturbed hand position predicted from ${found.undisturbed} undisturbed reaches and the reach's own past.`),
    found.usable
      ? table("Stiffness; brackets are 95 % intervals", stiffnessHeads(axes), [
          ...stiffnessRows("from each reach's own past", "reach", own.stiffness, units.K),
          ...stiffnessRows("for comparison: minus the mean reach", "mean-reach", mean.stiffness, units.K)], "numbers")
      : h("p", { "data-name": "no-stiffness" }, "The stiffness is not usable and not shown; see the warnings."),
    facts([
      ["Ellipse", found.usable ? ellipseWords(own.stiffness) : undefined],
      ["Prediction error (cross-validated)", `${off(own)}; with the mean reach ${off(mean)}`],
      ["Displacement reached", `${fixed(100 * (own.stiffness.reached ?? NaN), 0)} % of the commanded displacement`],
    ]));
}

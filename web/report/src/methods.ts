// How far the numbers can be trusted: the other method beside this one, instruments, bootstrap.
import type { Bootstrap, Instrument, Interval, Method, Value } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { data, decimalsFor, fixed, perAxis, plain, significant, undefinedText, withHalfWidth } from "@mbk/shared/format";
import { axisNames, matrices, type Trial, unitsOf } from "@mbk/shared/result";
import { modelBy } from "./data";
import { methodNames } from "./words";

const both: Method[] = ["ls", "iv"];
const strongF = 104.7; // first-stage F from which ±1.96 standard errors are a 95 % interval (Lee et al. 2022)

/** "K_xy", or "K" where there is one axis. */
const elements = (axes: number) => {
  const names = axisNames(axes);
  return matrices.flatMap(({ symbol }) => names.flatMap((row, j) => names.map((column, i) => ({ symbol, name: `${symbol} ${row}${column}`.trim(), j, i }))));
};

/** "k_xy" as it is called in the tables: "K xy". */
const parameterName = (name: string): string => (/^[mbk](_|$)/.test(name) ? `${name[0]?.toUpperCase()}${name.slice(1)}`.replace("_", " ") : name);

function comparison(trial: Trial): HTMLElement | undefined {
  const { axes, fit, alternatives } = trial.result;
  const other = alternatives?.[0];
  if (!other) return undefined;
  const units = unitsOf(trial.result);
  const usable = (method: Method): boolean => (method === other.method ? other.usable : trial.result.usable);
  const shown = both.filter(usable);
  if (shown.length === 0) return undefined;
  const columns = shown.map((method) => ({ method, found: modelBy(method, trial) }));
  const rows: (Node | string)[][] = elements(axes).map(({ symbol, name, j, i }) => [
    name,
    ...columns.map(({ method, found }) => (found ? withHalfWidth(found.model[symbol][j]?.[i] ?? null, found.standard_error[symbol][j]?.[i] ?? null, `${method}-${symbol}${j}${i}`) : "")),
    units[symbol],
  ]);
  rows.push(["VAF", ...shown.map((method) => perAxis((method === other.method ? other.fit : fit).VAF, 1, "%", `${method}-VAF`)), ""]);
  return table(shown.length === 2 ? "Results of both methods from the same recording; ± is half of the 95 % interval" : `Results of ${methodNames[shown[0] as Method]} only, since the other method is not usable here; ± is the 95 % interval`, ["", ...shown.map((method) => `${methodNames[method]}${method === trial.result.method ? " (the model above)" : ""}`), "unit"], rows, "numbers methods");
}

function disagreement(trial: Trial): HTMLElement | undefined {
  const { disagreement: d, axes } = trial.result;
  if (!d) return undefined;
  const unit = unitsOf(trial.result)[(d.parameter[0] ?? "").toUpperCase() as "M" | "B" | "K"] ?? unitsOf(trial.result).x0;
  const instrument = trial.result.instrument ?? trial.result.alternatives.find((one) => one.instrument)?.instrument;
  const other = trial.result.alternatives[0];
  const holds = instrument?.strong && (trial.result.method === "iv" ? trial.result.usable : other?.usable);
  if (!holds) return h("p", { "data-significant": "unknown" }, h("strong", {}, "Instrumental variables gave no usable result, so they cannot be compared with least squares."));
  const share = d.least_squares ? `, ${significant(Math.abs((100 * (d.iv_less_ls ?? 0)) / d.least_squares), 2)} % of the least-squares value` : "";
  const numbers = [`The largest difference is in ${parameterName(d.parameter)}: `, withHalfWidth(d.iv_less_ls, d.standard_error, "iv-less-ls"), ` ${unit}${share}`];
  if (!d.significant) return h("p", { "data-significant": "false" }, h("strong", {}, "The two methods do not differ significantly (99 %). "), ...numbers, ".");
  return h("p", { "data-significant": "true" }, h("strong", {}, "The two methods differ significantly (99 %). "), ...numbers,
    `. Least squares attributes voluntary or reflex activity of the ${axes === 1 ? "limb" : "arm"} to mechanics. Instrumental variables use only the part of the motion that follows the known perturbation, which spontaneous activity does not. If the instruments are strong and the methods differ, instrumental variables are more reliable.`);
}

function instrumentTable(instrument: Instrument, trial: Trial): HTMLElement {
  const { axes } = trial.result;
  const names = ["acceleration", "velocity", "position"].flatMap((kind) => axisNames(axes).map((axis) => `${kind} ${axis}`.trim()));
  const rows: (Node | string)[][] = instrument.first_stage_F.map((value, k) => [names[k] ?? `${k + 1}`, data(value, significant(value), `first-stage-F${k}`), value === null ? "?" : value > strongF ? "✓ strong" : "✕ weak"]);
  return h("div", {},
    h("p", {}, h("strong", {}, instrument.strong ? "The instruments are strong. " : "The instruments are weak. "),
      "They are made from the commanded ", instrument.reference, "; the weakest first-stage F is ", data(instrument.weakest_F, significant(instrument.weakest_F), "weakest-F"),
      instrument.strong ? `, above ${strongF}.` : `, not above ${strongF}: the intervals of instrumental variables are not valid.`,
      " Perturbation-coherent residual fraction (share of the residual of instrumental variables that still follows the perturbation, by reflex or because the limb has more dynamics than inertia, damping and stiffness): ",
      perAxis(instrument.coherent_residual_fraction.map((share) => (share === null ? null : 100 * share)), 0, "%", "answered"), "."),
    table("Strength of the instruments: first-stage F of each signal, given the others", ["", "F", ""], rows, "numbers narrow instruments"));
}

function bootstrapTable(b: Bootstrap): HTMLElement {
  const rows = b.quantities.map((q, k): (Node | string)[] => {
    const isAngle = q.unit === "rad" && q.name.endsWith("orientation");
    const shown = (value: Value): Value => (value === null || !isAngle ? value : (value * 180) / Math.PI);
    const [low, high] = q.interval95.map(shown) as Interval;
    const decimals = low === null || high === null ? 3 : decimalsFor((high - low) / 2);
    const interval = (ends: Interval, name: string): Node => {
      const [from, to] = ends.map(shown) as Interval;
      return from === null || to === null
        ? h("span", {}, undefinedText)
        : h("span", { class: "number" }, "[", data(from, fixed(from, decimals), `${name}-low`), ", ", data(to, fixed(to, decimals), `${name}-high`), "]");
    };
    const value = shown(q.value);
    return [
      parameterName(q.name),
      data(value, low === null ? significant(value) : fixed(value, decimals), `bootstrap${k}`),
      interval(q.interval95, `bootstrap${k}`),
      interval(q.delta_interval95, `delta${k}`),
      isAngle ? "°" : q.unit,
    ];
  });
  return h("div", {},
    table("95 % intervals by bootstrap and by linearisation (delta method)", ["", "value", "bootstrap", "delta method", "unit"], rows, "numbers bootstrap"),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), `The estimation was repeated ${b.replicates} times on blocks of ${plain(b.block_s)} s drawn from the recording (seed ${b.seed}). If the two intervals differ much, trust the bootstrap: the delta method linearises angles and eigenvalues.`));
}

/** What a second method and a second kind of interval say. */
export function methodsSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const { alternatives, bootstrap } = trial.result;
  const instrument = trial.result.instrument ?? alternatives?.find((one) => one.instrument)?.instrument;
  const parts = [disagreement(trial), comparison(trial), instrument && instrumentTable(instrument, trial), bootstrap && trial.result.usable ? bootstrapTable(bootstrap) : undefined].filter((part) => part !== undefined);
  if (parts.length === 0) return undefined;
  return h("section", { id: `${id}-methods` }, heading(level, "Comparison of methods and intervals"), ...parts);
}

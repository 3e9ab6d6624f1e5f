// Outcomes of a study in words, and their numbers.
import type { OutcomeCourses, SessionChange, Value } from "@mbk/shared/documents";
import { fixed, significant } from "@mbk/shared/format";
import { axisNames } from "@mbk/shared/result";

const quantities: Record<string, string> = { inertia: "inertia", damping: "damping", stiffness: "stiffness" };
const symbols: Record<string, string> = { M: "inertia", B: "damping", K: "stiffness" };
const parts: Record<string, (quantity: string) => string> = {
  area: (quantity) => `area of the ${quantity} ellipse`,
  shape: (quantity) => `shape of the ${quantity} ellipse`,
  orientation: (quantity) => `orientation of the ${quantity} ellipse`,
  zmean: (quantity) => `antisymmetric share of ${quantity}`,
  lambda_max: (quantity) => `largest ${quantity}`,
  lambda_min: (quantity) => `smallest ${quantity}`,
  symmetric_xy: (quantity) => `${quantity} xy, symmetric part`,
  antisymmetric: (quantity) => `${quantity} xy, antisymmetric part`,
};
const others: Record<string, string> = {
  x0: "equilibrium",
  VAF: "variance accounted for",
  RMSE: "error of the model",
  ...Object.fromEntries(axisNames(3).flatMap((axis) => [[`x0_${axis}`, `equilibrium ${axis}`], [`VAF_${axis}`, `variance accounted for, ${axis}`], [`RMSE_${axis}`, `error of the model, ${axis}`]])),
  absorbed_energy: "energy absorbed in the trial",
  min_passivity_index: "minimum passivity index",
  excess_of_passivity: "excess of passivity",
};

const stretches: Record<string, string> = {
  slope: "slope of resistance over speed",
  torque: "resistance at the fastest speed",
  rise: "rise of that slope within the stretch",
  catch: "angle of catch at the fastest speed",
  threshold: "threshold at rest",
  work: "work of the loop at the fastest speed",
};

/** "stiffness_area" → "area of the stiffness ellipse" */
export function outcomeName(name: string): string {
  if (others[name]) return others[name];
  const [, way = "", stretch = ""] = /^stretch_(increasing|decreasing)_(.+)$/.exec(name) ?? [];
  if (stretches[stretch]) return `${stretches[stretch]}${way === "decreasing" ? ", position decreasing" : ""}`;
  const [, muscle = "", direction = "", response = ""] = /^emg_(.+)_direction(\d+)_(.+)$/.exec(name) ?? [];
  if (muscle) return `${muscle.replaceAll("_", " ")}, direction ${direction}: ${response === "latency" ? "latency" : `${response.replaceAll("_", " ")} EMG over background`}`;
  const [first = "", ...rest] = name.split("_");
  const part = rest.join("_");
  const of = quantities[first] ? parts[part] : undefined;
  if (of) return of(first);
  if (symbols[first] && rest.length === 0) return symbols[first];
  if (symbols[first] && /^[xyz]{2}$/.test(part)) return `${symbols[first]} ${part}`;
  return name.replaceAll("_", " ");
}

/** What tables show first: eigenvalues and ellipses, then the elements; the others say how good a fit is, or where it was. */
const ranked = (name: string): number => {
  const stretch = /^stretch_(increasing|decreasing)_(.+)$/.exec(name);
  if (stretch) return Object.keys(stretches).indexOf(stretch[2] ?? "") + (stretch[1] === "decreasing" ? 10 : 0);
  if (/^emg_.+_direction\d+_/.test(name)) return 20;
  const order = ["stiffness", "damping", "inertia", "K", "B", "M"];
  const first = order.indexOf(name.split("_")[0] ?? "");
  if (first < 0) return 100;
  if (first > 2) return 30 + first;
  const parts_ = ["lambda_max", "lambda_min", "area", "shape", "orientation"];
  const part = parts_.indexOf(name.slice(name.indexOf("_") + 1));
  return part < 0 ? 60 + first : parts_.length * first + part;
};
/** An ellipse, or what stands for it where there is one axis. */
export const isFirst = (name: string): boolean => ranked(name) < 30 || /^[MBK]$/.test(name);
export const isMain = (name: string): boolean => ranked(name) < 60;
export const inOutcomeOrder = <T>(all: T[], nameOf: (one: T) => string): T[] =>
  all.map((one, k) => ({ one, k })).sort((a, b) => ranked(nameOf(a.one)) - ranked(nameOf(b.one)) || a.k - b.k).map(({ one }) => one);

export const conditionName = (condition: string): string => condition || "no condition";
export const withUnit = (text: string, unit: string): string => (unit ? `${text}${unit === "°" ? "" : " "}${unit}` : text);

/** So many decimals that a difference of this size shows in three digits. */
export function decimalsOf(size: Value): number {
  return size === null || !(Math.abs(size) > 0) ? 2 : Math.min(Math.max(2 - Math.floor(Math.log10(Math.abs(size))), 0), 6);
}

/** "28 800": thousands apart, where there are many. */
const grouped = (text: string): string => text.replace(/^([−+]?)(\d{5,})/, (_, sign: string, digits: string) => `${sign}${digits.replace(/\B(?=(\d{3})+$)/g, "\u202f")}`);

/** A number of which differences of that size matter: no digits beyond the third of them. */
export function among(value: Value, size: Value): string {
  if (value === null) return "–";
  if (Math.abs(value) >= 1e7 || (value !== 0 && Math.abs(value) < 1e-4)) return significant(value);
  const decimals = decimalsOf(size);
  const step = size === null || decimals > 0 || !(Math.abs(size) > 0) ? 1 : 10 ** Math.max(Math.floor(Math.log10(Math.abs(size))) - 2, 0);
  return grouped(fixed(Math.round(value / step) * step === 0 || decimals > 0 ? value : Math.round(value / step) * step, decimals));
}

/** Three digits of the number itself. */
export const plainly = (value: Value): string => among(value, value);

export const signed = (value: Value, size = value): string => (value === null ? "–" : `${value > 0 ? "+" : ""}${among(value, size)}`);

/** "+42 %"; "" where a share means nothing. */
export function percentOf({ first, difference }: SessionChange, { axial, unit }: OutcomeCourses): string {
  if (axial || unit === "%" || first === null || difference === null || !(Math.abs(first) > 0)) return "";
  const percent = (100 * difference) / Math.abs(first);
  if (Math.abs(percent) > 999) return "";
  return `${percent > 0 ? "+" : ""}${fixed(percent, Math.abs(percent) < 9.5 ? 1 : 0)} %`;
}

/** Ends of an axis and what is written on it. */
export function ticks(low: number, high: number, most: number): number[] {
  const span = high - low;
  if (!(span > 0)) return [low];
  const rough = span / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((f) => f * power >= rough * (1 - 1e-9)) ?? 10) * power;
  const all: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) all.push(k * step);
  return all;
}

export const tickText = (value: number, step: number): string => {
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return Math.abs(value) >= 1e7 || decimals > 4 ? significant(value, 3) : grouped(fixed(value, Math.min(decimals, 6)));
};

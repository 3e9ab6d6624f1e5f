// The measurement in plain language.
import { angleBetween, direction } from "@mbk/shared/directions";
import type { Method, Model, Value, Warning, WarningCode } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel, svg } from "@mbk/shared/dom";
import { anyAngle, ellipseOf } from "@mbk/shared/ellipses";
import { directionText, eigenAxes, ellipsoidDrawings, type Principal, symmetricPart } from "@mbk/shared/ellipsoids";
import { data, fixed, listed, significant, valueWithInterval, withHalfWidth } from "@mbk/shared/format";
import { axisNames, type MatrixName, matrices, type Trial, unitsOf } from "@mbk/shared/result";
import { type PlainWarnings, plainWarnings } from "@mbk/shared/warnings";
import { fileOf } from "./data";
import { volumeOf } from "./ellipsoids";
import { literatureLine } from "./literature";
import { meanings, methodNames } from "./words";

/** What was found, with warnings: a measurement or a transfer function. */
export interface Judged {
  result: { usable: boolean; warnings: Warning[] };
  /** Texts of warnings, if they differ from those of a measurement. */
  plainly?: PlainWarnings;
}

const warningTitle = (code: WarningCode, plainly = plainWarnings): string => plainly[code]?.title ?? code;

/** Usable, usable with care, or not: a sign, a word and a reason. */
export function verdict(trial: Judged): { kind: "good" | "care" | "bad"; sign: string; word: string; reason: string } {
  const { usable, warnings } = trial.result;
  const titles = listed(warnings.map((warning) => warningTitle(warning.code, trial.plainly).replace(/^./, (c) => c.toLowerCase())));
  if (!usable) {
    // What happened in the recording, and when, says more than the title.
    const lost = warnings.find(({ code }) => code === "contact-lost");
    if (lost) return { kind: "bad", sign: "✕", word: "Not usable", reason: `${lost.message.replace(/^./, (c) => c.toUpperCase())}.` };
    return { kind: "bad", sign: "✕", word: "Not usable", reason: `Do not report these numbers: ${titles || "see the warnings"}.` };
  }
  if (warnings.length > 0) return { kind: "care", sign: "!", word: "Usable with care", reason: `Read these warnings first: ${titles}.` };
  return { kind: "good", sign: "✓", word: "Usable", reason: "No problem was found in the recording or the fit." };
}

function fitSentence(trial: Trial): HTMLElement {
  const { fit, axes } = trial.result;
  const heldOut = fit.validated_on === "held-out";
  const parts: (Node | string)[] = ["The model explains "];
  fit.VAF.forEach((value, axis) => {
    if (axis > 0) parts.push(axis < axes - 1 ? ", " : " and ");
    parts.push(data(value, value === null ? "an undefined share" : `${fixed(value, value > 99 ? 1 : 0)} %`), axes === 1 ? " of the force" : ` of the force along ${axisNames(axes)[axis]}`);
  });
  parts.push(heldOut ? ", on held-out (validation) data" : ", on the data used for fitting, which is optimistic");
  const worst = fit.VAF.reduce<number>((least, value) => Math.min(least, value ?? -Infinity), Infinity);
  const judgement = worst >= 90 ? "The fit is very good." : worst >= 80 ? "The fit is good." : worst >= 70 ? "The fit is fair." : "The fit is poor.";
  parts.push(`. ${trial.result.usable ? `${judgement} ` : ""}100 % would be a perfect fit.`);
  return h("p", {}, ...parts);
}

/** What a value of that size means at the hand. */
function everyday(symbol: "M" | "B" | "K", value: number, unit: string): string {
  if (symbol === "K" && unit === "N/m") return `Held 1 cm from its equilibrium, it pushes back with ${significant(value / 100, 2)} N.`;
  if (symbol === "K" && unit === "N·m/rad") return `Held 1° from its equilibrium, it pushes back with ${significant((value * Math.PI) / 180, 2)} N·m.`;
  if (symbol === "B" && unit === "N·s/m") return `Moved at 10 cm/s, it resists with ${significant(value / 10, 2)} N.`;
  if (symbol === "B" && unit === "N·m·s/rad") return `Turned at 1 rad/s, it resists with ${significant(value, 2)} N·m.`;
  if (symbol === "M" && unit === "kg") return `It feels like a mass of ${significant(value, 2)} kg.`;
  return "";
}

const arrow = (degrees: number): SVGElement =>
  svg(
    "svg",
    { viewBox: "-12 -12 24 24", class: "arrow", "aria-hidden": "true" },
    svg("circle", { r: 11, class: "dial" }),
    svg("line", { x1: -9, y1: 0, x2: 9, y2: 0, transform: `rotate(${-degrees})` }),
  );

/** A model as the cards show it. */
interface Shown {
  method: Method;
  model: Model;
  standard_error: Model;
  usable: boolean;
}

/** Usable models; first the one that the passivity prediction uses, else that of the result. */
function shownModels({ result }: Trial): Shown[] {
  const all: Shown[] = [result, ...(result.alternatives ?? [])].filter(({ usable }) => usable);
  const rests = result.passivity?.models?.[0]?.method;
  return [...all.filter(({ method }) => method === rests), ...all.filter(({ method }) => method !== rests)];
}

/** Eigenvalues and orientation of the symmetric part of two axes. */
function principalAxes(matrix: Value[][]): { small: number; large: number; angle: number } | undefined {
  const [[xx, xy] = [], [yx, yy] = []] = matrix;
  if (typeof xx !== "number" || typeof xy !== "number" || typeof yx !== "number" || typeof yy !== "number") return undefined;
  const [middle, half, s] = [(xx + yy) / 2, (xx - yy) / 2, (xy + yx) / 2];
  const radius = Math.hypot(half, s);
  return { small: middle - radius, large: middle + radius, angle: ((Math.atan2(s, half) * 90) / Math.PI + 180) % 180 };
}

/** Principal axes: from the result, with intervals, or of the other model, without. */
function axesOf(trial: Trial, shown: Shown, symbol: MatrixName, name: "inertia" | "damping" | "stiffness"):
  { small: number; large: number; angle: number; intervals: { small: [Value, Value]; large: [Value, Value]; angle: [Value, Value] } } | undefined {
  if (shown.method !== trial.result.method) {
    const axes = principalAxes(shown.model[symbol]);
    return axes && { ...axes, intervals: { small: [null, null], large: [null, null], angle: [null, null] } };
  }
  const ellipse = trial.result.ellipses?.[name];
  const [small, large] = ellipse?.eigenvalues ?? [];
  if (!ellipse || typeof small !== "number" || typeof large !== "number") return undefined;
  const { orientation_deg: angle, eigenvalues: [ofSmall = [null, null], ofLarge = [null, null]] } = ellipse.interval95;
  return { small, large, angle: ellipse.orientation_deg ?? 0, intervals: { small: ofSmall, large: ofLarge, angle } };
}

/** Principal values of three axes: from the result, with intervals, or of the other model, without. */
function principalOf(trial: Trial, shown: Shown, symbol: MatrixName, name: "inertia" | "damping" | "stiffness"): Principal[] {
  if (shown.method === trial.result.method) return trial.result.ellipsoids?.[name].principal ?? [];
  const S = symmetricPart(shown.model[symbol]);
  return S ? eigenAxes(S).map((axis) => ({ ...axis, value95: [null, null], half_angle95_deg: null })) : [];
}

/** Principal values with their directions, the volume, and the drawings. */
function spatialCard(trial: Trial, shown: Shown, { symbol, name, title }: (typeof matrices)[number]): HTMLElement {
  const unit = unitsOf(trial.result)[symbol];
  const ellipsoid = shown.method === trial.result.method ? trial.result.ellipsoids?.[name] : undefined;
  const principal = principalOf(trial, shown, symbol, name);
  return h("div", { class: "card spatial" },
    h("div", {}, h("p", { class: "card-title" }, h("strong", {}, `${title} ${symbol}`), h("span", {}, meanings[symbol])),
      ...principal.map((one, k) => h("p", { class: "principal" },
        valueWithInterval(one.value, one.value95, `card-${symbol}-${k}`), ` ${unit} `, h("span", { class: "towards" }, directionText(one)))),
      principal.length === 0 ? h("p", { class: "headline" }, "undefined") : "",
      ellipsoid?.closed ? h("p", { class: "volume" }, "Volume ", volumeOf(ellipsoid, unit, `card-${symbol}-volume`)) : ""),
    ellipsoid && ellipsoidDrawings(ellipsoid, symbol, unit));
}

function card(trial: Trial, shown: Shown, matrix: (typeof matrices)[number]): HTMLElement {
  if (trial.result.axes === 3) return spatialCard(trial, shown, matrix);
  const { symbol, name, title } = matrix;
  const unit = unitsOf(trial.result)[symbol];
  const parts: (Node | string | undefined)[] = [];
  const axes = trial.result.axes === 1 ? undefined : axesOf(trial, shown, symbol, name);
  if (trial.result.axes === 1) {
    const value = shown.model[symbol][0]?.[0] ?? null;
    parts.push(h("p", { class: "headline" }, withHalfWidth(value, shown.standard_error[symbol][0]?.[0] ?? null, `card-${symbol}`), ` ${unit}`));
    if (value !== null) parts.push(h("p", { class: "everyday" }, everyday(symbol, value, unit)));
  } else if (axes) {
    const { small, large, angle, intervals } = axes;
    const [low, high] = intervals.angle;
    const between = ([from, to]: [Value, Value]) =>
      h("span", { class: "half" }, from !== null && to !== null ? ` [${significant(from, 3)}, ${significant(to, 3)}]` : "");
    parts.push(
      h("p", { class: "headline" }, data(large, significant(large, 3), `card-${symbol}-large`), ` ${unit}`, between(intervals.large)),
      anyAngle(intervals.angle) ? h("p", {}, "maximum; any direction: the ellipse may be a circle") : h("p", {}, arrow(angle), "maximum at ", data(angle, `${fixed(angle, 0)}°`, `card-${symbol}-angle`),
        h("span", { class: "half" }, low !== null && high !== null ? ` [${fixed(low, 0)}°, ${fixed(high, 0)}°]` : ""), ` from x, ${direction(angle)}`),
      h("p", {}, data(small, significant(small, 3), `card-${symbol}-small`), between(intervals.small), ` ${unit} perpendicular`),
    );
    if (small > 0) parts.push(h("p", { class: "everyday" }, everyday(symbol, large, unit)));
  } else {
    parts.push(h("p", { class: "headline" }, "undefined"));
  }
  const drawn = shown.method === trial.result.method ? ellipseOf(trial, matrices.indexOf(matrix)) : undefined;
  return h("div", { class: "card" },
    h("div", {}, h("p", { class: "card-title" }, h("strong", {}, `${title} ${symbol}`), h("span", {}, meanings[symbol])), ...parts),
    drawn,
    literatureLine(trial, symbol));
}

/** "K 224 N/m, B 17.3 N·s/m, M 2.31 kg": along the longest axis where there are several. */
function inOneLine(trial: Trial, shown: Shown): string {
  return [...matrices].reverse().map(({ symbol, name }) => {
    const value = trial.result.axes === 1 ? shown.model[symbol][0]?.[0]
      : trial.result.axes === 3 ? principalOf(trial, shown, symbol, name)[0]?.value : axesOf(trial, shown, symbol, name)?.large;
    return `${symbol} ${significant(value, 3)} ${unitsOf(trial.result)[symbol]}`;
  }).join(", ");
}

/** How to read the directions of a card, by the number of axes. */
const readingOf: Record<number, string> = {
  2: "Angles are counter-clockwise from x. Check how x and y of your robot point.",
  3: "Directions are unit vectors (x, y, z), each with the half-angle of its 95 % cone. Check how x, y and z of your robot point.",
};

/** Cards of the model that the verdict uses, its method, and the values of the other method. */
function cards(trial: Trial): (Node | string)[] {
  if (!trial.result.usable) return [];
  const [first, ...others] = shownModels(trial);
  if (!first) return [];
  const rests = trial.result.passivity?.models?.[0]?.method === first.method;
  const other = first.method !== trial.result.method ? ` The tables and ellipses below are from the ${methodNames[trial.result.method]} model, the method of this result.` : "";
  return [
    h("div", { class: "cards" }, ...[...matrices].reverse().map((matrix) => card(trial, first, matrix))),
    h("p", { class: "model-of", "data-method": first.method }, "Values are from the ", h("strong", {}, methodNames[first.method]), rests ? ` model, which the passivity prediction also uses.${other}` : ` model.${other}`, " Brackets are 95 % intervals."),
    readingOf[trial.result.axes] ? h("p", { class: "reading" }, readingOf[trial.result.axes]) : "",
    ...others.map((one) => h("p", { class: "reading", "data-other": one.method }, `With ${methodNames[one.method]}${trial.result.axes === 1 ? "" : " (maximum)"}: ${inOneLine(trial, one)}.`)),
  ];
}

/** Angle between the stiffest direction and the line from shoulder to hand. */
function towardsShoulder(trial: Trial): string {
  const posture = trial.recordings[0]?.posture;
  const ellipse = trial.result.ellipses?.stiffness;
  const angle: Value | undefined = ellipse?.orientation_deg;
  if (!trial.result.usable || posture?.of !== "arm" || angle === null || angle === undefined) return "";
  const [shoulder, , hand] = posture.points_m as [[number, number], [number, number], [number, number]];
  const line = (Math.atan2(hand[1] - shoulder[1], hand[0] - shoulder[0]) * 180) / Math.PI;
  return ` The stiffest direction is ${fixed(angleBetween(angle, line), 0)}° from the line between hand and shoulder.`;
}

export function summarySection(trial: Trial, id: string, level: HeadingLevel): HTMLElement {
  const { result } = trial;
  const duration = result.inputs.reduce((sum, input) => sum + (input.duration_s ?? 0), 0);
  const said = verdict(trial);
  const how = !result.usable ? "" : result.axes === 1
    ? "A machine perturbed the limb; force and position were recorded. From these, three properties of the limb were estimated."
    : "A robot perturbed the hand; force and position were recorded. From these, three properties of the arm at the hand were estimated.";
  return h(
    "section",
    { id: `${id}-summary` },
    heading(level, "Summary"),
    h("div", { class: `verdict ${said.kind}`, "data-usable": String(result.usable) },
      h("span", { class: "sign", "aria-hidden": "true" }, said.sign),
      h("p", {}, h("strong", {}, `${said.word}. `), said.reason)),
    ...cards(trial),
    result.usable ? fitSentence(trial) : "",
    h("p", {}, `${fileOf(trial)} contains ${significant(duration, 3)} s. ${how}${towardsShoulder(trial)}`),
  );
}

export function warningsSection(trial: Judged, id: string, level: HeadingLevel): HTMLElement {
  const { warnings } = trial.result;
  return h(
    "section",
    { id: `${id}-warnings` },
    heading(level, "Warnings"),
    warnings.length === 0 ? h("p", {}, "None.") : "",
    h("ul", { class: "warnings" },
      ...warnings.map((warning) => {
        const plainly = (trial.plainly ?? plainWarnings)[warning.code];
        return h("li", { class: "warning", "data-code": warning.code },
          h("p", {}, h("strong", {}, warningTitle(warning.code, trial.plainly)), plainly ? `. ${plainly.meaning}` : ""),
          h("p", { class: "exact" }, h("code", {}, warning.code), ": ", h("span", { "data-name": "message" }, warning.message), "."),
          h("p", {}, h("strong", {}, "Try: "), h("span", { "data-name": "try" }, warning.try), "."));
      })),
  );
}

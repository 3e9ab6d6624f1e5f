// Is the limb passive? The verdict in plain words, and what it rests on.
import type { Condition, Interval, ModelPassivity, Passivity, Value, Verdict } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { data, fixed, plain, significant, withInterval } from "@mbk/shared/format";
import { type Trial, unitsOf } from "@mbk/shared/result";
import { type Chart, figure, type Series, styles } from "./charts";
import { modelBy } from "./data";
import { methodNames, verdictWords } from "./words";

/** Decimals for three digits of the value. */
export const threeDigits = (value: Value): number => (value ? Math.min(Math.max(2 - Math.floor(Math.log10(Math.abs(value))), 0), 9) : 2);

export const verdictBadge = (verdict: Verdict): HTMLElement =>
  h("span", { class: `badge ${verdictWords[verdict].kind}`, "data-verdict": verdict }, `${verdictWords[verdict].sign} ${verdict}`);

const bandText = ([low, high]: [number, number]): string => `${plain(low, 3)} to ${plain(high, 3)} Hz`;

/** Where the verdict holds, in words. */
function holds(passivity: Passivity): string {
  const model = passivity.models?.[0];
  if (passivity.decided_by === "energy") {
    return "It holds for the motion that was recorded, all of it; of other motions it says nothing.";
  }
  return model ? `It holds from ${bandText(model.band_hz)}: ${model.band_rule}.` : "";
}

const decidedBy = (passivity: Passivity): string => {
  if (passivity.decided_by === "energy") return passivity.energy ? "Decided by the energy that the limb absorbed, without a model" : "Decided by nothing: there is no account of the energy";
  const method = passivity.models?.[0]?.method;
  return `Decided by the model${method ? ` of ${methodNames[method]}` : ""}`;
};

/** Each way to a verdict in a row. */
function ways(passivity: Passivity, unit: string): HTMLElement | undefined {
  const rows: (Node | string)[][] = (passivity.models ?? []).map((model) => [
    `model of ${methodNames[model.method]}`,
    verdictBadge(model.verdict),
    verdictBadge(model.symmetric_part),
    verdictBadge(model.published_rule),
    h("span", { class: "number" }, withInterval(model.min_index, model.min_index_interval95, `${model.method}-min-index`, threeDigits(model.min_index)), ` ${unit}, at ${plain(model.min_index_at_hz, 3)} Hz`),
  ]);
  if (passivity.energy) {
    const { energy } = passivity;
    rows.push(["energy absorbed", verdictBadge(energy.verdict), "", "", h("span", { class: "number" }, withInterval(energy.absorbed_J, energy.interval95, "account-absorbed", threeDigits(energy.absorbed_J)), " J")]);
  }
  if (rows.length === 0) return undefined;
  return table("Each way to a verdict, with the smallest index or the energy and its 95 % interval", ["", "verdict", "symmetric part alone", "published rule", "smallest index, or energy"], rows, "numbers ways");
}

export function passivitySection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const { passivity } = trial.result;
  if (!passivity) return undefined;
  const { kind, sign, word, meaning } = verdictWords[passivity.verdict];
  return h("section", { id: `${id}-passivity` },
    heading(level, "Is the limb passive?"),
    h("div", { class: `verdict ${kind}`, "data-passivity": passivity.verdict, "data-by": passivity.decided_by },
      h("span", { class: "sign", "aria-hidden": "true" }, sign),
      h("div", {},
        h("p", {}, h("strong", {}, `${word}. `), meaning),
        h("p", {}, `${decidedBy(passivity)}: `, h("span", { "data-name": "reason" }, passivity.reason), `. ${holds(passivity)}`))),
    passivity.explained_percent === null ? "" : h("p", {}, "Inertia, damping and stiffness explain ", data(passivity.explained_percent, `${fixed(passivity.explained_percent, 0)} %`, "explained"), " of the force at best. The higher this is, the more reliable the model-based verdict."),
    ways(passivity, unitsOf(trial.result).B),
    trial.result.disagreement?.significant
      ? h("p", {}, "The two methods disagree beyond chance: the limb did something on its own account, which least squares takes for mechanics. ", h("a", { href: `#${id}-methods` }, "Both beside each other"), ".")
      : "",
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "Passive: the limb gives back no more energy than it took. “Undecided” is a finding, not a fault: the data allow both. The symmetric part leaves out what makes force across the motion; the published rule takes estimates at their face value, without intervals."));
}

const outcome: Record<Verdict, string> = { passive: "✓ holds", active: "✕ fails", undecided: "? open" };

function conditionsTable(model: ModelPassivity): HTMLElement {
  const row = (c: Condition, k: number): (Node | string)[] => {
    const decimals = Math.min(threeDigits(c.value), 6);
    const name = `${model.method}-condition${k}`;
    return [
      c.name,
      data(c.value, fixed(c.value, decimals), name),
      data(c.lower95, fixed(c.lower95, decimals), `${name}-lower`),
      data(c.upper, fixed(c.upper, decimals), `${name}-upper`),
      c.unit,
      h("strong", { class: `outcome ${verdictWords[c.verdict].kind}-text`, "data-verdict": c.verdict }, outcome[c.verdict]),
      h("span", { class: "source" }, c.source),
    ];
  };
  return table(`Conditions on the model of ${methodNames[model.method]}: each must be positive`,
    ["condition", "value", "above, with 95 %", "below, with 95 % for all", "unit", "", "Dyck 2013"], model.conditions.map(row), "numbers conditions");
}

function excessTable(models: ModelPassivity[], unit: string): HTMLElement | undefined {
  const number = (value: Value, interval: Interval, name: string) => withInterval(value, interval, name, threeDigits(value));
  const rows = models.flatMap(({ eop, method }): (Node | string)[][] => eop
    ? [
        [`${methodNames[method]}: corrected, the smallest eigenvalue of B`, number(eop.corrected, eop.interval95, `${method}-eop`), unit],
        [`${methodNames[method]}: by the published formula, half the largest eigenvalue of B`, number(eop.published_formula, eop.published_formula_interval95, `${method}-eop-published`), unit],
      ]
    : []);
  return rows.length ? table("Excess of passivity of the symmetric part (negative: a shortage); brackets are 95 % intervals", ["", "value", "unit"], rows, "numbers excess") : undefined;
}

const span = (values: Value[]): [number, number] => {
  const known = values.filter((value): value is number => value !== null);
  return [Math.min(...known), Math.max(...known)];
};

const isKnown = (values: Value[]): boolean => values.some((value) => value !== null);

/** More than a decade: less than that shows hardly a tick on a logarithmic axis. */
const isWide = ([low, high]: [number, number] = [1, 1]): boolean => high > 10 * low;

function indexChart(models: ModelPassivity[], unit: string, id: string): Chart | undefined {
  const drawn = models.filter((model) => isKnown(model.index.value));
  if (drawn.length === 0) return undefined;
  const words = drawn.map(({ method, index }) => {
    const [low, high] = span(index.value);
    return `${methodNames[method]}: from ${significant(low)} to ${significant(high)} ${unit}`;
  });
  return {
    id: `${id}-index`,
    title: "Passivity index over the band",
    howToRead: "Above zero the limb takes energy up at that frequency, whatever the direction of the motion; below it, it can give some. Where the shaded band crosses zero the data leave it open. Each panel has a scale of its own.",
    description: `Half the smallest eigenvalue of Z + Zᴴ; passive where it is positive. ${words.join("; ")}.`,
    x: { name: "frequency", unit: "Hz", log: isWide(drawn[0]?.band_hz) },
    panels: drawn.map(({ method, index }) => ({
      title: `Index, ${methodNames[method]}`,
      unit,
      zero: true,
      series: [{
        name: "passivity index",
        x: index.frequency_hz,
        y: index.value,
        style: styles.first,
        ...(isKnown(index.lower95) ? { between: { low: index.lower95, high: index.upper95, name: "95 % at each frequency" } } : {}),
      }],
    })),
    panelHeight: 150,
  };
}

/** Z(jω) = (k − m ω²)/(jω) + b of one axis in the complex plane (Dyck 2013, fig. 4.8). */
function nyquistChart(trial: Trial, id: string): Chart | undefined {
  const first = trial.result.passivity?.models?.[0];
  const model = first && modelBy(first.method, trial)?.model;
  if (trial.result.axes !== 1 || !first || !model) return undefined;
  const [m, b, k] = (["M", "B", "K"] as const).map((symbol) => model[symbol][0]?.[0] ?? null) as [Value, Value, Value];
  if (m === null || b === null || k === null) return undefined;
  const frequency = first.index.frequency_hz.filter((f): f is number => f !== null && f > 0);
  if (frequency.length < 2) return undefined;
  const unit = unitsOf(trial.result).B;
  const imaginary = frequency.map((f) => 2 * Math.PI * f * m - k / (2 * Math.PI * f));
  const half = frequency.map((_, i) => (first.index.upper95[i] ?? b) - b);
  const reach = Number((1.8 * Math.max(Math.abs(b), ...half.map((width) => Math.abs(b) + width))).toPrecision(1));
  if (!(reach > 0)) return undefined;
  const range: [number, number] = [-reach, reach];
  const ends = [0, frequency.length - 1] as const;
  const vertical = (name: string, real: Value[], style: Series["style"]): Series => ({ name, x: real, y: imaginary, style });
  return {
    id: `${id}-nyquist`,
    title: "Impedance in the complex plane",
    howToRead: "Z(jω) = (k − m ω²)/(jω) + b along the band. Its real part is the damping: where the curve lies left of zero, in the shaded half, the limb gives energy. Low frequencies lie below, where stiffness rules; high ones above, where inertia does.",
    description: `The real part is ${significant(b)} ${unit} throughout; the imaginary part goes from ${significant(imaginary[0])} at ${plain(frequency[0], 3)} Hz to ${significant(imaginary.at(-1))} ${unit} at ${plain(frequency.at(-1), 3)} Hz.`,
    x: { name: "real part", unit, range },
    panels: [{
      title: "Imaginary part",
      unit,
      zero: true,
      band: { from: range[0], to: 0, name: "active: the real part is negative" },
      series: [
        vertical("Z(jω)", frequency.map(() => b), styles.first),
        ...(half.some((width) => width > 0)
          ? [first.index.lower95, first.index.upper95].map((real) => vertical("95 % of the real part", real, styles.ideal))
          : []),
        { name: "ends of the band", x: ends.map(() => b), y: ends.map((i) => imaginary[i] ?? null), labels: ends.map((i) => `${plain(frequency[i], 3)} Hz`), marks: "circle", style: styles.first },
      ],
    }],
    panelHeight: 260,
  };
}

/** Conditions, excess and index: what stands behind the verdict of a model. */
export function passivityDetails(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const models = trial.result.passivity?.models ?? [];
  if (models.length === 0) return undefined;
  const unit = unitsOf(trial.result).B;
  const charts = [indexChart(models, unit, id), nyquistChart(trial, id)].filter((chart) => chart !== undefined);
  const below = models[0]?.nonpassive_below_hz;
  return h("section", { id: `${id}-conditions` },
    heading(level, "Passivity of the model"),
    ...models.map(conditionsTable),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "A condition holds where it is above zero with 95 % confidence, and fails where it is below zero with 95 % confidence for all conditions at once. Between the two it is open. All must hold for “passive”; one that fails makes “active”."),
    excessTable(models, unit),
    below ? h("p", {}, "Below ", data(below, `${significant(below, 2)} Hz`, "nonpassive-below"), " the model's antisymmetric stiffness outweighs its damping: for slower motion than that the model is active, whatever it is in the band.") : "",
    ...charts.map(figure));
}

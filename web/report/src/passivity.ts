// Energy that the limb absorbed, prediction of the model, and their basis. The statements are those of the document.
import type { Condition, EnergyLine, Interval, ModelPassivity, Passivity, Prediction, Value, Verdict } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { data, fixed, plain, significant, withInterval } from "@mbk/shared/format";
import { type Trial, unitsOf } from "@mbk/shared/result";
import { type Chart, figure, type Series, styles } from "./charts";
import { modelBy } from "./data";
import { methodNames, verdictWords } from "./words";

/** Decimals for three digits of the value. */
export const threeDigits = (value: Value): number => (value ? Math.min(Math.max(2 - Math.floor(Math.log10(Math.abs(value))), 0), 9) : 2);

export const verdictBadge = (verdict: Prediction): HTMLElement =>
  h("span", { class: `badge ${verdictWords[verdict].kind}`, "data-verdict": verdict }, `${verdictWords[verdict].sign} ${verdict}`);

const sentence = (text: string): string => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;

/** A statement with the sign and the word of its verdict. */
function statement(what: "trial" | "prediction", title: string, verdict: Prediction, text: string, ...more: (Node | string)[]): HTMLElement {
  const { kind, sign, word } = verdictWords[verdict];
  return h("div", { class: `verdict ${kind}`, "data-statement": what, "data-verdict": verdict },
    h("span", { class: "sign", "aria-hidden": "true" }, sign),
    h("div", {},
      h("p", {}, `${title}: `, h("strong", {}, word), "."),
      h("p", { "data-name": `${what}-statement` }, sentence(text)),
      ...more));
}

function trialStatement({ trial }: Passivity): HTMLElement {
  if (!trial) return h("p", { "data-statement": "trial", "data-verdict": "none" }, "No statement on this trial: force or motion is not plausible. See the warnings.");
  return statement("trial", "What happened in this trial", trial.verdict, trial.statement, trial.reason ? h("p", {}, sentence(trial.reason)) : "");
}

const predictionStatement = ({ prediction }: Passivity): HTMLElement =>
  statement("prediction", "What the model predicts", prediction.verdict, prediction.statement);

/** Verdicts on the model of each method, with its VAF. */
function methods({ models = [] }: Passivity, unit: string): HTMLElement | undefined {
  if (models.length === 0) return undefined;
  const rows = models.map((model): (Node | string)[] => [
    `model by ${methodNames[model.method]}${model.usable ? (model.fits ? "" : ", fits poorly") : ", not usable"}`,
    h("span", { class: "number" }, ...model.VAF.flatMap((value, axis) => [axis ? ", " : "", data(value, fixed(value, 1), `${model.method}-vaf${axis}`)]), " %"),
    verdictBadge(model.symmetric),
    verdictBadge(model.antisymmetric),
    verdictBadge(model.published_rule),
    h("span", { class: "number" }, withInterval(model.min_index, model.min_index_interval95, `${model.method}-min-index`, threeDigits(model.min_index)), ` ${unit}, at ${plain(model.min_index_at_hz, 3)} Hz`),
  ]);
  return table("Models by method, with the smallest passivity index in the band and its 95 % interval", ["", "VAF", "straight motion", "circular motion", "published rule", "smallest index"], rows, "numbers ways");
}

function linesTable(lines: EnergyLine[] | undefined): HTMLElement | undefined {
  if (!lines?.length) return undefined;
  const rows = lines.map((line, k): (Node | string)[] => [
    `${plain(line.frequency_hz, 3)} Hz`,
    h("span", { class: "number" }, withInterval(line.absorbed_J, line.interval95, `line${k}`, threeDigits(line.absorbed_J)), " J"),
  ]);
  return table("Energy absorbed at each line of the perturbation; brackets are 95 % intervals for all lines at once", ["line", "absorbed"], rows, "numbers lines");
}

export function passivitySection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const { passivity } = trial.result;
  if (!passivity) return undefined;
  return h("section", { id: `${id}-passivity` },
    heading(level, "Energy and passivity"),
    trialStatement(passivity),
    predictionStatement(passivity),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "The two statements are independent. The first is about this trial and its motion only. The second is what the model predicts for other motions within the band in which the data show how the limb responds; beyond it, the model is extrapolated. In straight motion only the symmetric parts of the model do work; in circular motion the antisymmetric parts do, too. Neither statement guarantees that a robot coupled to this person is stable."),
    methods(passivity, unitsOf(trial.result).B),
    trial.result.disagreement?.significant
      ? h("p", {}, "The two methods differ significantly: voluntary or reflex activity of the limb, or noise, acts back on the motion, which biases least squares. ", h("a", { href: `#${id}-methods` }, "Compare both methods"), ".")
      : "",
    linesTable(passivity.trial?.lines));
}

const outcome: Record<Verdict, string> = { passive: "✓ met", active: "✕ not met", undecided: "? undecided" };

function conditionsTable(model: ModelPassivity): HTMLElement {
  const row = (c: Condition, k: number): (Node | string)[] => {
    const decimals = Math.min(threeDigits(c.value), 6);
    const name = `${model.method}-condition${k}`;
    return [
      c.name,
      data(c.value, fixed(c.value, decimals), name),
      data(c.lower, fixed(c.lower, decimals), `${name}-lower`),
      data(c.upper, fixed(c.upper, decimals), `${name}-upper`),
      c.unit,
      h("strong", { class: `outcome ${verdictWords[c.verdict].kind}-text`, "data-verdict": c.verdict }, outcome[c.verdict]),
      h("span", { class: "source" }, c.source),
    ];
  };
  return table(`Conditions on the model by ${methodNames[model.method]}: each must be positive`,
    ["condition", "value", "lower limit (97.5 %)", "upper limit (97.5 % for all)", "unit", "", "Dyck 2013"], model.conditions.map(row), "numbers conditions");
}

function excessTable(models: ModelPassivity[], unit: string): HTMLElement | undefined {
  const number = (value: Value, interval: Interval, name: string) => withInterval(value, interval, name, threeDigits(value));
  const rows = models.flatMap(({ eop, method }): (Node | string)[][] => eop
    ? [
        [`${methodNames[method]}: corrected formula, smallest eigenvalue of B`, number(eop.corrected, eop.interval95, `${method}-eop`), unit],
        [`${methodNames[method]}: published formula, half the largest eigenvalue of B`, number(eop.published_formula, eop.published_formula_interval95, `${method}-eop-published`), unit],
      ]
    : []);
  return rows.length ? table("Excess of passivity of the symmetric part (negative: a shortage); brackets are 95 % intervals", ["", "value", "unit"], rows, "numbers excess") : undefined;
}

const span = (values: Value[]): [number, number] => {
  const known = values.filter((value): value is number => value !== null);
  return [Math.min(...known), Math.max(...known)];
};

const isKnown = (values: Value[]): boolean => values.some((value) => value !== null);

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
    howToRead: "Above zero, the model absorbs energy at that frequency in every direction of motion; below zero, it can generate energy. Where the shaded band includes zero, the data do not decide. Each panel has its own scale.",
    description: `Half the smallest eigenvalue of Z + Zᴴ; passive where it is positive. ${words.join("; ")}.`,
    x: { name: "frequency", unit: "Hz", log: true },
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
    howToRead: "Z(jω) = (k − m ω²)/(jω) + b along the band. Its real part is the damping: where the curve lies left of zero, in the shaded half, the model generates energy. Low frequencies lie below, where stiffness dominates; high ones above, where inertia dominates.",
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

/** Conditions, excess and index: the basis of the verdict on a model. */
export function passivityDetails(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const models = trial.result.passivity?.models ?? [];
  const first = models[0];
  if (!first) return undefined;
  const unit = unitsOf(trial.result).B;
  const charts = [indexChart(models, unit, id), nyquistChart(trial, id)].filter((chart) => chart !== undefined);
  const circular = first.circular_hz;
  return h("section", { id: `${id}-conditions` },
    heading(level, "Passivity of the model"),
    trial.result.usable ? "" : h("p", {}, "The result is not usable: these numbers help to find out why; they are no prediction."),
    ...models.map(conditionsTable),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "A condition is met if its value is above zero with 97.5 % confidence, and not met if it is below zero with 97.5 % confidence for all conditions jointly; otherwise it is undecided. “Passive” needs all conditions met; one that is not met means “active”."),
    excessTable(models, unit),
    first.antisymmetric !== "passive" && circular ? h("p", {}, "In circular motion the point estimate of the model by ", methodNames[first.method], " absorbs energy above ", data(circular[0], significant(circular[0], 2), "circular-low"), " Hz",
      circular[1] !== null && circular[1] < 10 * first.band_hz[1] ? [" and below ", significant(circular[1], 2), " Hz"].join("") : "",
      ". Outside this range its antisymmetric part outweighs its damping; beyond the band the model is extrapolated.") : "",
    ...charts.map(figure));
}

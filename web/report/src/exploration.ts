// The report of mbk explore: a document of schema mbk.explore_report/1, drawn. Every number in it was computed by mbk.
import type {
  Distortion, EmgPath, Exploration, ExplorationReport, ExplainedForce, FrequencyResponseEstimate, ImpulseResponseEstimate,
  ParallelCascadeEstimate, PeriodicFacts, Response, ResponseModel, SignalLabel, Value,
} from "@mbk/shared/documents";
import { facts, h, heading, svg, table } from "@mbk/shared/dom";
import { data, fixed, listed, plain, significant } from "@mbk/shared/format";
import { axisNames } from "@mbk/shared/result";
import { csvOf } from "@mbk/shared/sheet";
import { bode, type Curve, ratioUnit } from "./bode";
import { type Chart, figure, type Panel, type Series, styleOf, styles } from "./charts";
import { basename } from "./data";
import { courseSection, margin, onsetSection, plateauSection, reachSection } from "./exploration_protocols";
import { elementHeads, matrixRows } from "./matrix_rows";
import { nyquist } from "./nyquist";
import { saveable } from "./picture";
import { verdict, warningsSection } from "./summary";
import { emgSection, stretchSection, toneSentences } from "./tone";

const methods: Record<FrequencyResponseEstimate["method"], string> = {
  welch: "averaged spectra (Welch)",
  robust: "robust, from periods and realisations",
  fast: "fast, from periods of one realisation",
  "local-polynomial": "local polynomials",
};

const ms = (seconds: Value): string => `${significant(seconds === null ? null : 1000 * seconds, 3)} ms`;

const percent = ({ VAF, VAF_interval95: [low, high] }: ExplainedForce, name: string): HTMLElement =>
  h("span", { class: "number" }, data(VAF, VAF === null ? "undefined" : fixed(VAF, 1), name), ` [${fixed(low ?? NaN, 1)}, ${fixed(high ?? NaN, 1)}] %`);

/** A probability below what the distribution can be computed to is not zero. */
const probability = (p: Value): string => (p !== null && p < 1e-12 ? "p < 10⁻¹²" : `p = ${significant(p, 2)}`);

/** The unit of the response in time, of inertia, damping and stiffness, where the file says what moves. */
function unitsOf({ units }: Exploration): { response: string; M: string; B: string; K: string } {
  if (!units) return { response: "", M: "", B: "", K: "" };
  return { response: units.K === "N/m" ? "N/(m·s)" : "N·m/(rad·s)", M: units.M, B: units.B, K: units.K };
}

const ofForce = (result: Exploration): boolean => {
  if (!result.frequency_response) return Boolean(result.units);
  const output = result.frequency_response.outputs[0]?.name ?? "";
  return output.startsWith("−force") || output === "−reaction";
};

const axisOf = (axes: number, k: number): string => (axes === 1 ? "" : ` ${axisNames(axes)[k]}`);

/** "xx", "yx" …: force, then motion; column by column. */
const pairsOf = (axes: number): string[] => axisNames(axes).flatMap((motion) => axisNames(axes).map((force) => force + motion));

export function explorationHead({ result, note }: ExplorationReport): HTMLElement {
  const title = result.stretch ? "Resistance to stretches" : result.emg ? "EMG after perturbations" : ofForce(result) ? "Force response to motion" : "Output response to input";
  const response = result.frequency_response;
  document.title = `${result.inputs.map((input) => basename(input.file)).join(", ")} – explored`;
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, "Exploration without a parametric model"),
    h("h1", {}, title),
    note ? h("p", { class: "note" }, note) : "",
    facts([
      [result.inputs.length === 1 ? "File" : "Files", result.inputs.map((input) => basename(input.file)).join(", ")],
      ["Analysed", listed([...new Set(result.inputs.map((one) => `${plain(one.from_s, 4)} to ${plain(one.to_s, 4)} s at ${plain(one.rate_hz, 5)} Hz`))])],
      ["Method", response ? `${methods[response.method]}: ${response.method_rule}` : undefined],
      ["Loop", response ? (response.by_reference ? "projected on the reference: valid in closed loop" : "no reference: biased if the force moves the robot") : undefined],
      ["Intervals", response ? `95 %, for ${response.intervals_assume}` : undefined],
    ]));
}

const nonlinearity = (facts: PeriodicFacts): string | undefined => {
  if (!facts.total_over_noise) return undefined;
  const { ratio, p } = facts.total_over_noise;
  return p !== null && p < 0.01
    ? `Its response varies with the phases of the perturbation ${significant(ratio, 3)} times as much as noise explains: it is not linear.`
    : `Its response varies with the phases of the perturbation no more than noise explains (ratio ${significant(ratio, 3)}): no nonlinear distortion was detected.`;
};

function modelSentence(response: ImpulseResponseEstimate): string | undefined {
  const enough = response.model.enough;
  if (!enough) return undefined;
  return enough.enough
    ? "M, B and K are sufficient to describe the force response in these recordings."
    : "M, B and K are not sufficient to describe the response.";
}

function reflexSentence(cascade: ParallelCascadeEstimate): string {
  switch (cascade.delayed_response) {
    case "reflex":
      return `Part of the force responds to stretch in one direction after ${ms(cascade.reflex?.delay_s ?? null)}: a reflex.`;
    case "both-directions":
      return "Part of the force responds to motion after a delay, equally in both directions; this does not indicate a reflex.";
    case "none":
      return "No reflex was found.";
    default:
      return "The recordings do not show whether there is a reflex.";
  }
}

const emgSentence = (emg: EmgPath): string =>
  (emg.explains ? "EMG explains force that motion does not." : "EMG was not shown to explain force.");

function summary(report: ExplorationReport): HTMLElement {
  const { result } = report;
  const said = verdict({ result });
  const { frequency_response: response, impulse_response: impulse, parallel_cascade: cascade } = result;
  const sentences = [
    response?.periodic ? nonlinearity(response.periodic) : undefined,
    impulse ? modelSentence(impulse) : undefined,
    cascade ? reflexSentence(cascade) : undefined,
    cascade?.emg ? emgSentence(cascade.emg) : undefined,
    result.time_course?.verdict === "changes" ? "The limb changes during the recording; results for the whole recording are averages." : undefined,
    ...toneSentences(result),
  ].filter((one): one is string => one !== undefined);
  return h("section", { id: "summary" }, heading(2, "Summary"),
    h("div", { class: `verdict ${said.kind}`, "data-usable": String(result.usable) },
      h("span", { class: "sign", "aria-hidden": "true" }, said.sign),
      h("p", {}, h("strong", {}, `${said.word}. `), said.reason)),
    ...sentences.map((sentence) => h("p", {}, sentence)));
}

/** Angles that go on beyond ±180° where the curve does. */
function unwrapped({ phase_deg: phase, phase_interval95_deg: interval }: Response): Pick<Curve, "phase_deg" | "phase_interval95_deg"> {
  let before: number | null = null;
  const turns = phase.map((angle) => {
    if (angle === null) return 0;
    const turn: number = before === null ? 0 : 360 * Math.round((before - angle) / 360);
    before = angle + turn;
    return turn;
  });
  const turn = (values: Value[] | undefined): Value[] => (values ?? []).map((angle, k) => (angle === null ? null : angle + (turns[k] ?? 0)));
  return { phase_deg: turn(phase), phase_interval95_deg: [turn(interval[0]), turn(interval[1])] };
}

function curve(response: Response, frequency: Value[]): Curve {
  return {
    frequency_hz: frequency,
    magnitude: response.magnitude,
    magnitude_interval95: [response.magnitude_interval95[0] ?? [], response.magnitude_interval95[1] ?? []],
    ...unwrapped(response),
  };
}

const nameOf = (response: Response): string => `${response.input} → ${response.output}`;

/** Model angles turned to where the measured ones are. */
const near = (angles: Value[], measured: Value[]): Value[] =>
  angles.map((angle, k) => {
    const at = measured[k] ?? null;
    return angle === null || at === null ? angle : angle + 360 * Math.round((at - angle) / 360);
  });

function responseFigures({ result, model_responses: models }: ExplorationReport, found: FrequencyResponseEstimate): HTMLElement[] {
  return found.responses.flatMap((response, k) => {
    const input = found.inputs.find((one) => one.name === response.input) as SignalLabel;
    const output = found.outputs.find((one) => one.name === response.output) as SignalLabel;
    const unit = ratioUnit({ input, output });
    const measured = curve(response, found.frequency_hz);
    const model = models?.[k];
    // a disc that holds 0 says nothing of the response there, and hides what the others say
    const known = response.region95_radius.map((radius, line) => {
      const size = response.magnitude[line] ?? null;
      return radius !== null && size !== null && radius < size;
    });
    const at = (values: Value[]): Value[] => values.filter((_, line) => known[line]);
    const region = at(response.region95_radius);
    return [
      figure(bode(measured, {
        id: `bode-${k}`,
        title: `Bode plot, ${nameOf(response)}`,
        unit,
        name: "measured",
        ...(model ? { beside: { name: "M, B, K fitted to the impulse response", magnitude: model.magnitude, phase_deg: near(model.phase_deg, measured.phase_deg) } } : {}),
        howToRead: ofForce(result)
          ? "Force per displacement: a constant level at low frequencies is stiffness; a rise is damping, then inertia. Where the band reaches the bottom, the response is not significant."
          : "Gain and phase lag of the output relative to the input at each frequency. Where the band reaches the bottom, the response is not significant.",
      })),
      nyquist({
        frequency_hz: at(found.frequency_hz),
        real: at(response.real),
        imaginary: at(response.imaginary),
        region95: { longer_half_axis: region, shorter_half_axis: region, angle_deg: region.map(() => 0) },
      }, undefined, `nyquist-${k}`, `Nyquist plot, ${nameOf(response)}`, unit, "measured"),
    ];
  });
}

function coherenceChart(found: FrequencyResponseEstimate): Chart | undefined {
  const { multiple_coherence: multiple, frequency_hz: x } = found;
  if (!multiple) return undefined;
  const panels = found.outputs.map((output, i): Panel => ({
    title: output.name,
    unit: "",
    range: [0, 1],
    series: [
      { name: found.inputs.length > 1 ? "with all inputs together" : "coherence", x, y: multiple[i] ?? [], style: styles.first },
      ...(found.inputs.length > 1
        ? found.inputs.flatMap((input, j): Series[] => {
            const partial = found.responses[j * found.outputs.length + i]?.partial_coherence;
            return partial ? [{ name: `with ${input.name} alone (partial)`, x, y: partial, style: styleOf(j + 1) }] : [];
          })
        : []),
    ],
  }));
  return {
    id: "coherence",
    title: "Coherence",
    howToRead: "The share of the output that follows the inputs linearly, from 0 (none) to 1 (all). High coherence with a poor model means: linear, but not described by M, B and K.",
    description: `Of ${listed(found.outputs.map((one) => one.name))}, over frequency.`,
    x: { name: "frequency", unit: "Hz", log: true },
    panels,
    panelHeight: 130,
  };
}

/** What makes the response uncertain: noise, and distortion that looks like noise. */
function spreadChart(found: FrequencyResponseEstimate): Chart | undefined {
  const panels = found.responses.flatMap((response): Panel[] => {
    const noise = response.noise_standard_error;
    if (!noise) return [];
    const [input, output] = [found.inputs.find((one) => one.name === response.input), found.outputs.find((one) => one.name === response.output)];
    const x = found.frequency_hz;
    const positive = (values: Value[]): Value[] => values.map((value) => (value !== null && value > 0 ? value : null));
    const nonlinear = response.nonlinear_standard_deviation;
    return [{
      title: nameOf(response),
      unit: input && output ? ratioUnit({ input, output }) : "",
      log: true,
      series: [
        { name: "magnitude of the response", x, y: response.magnitude, style: styles.measured },
        { name: "standard error, all together", x, y: positive(response.standard_error), style: styles.first },
        { name: "standard error by noise", x, y: positive(noise), style: styles.second },
        ...(nonlinear ? [{ name: "nonlinear distortion of one realisation", x, y: positive(nonlinear), style: styles.third }] : []),
      ],
    }];
  });
  return panels.length === 0 ? undefined : {
    id: "spread",
    title: "Noise and nonlinear distortion",
    howToRead: "Where distortion exceeds noise, the response differs between realisations of the perturbation, however long the recording.",
    description: "Standard errors of the responses over frequency.",
    x: { name: "frequency", unit: "Hz", log: true },
    panels,
  };
}

const distortionCells = (name: string, one: Distortion): string[] => [
  name, one.detected ? "detected" : one.trace ? "a trace" : "not above the noise",
  `${significant(one.relative === null ? null : 100 * one.relative, 2)} %`, `${significant(one.noise === null ? null : 100 * one.noise, 2)} %`, String(one.lines), probability(one.p),
];

function distortionTable({ even_distortion: even, odd_distortion: odd }: PeriodicFacts): HTMLElement | undefined {
  const rows = [...(even ? [distortionCells("even", even)] : []), ...(odd ? [distortionCells("odd", odd)] : [])];
  return rows.length === 0 ? undefined : table("Output at lines that the perturbation does not excite, relative to that at excited lines",
    ["distortion", "", "share", "noise", "lines", "significance"], rows, "numbers");
}

function skippedWords({ skipped_lines: skipped, weak_lines: weak }: PeriodicFacts): string {
  const lines = (n: number): string => `${n} line${n === 1 ? "" : "s"}`;
  const why = [...(skipped > weak ? [`${lines(skipped - weak)} at which the inputs are not excited in all directions`] : []),
    ...(weak > 0 ? [`${lines(weak)} with too little of the power of the perturbation`] : [])];
  return why.length ? ` Omitted: ${why.join(", ")}.` : "";
}

function responseSection(report: ExplorationReport): HTMLElement | undefined {
  const found = report.result.frequency_response;
  if (!found) return undefined;
  const [coherence, spread] = [coherenceChart(found), spreadChart(found)];
  const periodic = found.periodic;
  return h("section", { id: "frequency-response" }, heading(2, "Frequency response"),
    periodic
      ? h("p", {}, `The perturbation repeats itself every ${plain(periodic.period_s, 5)} s; ${periodic.realisations} realisation${periodic.realisations === 1 ? "" : "s"} of ${periodic.periods} periods or more were used.${skippedWords(periodic)}`)
      : "",
    ...responseFigures(report, found),
    coherence ? figure(coherence) : "",
    spread ? figure(spread) : "",
    periodic ? distortionTable(periodic) : "");
}

/** Impulse responses with their bands, one panel for each. */
function lagChart(id: string, title: string, lag: Value[], responses: Value[][], halfWidths: Value[][], names: string[], unit: string, howToRead: string): Chart {
  const x = lag.map((seconds) => (seconds === null ? null : 1000 * seconds));
  const panels = responses.map((response, k): Panel => {
    const shifted = (sign: number): Value[] => response.map((value, i) => {
      const half = halfWidths[k]?.[i] ?? null;
      return value === null || half === null ? null : value + sign * half;
    });
    return { title: names[k] ?? "", unit, zero: true, series: [{ name: "response", x, y: response, style: styles.first, between: { low: shifted(-1), high: shifted(1), name: "95 % interval" } }] };
  });
  return { id, title, howToRead, description: title, x: { name: "lag", unit: "ms" }, panels, panelHeight: 150 };
}

function modelTable(model: ResponseModel, units: { M: string; B: string; K: string }, caption: string, id: string): HTMLElement | undefined {
  if (!model.identifiable || !model.M || !model.B || !model.K) return undefined;
  const axes = model.M.value.length;
  const rows = ([["inertia M", "M", model.M], ["damping B", "B", model.B], ["stiffness K", "K", model.K]] as const).flatMap(([name, symbol, one]) => matrixRows(name, axes,
    (i, j) => margin(one.value[i]?.[j] ?? null, one.half_width95[i]?.[j] ?? null, `${id}-${symbol}${i}${j}`), () => [units[symbol], one.identifiable ? "" : "not identifiable"]));
  return table(caption, ["", ...elementHeads(axes, "value ± 95 %"), "unit", ""], rows, "numbers");
}

function impulseSection({ result }: ExplorationReport): HTMLElement | undefined {
  const found = result.impulse_response;
  if (!found) return undefined;
  const judged = found.validated_on === "held-out" ? "held-out (validation) data" : "the data used for fitting";
  const rows = found.explained.map((one, k) => [
    `force${axisOf(result.axes, k)}`, percent(one, `irf-VAF${k}`), found.explained_by_model[k] ? percent(found.explained_by_model[k] as ExplainedForce, `model-VAF${k}`) : "",
  ]);
  const enough = found.model.enough;
  return h("section", { id: "impulse-response" }, heading(2, "Impulse response"),
    h("p", {}, `Force as a weighted sum of past and future motion. Its memory is ${ms(found.memory_s)} in both directions (${found.memory_rule}${found.memory_at_limit ? "; this is the longest that was tried, so it may be longer" : ""}); ${found.rank} of ${found.directions} directions of the motion are kept.`),
    figure(lagChart("irf", "Impulse response from motion to force", found.lag_s, found.response, found.half_width95,
      pairsOf(result.axes).map((pair) => (pair ? `from ${pair[1]} to force ${pair[0]}` : "response")), unitsOf(result).response,
      "Positive lags: force that follows the motion; negative lags: force that precedes it. Stiffness, damping and inertia act at lag 0; values at other lags are memory.")),
    table(`VAF of the force on ${judged}; brackets are 95 % intervals`, ["", "by the response", "by M, B and K"], rows, "numbers"),
    modelTable(found.model, unitsOf(result), "M, B and K fitted to the response; ± is half of the 95 % interval", "irf") ?? h("p", {}, "M, B and K are not identifiable: the motion does not excite them enough."),
    enough
      ? h("p", {}, h("strong", {}, enough.enough ? "M, B and K are sufficient" : "M, B and K are not sufficient"), `: F = ${significant(enough.F, 3)}, ${probability(enough.p)} if M, B and K are sufficient.`)
      : "");
}

/** Which share of the force each part explains, as bars. */
function partsDrawing(parts: { name: string; value: number; low: number; high: number }[], title: string): HTMLElement {
  const [width, left, row] = [660, 190, 26];
  const at = (share: number): number => left + ((width - left - 60) * Math.min(Math.max(share, 0), 100)) / 100;
  const height = parts.length * row + 24;
  const numbers = () => csvOf(["part", "share [%]", "low", "high"], parts.map(({ name, value, low, high }) => [name, value, low, high]));
  return saveable(h("figure", { class: "parts-figure", "aria-label": title },
    svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "parts", role: "img", "aria-label": `${title}: ${listed(parts.map((part) => `${part.name} ${fixed(part.value, 1)} per cent`))}` },
      ...[0, 25, 50, 75, 100].flatMap((share) => [
        svg("line", { x1: at(share), x2: at(share), y1: 0, y2: height - 20, class: "grid" }),
        svg("text", { x: at(share), y: height - 6, "text-anchor": "middle" }, `${share} %`),
      ]),
      ...parts.flatMap((part, k) => {
        const y = k * row + 5;
        return [
          svg("text", { x: left - 8, y: y + 12, "text-anchor": "end" }, part.name),
          svg("rect", { x: left, y, width: Math.max(at(part.value) - left, 0), height: 15, class: "share" }),
          svg("line", { x1: at(part.low), x2: at(part.high), y1: y + 7.5, y2: y + 7.5, class: "interval" }),
          svg("text", { x: at(Math.max(part.high, part.value)) + 6, y: y + 12 }, `${fixed(part.value, 1)} %`),
        ];
      })),
    h("figcaption", {}, h("strong", {}, "How to read this. "), "Bars are shares of the force's variance, lines their 95 % intervals. The two paths are correlated and overlap: their shares need not add up.")), { name: title.split(",")[0]?.toLowerCase().replaceAll(" ", "-") ?? "shares", title, csv: numbers });
}

const directionName = (direction: Value[] | null): string => {
  if (direction === null) return "both directions equally";
  if (direction.length === 1) return (direction[0] ?? 0) > 0 ? "positive" : "negative";
  if (direction.length > 2) return `(${direction.map((component) => fixed(component, 2)).join(", ")})`;
  return `${fixed((180 / Math.PI) * Math.atan2(direction[1] ?? 0, direction[0] ?? 0), 0)}°`;
};

function reflexSection(report: ExplorationReport): HTMLElement | undefined {
  const { result } = report;
  const found = result.parallel_cascade;
  if (!found) return undefined;
  const section = (...children: (Node | string | undefined)[]): HTMLElement => h("section", { id: "reflex" }, heading(2, "Intrinsic and reflex force"), ...children);
  if (found.delayed_response === "not-identifiable") return section(h("p", {}, `${reflexSentence(found)} ${found.why}.`));
  const judged = found.validated_on === "held-out" ? "held-out (validation) data" : "the data used for fitting";
  const { reflex, intrinsic } = found;
  const rows = (found.candidates ?? []).map((one) => [directionName(one.direction), data(one.VAF, `${fixed(one.VAF ?? NaN, 2)} %`)]);
  rows.push(["no delayed response", data(found.intrinsic_VAF ?? null, `${fixed(found.intrinsic_VAF ?? NaN, 2)} %`)]);
  const drawings = (found.shares ?? []).map((one, k) => {
    const part = (name: string, share: ExplainedForce | undefined) => share && share.VAF !== null
      ? [{ name, value: share.VAF, low: share.VAF_interval95[0] ?? share.VAF, high: share.VAF_interval95[1] ?? share.VAF }] : [];
    return partsDrawing([
      ...part("without reflex", one.intrinsic_alone), ...part("with reflex", one.both),
      ...part("intrinsic path", one.intrinsic_path), ...part("reflex path", one.reflex_path),
    ], `Share of the force${axisOf(result.axes, k)} that is explained, on ${judged}`);
  });
  const delayed = reflex
    ? [
        facts([
          ["Direction of stretch", directionName(reflex.direction)],
          ["Delay", `${ms(reflex.delay_s)}, of the first lag at which a response shows [${ms(reflex.delay_interval95_s[0] ?? null)}, ${ms(reflex.delay_interval95_s[1] ?? null)}]`],
          ["Gain", h("span", {}, data(reflex.gain_along.value, significant(reflex.gain_along.value, 3), "reflex-gain"),
            ` [${significant(reflex.gain_along.interval95[0] ?? null, 3)}, ${significant(reflex.gain_along.interval95[1] ?? null, 3)}]`,
            reflex.gain_identifiable ? ((reflex.gain_along.value ?? 0) > 0 ? ": it resists the stretch" : ": it assists the stretch") : ": not identifiable")],
          ["As a second-order response", reflex.second_order ? `delay ${ms(reflex.second_order.delay_s.value)}, ${significant(reflex.second_order.frequency_hz.value, 3)} Hz, damping ratio ${significant(reflex.second_order.damping.value, 2)}` : undefined],
        ]),
        figure(lagChart("reflex-response", "Response of the reflex path to stretch", reflex.lag_s, reflex.response, reflex.half_width95,
          reflex.response.map((_, k) => `force${axisOf(result.axes, k)}`), unitsOf(result).K, "The force after a short stretch; it is zero before the delay.")),
      ]
    : [];
  return section(
    h("p", {}, reflexSentence(found), ` ${found.why.charAt(0).toUpperCase()}${found.why.slice(1)}.`),
    table("Cross-validated VAF of the force by direction of stretch", ["direction of stretch", "VAF"], rows, "numbers narrow"),
    ...drawings,
    intrinsic
      ? figure(lagChart("intrinsic", "Impulse response of the intrinsic path", intrinsic.lag_s, intrinsic.response, intrinsic.half_width95,
          pairsOf(result.axes).map((pair) => (pair ? `from ${pair[1]} to force ${pair[0]}` : "response")), unitsOf(result).response, "The passive response of the limb, too early to be a reflex."))
      : undefined,
    ...delayed,
    found.intrinsic_model ? modelTable(found.intrinsic_model, unitsOf(result), "M, B and K of the intrinsic path; ± is half of the 95 % interval", "intrinsic") : undefined,
    ...emgOfForce(report));
}

/// The part of the force that EMG explains.
function emgOfForce({ result }: ExplorationReport): (Node | string)[] {
  const emg = result.parallel_cascade?.emg;
  if (!emg) return [];
  const axes = result.axes;
  const gains = emg.muscles.flatMap((muscle) => muscle.gain.map((gain, k) => [
    `${muscle.channel}${axes > 1 ? `, force${axisOf(axes, k)}` : ""}`,
    data(gain.value, significant(gain.value, 3)), `[${significant(gain.interval95[0] ?? null, 3)}, ${significant(gain.interval95[1] ?? null, 3)}]`, muscle.unit]));
  const shares = emg.shares.flatMap((one, k) => [
    [`intrinsic and EMG${axisOf(axes, k)}`, percent(one.intrinsic_and_emg, "emg-intrinsic")],
    ...(result.parallel_cascade?.reflex ? [[`with reflex${axisOf(axes, k)}`, percent(one.all, "emg-all")]] : []), [`EMG alone${axisOf(axes, k)}`, percent(one.emg_path, "emg-alone")]]);
  const bands = emg.coherence.map((band) => [
    `${plain(band.band_hz[0] ?? null)} to ${plain(band.band_hz[1] ?? null)} Hz`,
    band.motion.map((share) => fixed(share ?? NaN, 2)).join(", "), band.motion_and_emg.map((share) => fixed(share ?? NaN, 2)).join(", ")]);
  return [
    heading(3, "EMG"),
    h("p", {}, `${emgSentence(emg)} ${emg.why.charAt(0).toUpperCase()}${emg.why.slice(1)}.`),
    ...(shares.length > 0 ? [table("Share of the force explained (VAF)", ["parts", "VAF"], shares, "numbers narrow")] : []),
    ...(gains.length > 0 ? [table(`Force F at a steady EMG of 1${result.units ? ` [${result.units.K === "N/m" ? "N" : "N·m"}]` : ""}`, ["muscle", "gain", "95 % interval", "1 is"], gains, "numbers narrow")] : []),
    ...(bands.length > 0 ? [table("Multiple coherence with the force, corrected for chance", ["band", "motion", "motion and EMG"], bands, "numbers narrow")] : []),
  ];
}

function provenance(result: Exploration): HTMLElement {
  return h("section", { id: "provenance" }, heading(2, "Provenance"),
    table("Files", ["file", "format", "SHA-256"], result.inputs.map((input) => [h("span", { class: "path" }, input.file), input.format, h("code", { class: "hash" }, input.sha256)]), "files"),
    result.notes.length ? h("div", {}, h("p", {}, h("strong", {}, "Notes")), h("ul", {}, ...result.notes.map((note) => h("li", {}, note)))) : "");
}

export function explorationSections(report: ExplorationReport): HTMLElement[] {
  const { result } = report;
  const units = unitsOf(result);
  return [
    summary(report),
    warningsSection({ result: report.result }, "exploration", 2),
    responseSection(report),
    impulseSection(report),
    reflexSection(report),
    result.time_course ? courseSection(result.time_course, result, units) : undefined,
    result.after_onset ? onsetSection(result.after_onset, result, units) : undefined,
    result.servo_displacement ? reachSection(result.servo_displacement, result, units) : undefined,
    result.ramp_and_hold ? plateauSection(result.ramp_and_hold, result, units) : undefined,
    result.emg ? emgSection(result.emg) : undefined,
    result.stretch ? stretchSection(result.stretch, result) : undefined,
    provenance(report.result),
  ].filter((section): section is HTMLElement => section !== undefined);
}

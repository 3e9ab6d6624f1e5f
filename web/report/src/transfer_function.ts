// The report of mbk tf: a document of schema mbk.tf_report/1, drawn. Every number in it was computed by mbk.
import type { FrequencyResponse, Root, TransferFunction, TransferFunctionReport, Value } from "@mbk/shared/documents";
import { facts, h, heading, scrolling, table } from "@mbk/shared/dom";
import { data, fixed, plain, significant, superscript, withHalfWidth } from "@mbk/shared/format";
import { bode, type Curve, ratioUnit, shownUnit } from "./bode";
import { figure, styles } from "./charts";
import { basename } from "./data";
import { nyquist } from "./nyquist";
import { verdict, warningsSection } from "./summary";
import { transferFunctionWarnings } from "./words";

const methods: Record<TransferFunction["method"], string> = {
  srivc: "refined instrumental variables, continuous time (SRIVC)",
  rivc: "refined instrumental variables, continuous time, with a model of the noise (RIVC)",
  clsrivc: "refined instrumental variables, continuous time, instruments from the reference (CLSRIVC)",
  oe: "output error, discrete time (OE)",
  bj: "Box–Jenkins, discrete time (BJ)",
};

export function transferFunctionHead({ result, note }: TransferFunctionReport): HTMLElement {
  const title = `${result.input.name} → ${result.output.name}`;
  document.title = `${title} – transfer function`;
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, "Transfer function"),
    h("h1", { class: "signals" }, title),
    note ? h("p", { class: "note" }, note) : "",
    facts([
      ["File", result.inputs.map((input) => basename(input.file)).join(", ")],
      ["Input", named(result.input)],
      ["Output", named(result.output)],
      ["Reference", result.reference],
      ["Method", methods[result.method] ?? result.method],
      ["Samples", `${result.samples} in ${result.experiments === 1 ? "one segment" : `${result.experiments} segments`}, ${result.even_clock ? "every" : "unevenly spaced, about every"} ${significant(result.sample_time_s === null ? null : 1000 * result.sample_time_s, 4)} ms`],
      ["Excited band", bandOf(result) ? `${plain(bandOf(result)?.from, 3)} to ${plain(bandOf(result)?.to, 3)} Hz` : undefined],
    ]));
}

const named = ({ name, unit }: { name: string; unit: string }): string => (unit ? `${name} [${shownUnit(unit)}]` : name);

function bandOf(result: TransferFunction): { from: number; to: number; name: string } | undefined {
  const [from, to] = result.excited_band_hz;
  return from === null || to === null || !(from < to) ? undefined : { from, to, name: "excited band" };
}

/** −6400 s + 1600, or 1 − 1.5 q⁻¹; what machines read stands in the JSON. */
function polynomial(coefficients: Value[], variable: TransferFunction["variable"]): string {
  const degree = coefficients.length - 1;
  const parts: string[] = [];
  coefficients.forEach((value, k) => {
    if (value === 0 && degree > 0) return;
    const power = variable === "s" ? degree - k : k;
    const symbol = power === 0 ? "" : variable === "s" ? `s${power === 1 ? "" : superscript(String(power))}` : `q⁻${superscript(String(power))}`;
    const size = significant(value === null ? null : Math.abs(value), 5).replace(/\.?0+(?=·|$)/, (zeros, at, whole) => (whole.slice(0, at).includes(".") || zeros.startsWith(".") ? "" : zeros));
    const factor = value !== null && Math.abs(value) === 1 && symbol ? symbol : `${size}${symbol ? ` ${symbol}` : ""}`;
    const negative = value !== null && value < 0;
    parts.push(parts.length === 0 ? (negative ? `−${factor}` : factor) : `${negative ? "−" : "+"} ${factor}`);
  });
  return parts.join(" ");
}

function formula(result: TransferFunction): HTMLElement {
  const { numerator, denominator, variable, delay_s: delay } = result;
  const [above, below] = [polynomial(numerator, variable), polynomial(denominator, variable)];
  const name = variable === "s" ? "G(s)" : "G(q)";
  const after = delay > 0 ? (variable === "s" ? `e^(−${plain(delay)} s)` : `, ${plain(delay)} s later`) : "";
  return scrolling("The model", h("div", { class: "formula", role: "img", "aria-label": `${name} = (${above}) / (${below}) ${after}` },
    h("span", {}, `${name} =`),
    h("span", { class: "fraction" }, h("span", {}, above), h("span", {}, below)),
    delay > 0
      ? variable === "s" ? h("span", {}, "e", h("sup", {}, `−${plain(delay)} s`)) : h("span", {}, after)
      : ""));
}

function summary(report: TransferFunctionReport): HTMLElement {
  const { result } = report;
  const said = verdict({ result, plainly: transferFunctionWarnings });
  const explained = result.fit.R2_held_out ?? result.fit.R2_in_sample;
  const where = result.fit.R2_held_out === undefined ? "of the data used for fitting, which is optimistic" : "of held-out (validation) data";
  return h("section", { id: "summary" }, heading(2, "Summary"),
    h("div", { class: `verdict ${said.kind}`, "data-usable": String(result.usable) },
      h("span", { class: "sign", "aria-hidden": "true" }, said.sign),
      h("p", {}, h("strong", {}, `${said.word}. `), said.reason)),
    formula(result),
    h("p", {}, `From ${result.input.name} to ${result.output.name}: ${count(result.denominator.length - 1, "pole")}, ${count(result.numerator.length - 1, "zero")}`, ...delayWords(result), ". The model explains ",
      data(explained, explained === null ? "an undefined share" : `${fixed(100 * explained, 2)} %`, "explained"), ` ${where}.`),
    result.hold ? h("p", { id: "hold" }, holdWords(result.hold, result.hold_found === true)) : "");
}

function delayWords({ delay_s: delay, delay_found: found, delay_standard_error_s: error }: TransferFunction): (Node | string)[] {
  if (found && error !== undefined) return [", a delay of ", withHalfWidth(delay, error, "delay"), " s, which was estimated"]; // 0 ± 3 ms is an answer too
  if (!(delay > 0)) return [];
  return [`, a delay of ${plain(delay)} s${found ? ", which was estimated and counts as known in the intervals" : ""}`];
}

function holdWords(hold: "zero" | "first", found: boolean): string {
  const [what, because] = hold === "zero" ? ["keeps its value (zero-order hold)", "as its steps show"] : ["is interpolated linearly (first-order hold)", "as it shows no steps"];
  return `Between samples the input ${what}${found ? `, ${because}` : ", as asked"}.`;
}

const count = (n: number, word: string): string => `${n} ${word}${n === 1 ? "" : "s"}`;

function coefficientsSection(result: TransferFunction): HTMLElement {
  const rows = result.parameters.map(({ name, value, standard_error }) => [
    h("span", {}, name.slice(0, 1), h("sub", {}, name.slice(1))),
    withHalfWidth(value, standard_error, name),
  ]);
  const power = result.variable === "s" ? "of the powers of s: b numerator, a denominator" : "of the powers of q⁻¹: b numerator, f denominator";
  return h("section", { id: "coefficients" }, heading(2, "Coefficients"),
    table(`Coefficients ${power}, in seconds and SI units; ± is half of the 95 % interval, for ${result.hac_lag_s > 0 ? `noise correlated over up to ${plain(result.hac_lag_s)} s` : "white noise"}`,
      ["", "value ± 95 %"], rows, "numbers"));
}

function rootsSection(result: TransferFunction): HTMLElement {
  const row = (kind: string, root: Root, id: string): (Node | string)[] => [
    root.pair ? `${kind} pair` : kind,
    h("span", { class: "number" }, withHalfWidth(root.frequency_hz, root.frequency_standard_error_hz, `${id}-frequency`), " Hz"),
    root.pair ? withHalfWidth(root.damping, root.damping_standard_error, `${id}-damping`) : "",
    h("span", { class: "number" }, significant(root.re, 4), root.pair ? ` ± ${significant(root.im, 4)} j` : ""),
    root.outside_band ? "outside the excited band" : "",
  ];
  return h("section", { id: "roots" }, heading(2, "Poles, zeros and gain"),
    table("Poles and zeros; ± is half of the 95 % interval", ["", "frequency", "damping ζ", "value [1/s]", ""],
      [...result.poles.map((root, k) => row("pole", root, `pole${k}`)), ...result.zeros.map((root, k) => row("zero", root, `zero${k}`))], "numbers"),
    h("p", {}, "Gain at frequency zero: ", withHalfWidth(result.gain, result.gain_standard_error, "gain"), ` ${ratioUnit(result)}.`));
}

function impedanceSection(result: TransferFunction): HTMLElement | undefined {
  const { impedance } = result;
  if (!impedance) return undefined;
  const terms = [["inertia M", "M"], ["damping B", "B"], ["stiffness K", "K"]] as const;
  const rows = terms.flatMap(([name, symbol]) => {
    const one = impedance[symbol];
    return one ? [[name, withHalfWidth(one.value, one.standard_error, `impedance-${symbol}`), impedance.units[symbol]]] : [];
  });
  return h("section", { id: "impedance" }, heading(2, "Impedance"),
    h("p", {}, `The model is an admittance, from a force to the ${impedance.admittance_to} that it causes. Its inverse gives the force for a motion.`),
    impedance.unstable
      ? h("p", { class: "care-text" }, "This impedance is unstable because the admittance has zeros in the right half-plane. This is impossible for a limb.")
      : "",
    rows.length ? table("Inertia, damping and stiffness; ± is half of the 95 % interval", ["", "value ± 95 %", "unit"], rows, "numbers") : "",
    figure(bode(impedance.force_per_velocity, {
      id: "impedance-bode",
      title: "Impedance, force per velocity",
      unit: impedance.units.B,
      howToRead: "A falling line is stiffness, a level one damping, a rising one inertia. Only the excited band is shown.",
    })),
    nyquist(impedance.force_per_velocity, undefined, "impedance-nyquist", "Impedance, force per velocity", impedance.units.B));
}

const withoutRealPart = ({ real: _, real_interval95: __, ...response }: FrequencyResponse): Curve => response;

function responseSection(result: TransferFunction): HTMLElement {
  const unit = ratioUnit(result);
  return h("section", { id: "response" }, heading(2, "Frequency response"),
    figure(bode(withoutRealPart(result.frequency_response), {
      id: "bode",
      title: "Bode plot",
      unit,
      band: bandOf(result),
      howToRead: "Gain and phase lag of the output relative to the input at each frequency. Within the shaded band the data determine the response; beyond it the model extrapolates.",
    })),
    nyquist(result.frequency_response, bandOf(result), "nyquist", "Nyquist plot", unit));
}

function simulationSection({ simulation: s, result }: TransferFunctionReport): HTMLElement | undefined {
  if (s.time_s.length === 0) return undefined;
  const where = s.held_out ? "held-out (validation) data" : "the data used for fitting";
  return h("section", { id: "simulation" }, heading(2, `Measured and simulated output, on ${where}`),
    figure({
      id: "simulated",
      title: `Measured and simulated output on ${where}`,
      howToRead: "The simulation uses only the input and the initial state. The closer the dashed line is to the solid one, the better the model.",
      description: `The model explains ${significant(100 * (result.fit.R2_held_out ?? result.fit.R2_in_sample ?? 0), 4)} per cent of the output.`,
      x: { name: "time", unit: "s" },
      panels: [{
        title: "Output",
        unit: shownUnit(result.output.unit),
        series: [
          { name: "measured", x: s.time_s, y: s.measured, style: styles.measured },
          { name: "simulated by the model", x: s.time_s, y: s.simulated, style: styles.predicted },
        ],
      }],
    }));
}

function ordersSection(result: TransferFunction): HTMLElement | undefined {
  if (!result.orders) return undefined;
  const rows = result.orders.map((one) => [
    `${count(one.poles, "pole")}, ${count(one.zeros, "zero")}`,
    ...(one.usable ? [fixed(one.R2, 6), fixed(one.YIC, 2), fixed(one.AIC, 1), fixed(one.BIC, 1)] : ["no stable model", "", "", ""]),
    one.chosen ? h("strong", {}, "chosen") : "",
  ]);
  return h("section", { id: "orders" }, heading(2, "Model order"),
    table("Models that were tried", ["", "R²", "YIC", "AIC", "BIC", ""], rows, "numbers orders"),
    h("p", { class: "reading" }, "Among the models whose 1 − R² is within 2 % of the minimum, the one with the lowest YIC is chosen."));
}

function residualSection(result: TransferFunction): HTMLElement {
  const { residuals: r, fit } = result;
  const share = (value: Value): string => (value === null ? "undefined" : `${fixed(100 * value, 0)} % of ${r.lags} lags`);
  const rows = [
    ["Is the residual white noise?", r.white ? "no evidence against it" : "no: it is coloured", `p = ${significant(r.whiteness_p, 2)}`, share(r.autocorrelation_outside)],
    ["Does the input still explain part of the residual?", r.independent_of_input ? "no evidence for it" : "yes: the model misses a part", `p = ${significant(r.cross_p, 2)}`, share(r.cross_correlation_outside)],
  ];
  const unit = result.output.unit ? ` ${shownUnit(result.output.unit)}` : "";
  return h("section", { id: "residuals" }, heading(2, "Residual"),
    table("Tests of the residual", ["", "answer", "p-value", "beyond the 99 % limit"], rows, "tests"),
    facts([
      ["Held out", fit.R2_held_out === undefined ? undefined : `R² ${fixed(fit.R2_held_out, 5)}, RMSE ${significant(fit.RMSE_held_out, 4)}${unit}`],
      ["In sample", `R² ${fixed(fit.R2_in_sample, 5)}, noise ${significant(fit.noise_standard_deviation, 4)}${unit}`],
      ["YIC, AIC, BIC", `${fixed(fit.YIC, 2)}, ${fixed(fit.AIC, 1)}, ${fixed(fit.BIC, 1)}`],
      ["Starts", `${result.starts.length} tried, ${result.starts.filter((start) => start.converged).length} settled`],
    ]));
}

function provenance(result: TransferFunction): HTMLElement {
  return h("section", { id: "provenance" }, heading(2, "Methods and provenance"),
    table("Files", ["file", "format", "SHA-256"], result.inputs.map((input) => [h("span", { class: "path" }, input.file), input.format, h("code", { class: "hash" }, input.sha256)]), "files"),
    result.notes.length ? h("div", {}, h("p", {}, h("strong", {}, "Notes")), h("ul", {}, ...result.notes.map((note) => h("li", {}, note)))) : "");
}

export function transferFunctionSections(report: TransferFunctionReport): HTMLElement[] {
  const { result } = report;
  return [
    summary(report),
    warningsSection({ result, plainly: transferFunctionWarnings }, "transfer-function", 2),
    impedanceSection(result),
    responseSection(result),
    coefficientsSection(result),
    rootsSection(result),
    simulationSection(report),
    residualSection(result),
    ordersSection(result),
    provenance(result),
  ].filter((section): section is HTMLElement => section !== undefined);
}

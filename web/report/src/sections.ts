// Facts of the recording, the model, and methods and provenance.
import type { Value } from "@mbk/shared/documents";
import { facts, h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { anyAngle, ellipsesOf } from "@mbk/shared/ellipses";
import { csvOf } from "@mbk/shared/sheet";
import { data, fixed, listed, perAxis, plain, significant, withHalfWidth, withInterval } from "@mbk/shared/format";
import { axisNames, matrices, type Trial, unitsOf } from "@mbk/shared/result";
import { conditionOf, fileOf, isSimulated, metadataOf, participantOf } from "./data";
import { literatureTable } from "./literature";
import { elementHeads, matrixRows } from "./matrix_rows";
import { saveable } from "./picture";
import { methodNames } from "./words";

const percent = (share: Value): Value => (share === null ? null : 100 * share);
const onlyOne = (values: string[]): string => [...new Set(values)].join(", ");

/** File, participant, window, filters, method, mode. */
export const recordingSection = (trial: Trial, id: string, level: HeadingLevel): HTMLElement =>
  h("section", { id: `${id}-recording` }, heading(level, "Recording and settings"), identityFacts(trial));

function identityFacts(trial: Trial): HTMLElement {
  const { result } = trial;
  const how = result.preparation[0];
  const filters = how
    ? `Savitzky–Golay of order ${how.savitzky_golay.order} over ${how.savitzky_golay.window} samples${how.cutoff_hz === null ? ", no low-pass" : `, then zero-phase Butterworth at ${plain(how.cutoff_hz, 3)} Hz`}`
    : undefined;
  return facts([
    ["File", fileOf(trial)],
    ["Participant", participantOf(trial)],
    ["Condition", conditionOf(trial)],
    ["Posture", metadataOf(trial, "posture")],
    ["Protocol", how ? `${how.protocol} (${how.protocol_rule})` : result.protocol],
    ["Duration", `${listed(result.inputs.map((input) => plain(input.duration_s, 4)))} s at ${onlyOne(result.inputs.map((input) => plain(input.rate_hz, 5)))} Hz`],
    ["Window", how?.window_rule],
    ["Filters", filters],
    ["Method", `${methodNames[result.method]}${result.method_rule ? ` (${result.method_rule})` : ""}`],
    ["Mode", result.mode === "reference" ? `reference: the published procedure, ${how?.procedure ?? ""}` : result.mode],
  ]);
}

export const simulatedNote = (trials: Trial[]): HTMLElement | undefined =>
  trials.some(isSimulated)
    ? h("p", { class: "simulated" }, h("strong", {}, "Simulated. "), trials.every(isSimulated)
      ? "No person was measured; the metadata contain the true values."
      : "Some of these recordings are simulated: their metadata contain the true parameters. They are not of a person.")
    : undefined;

export function modelSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement {
  const { result } = trial;
  const { axes, model, standard_error: error, fit } = result;
  const units = unitsOf(result);
  const names = axisNames(axes);
  const heads = elementHeads(axes, "value ± 95 %");
  const rows = matrices.flatMap(({ symbol, name }) => matrixRows(`${name} ${symbol}`, axes,
    (j, i) => withHalfWidth(model[symbol][j]?.[i] ?? null, error[symbol][j]?.[i] ?? null, `${symbol}${j}${i}`), () => [units[symbol]]));
  const millimetres = units.x0 === "m";
  const equilibrium = names.map((name, j) =>
    h("span", {}, name ? `${name} ` : "", withHalfWidth(model.x0[j] ?? null, error.x0[j] ?? null, `x0${j}`, millimetres ? 1000 : 1)));
  rows.push(["equilibrium x₀", ...equilibrium, ...heads.slice(axes).map(() => ""), millimetres ? "mm" : units.x0]);
  const fitRows: (Node | string)[][] = [
    [`VAF on ${fit.validated_on === "held-out" ? "held-out (validation) data" : "the fitted data"}`, perAxis(fit.VAF, 2, "%", "VAF")],
    ["VAF in sample", perAxis(fit.VAF_in_sample, 2, "%", "VAF_in_sample")],
    [`RMSE on ${fit.validated_on === "held-out" ? "held-out (validation) data" : "the fitted data"}`, perAxis(fit.RMSE, 3, units.force, "RMSE")],
  ];
  return h(
    "section",
    { id: `${id}-model` },
    heading(level, "Model"),
    h("p", { class: "equation" }, "M ẍ + B ẋ + K (x − x₀) = −F, with F the force that the limb exerts on the machine."),
    result.usable
      ? table("Inertia, damping, stiffness and equilibrium; ± is half of the 95 % interval", ["", ...heads, "unit"], rows, "numbers")
      : h("p", { "data-name": "no-model" }, "The model is not usable, so its numbers are not shown. ", h("code", {}, "mbk measure --json"), " writes them."),
    axes === 2 && result.usable
      ? h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "“xy” is the force along x caused by motion along y.")
      : axes === 3 && result.usable
        ? h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "A row gives the force along its axis, a column the motion along its axis that causes it.")
        : "",
    table("Fit", ["", "value"], fitRows, "numbers narrow"),
    literatureTable(trial),
  );
}

/** Half axes, orientation and intervals of the ellipses of each. */
export function ellipsesCsv(all: { name: string; trial: Trial }[]): string {
  return csvOf(["recording", "matrix", "unit", "semi-minor axis", "semi-major axis", "orientation [°]", "orientation, low", "orientation, high", "area", "area, low", "area, high", "shape", "shape, low", "shape, high"],
    all.flatMap(({ name: recording, trial }) => matrices.flatMap(({ symbol, name }) => {
      const e = trial.result.ellipses?.[name];
      if (!e) return [];
      const { area, shape, orientation_deg: orientation } = e.interval95;
      return [[recording, symbol, unitsOf(trial.result)[symbol], e.eigenvalues[0], e.eigenvalues[1], e.orientation_deg, ...orientation, e.area, ...area, e.shape, ...shape]];
    })));
}

export function ellipsesSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const { ellipses, antisymmetry } = trial.result;
  if (!ellipses || !trial.result.usable) return undefined;
  const units = unitsOf(trial.result);
  const rows = matrices.map(({ symbol, name }) => {
    const e = ellipses[name];
    const unit = units[symbol];
    const anti = name === "damping" ? undefined : antisymmetry?.[name];
    const areaDecimals = e.area !== null && e.area < 100 ? 2 : 0;
    return [
      `${name} ${symbol}`,
      e.area === null ? "none" : h("span", { class: "number" }, withInterval(e.area, e.interval95.area, `${name}-area`, areaDecimals), ` ${unit.includes("·") || unit.includes("/") ? `(${unit})` : unit}²`),
      e.shape === null ? "none" : withInterval(e.shape, e.interval95.shape, `${name}-shape`, 2),
      anyAngle(e.interval95.orientation_deg)
        ? "any: may be a circle"
        : h("span", { class: "number" }, withInterval(e.orientation_deg, e.interval95.orientation_deg, `${name}-orientation`, 1), e.orientation_deg === null ? "" : "°"),
      h("span", { class: "number" }, ...([["large", 1], ["small", 0]] as const).flatMap(([which, k]) => [
        data(e.eigenvalues[k], significant(e.eigenvalues[k]), `${name}-${which}`),
        h("span", { class: "half" }, ` [${(e.interval95.eigenvalues[k] ?? []).map((end) => significant(end, 3)).join(", ")}]`),
        which === "large" ? " and " : ` ${unit}`]))
,
      anti === undefined ? "" : anti.zmean_percent === null ? "undefined" : h("span", { class: "number" }, withInterval(anti.zmean_percent, anti.interval95, `${name}-zmean`, 1), " %"),
    ];
  });
  return h(
    "section",
    { id: `${id}-ellipses` },
    heading(level, "Ellipses"),
    saveable(ellipsesOf(trial), { name: `${id}-ellipses`, title: "Ellipses", csv: () => ellipsesCsv([{ name: fileOf(trial), trial }]) }),
    table("Ellipses; brackets are 95 % intervals", ["", "area", "shape", "orientation", "semi-axes", "antisymmetry"], rows, "numbers"),
  );
}

function preparationFacts(trial: Trial): HTMLElement[] {
  return trial.result.preparation.map((how, k) =>
    h("div", { class: "preparation" },
      trial.result.preparation.length > 1 ? h("p", {}, h("strong", {}, `Recording ${k + 1}`)) : "",
      facts([
        ["Protocol", `${how.protocol}: ${how.protocol_rule}`],
        ["Window", `${plain(how.from_s, 6)} s to ${plain(how.to_s, 6)} s: ${how.window_rule}`],
        ["Held-out (validation) data from", how.split_s === undefined ? undefined : `${plain(how.split_s, 6)} s`],
        ["Perturbations", how.perturbations === undefined ? undefined : String(how.perturbations)],
        ["Smoothing", `Savitzky–Golay, order ${how.savitzky_golay.order}, window ${how.savitzky_golay.window} samples`],
        ["Low-pass", how.cutoff_hz === null ? "none" : `zero-phase Butterworth of order 5, ${plain(how.cutoff_hz, 4)} Hz: ${how.cutoff_rule}`],
        ["Excited band", `${plain(how.excited_band_hz[0], 3)} to ${plain(how.excited_band_hz[1], 3)} Hz`],
        [
          "Force",
          how.force_source === "virtual"
            ? "not measured: from motion, motor torques and a model of the robot"
            : how.force_source === "observer"
              ? "not measured: by a momentum observer, from motion, motor torques and a model of the robot"
              : "from the force sensor",
        ],
        ["Acceleration", how.acceleration === "sensor" ? "from the accelerometer" : "second derivative of the position"],
        ["Order", how.cut_before_filter ? "cut into windows, then filtered" : "filtered, then cut into windows"],
      ])));
}

export function provenanceSection(trial: Trial, id: string, level: HeadingLevel): HTMLElement {
  const { result } = trial;
  const { estimation: e, excitation: x } = result;
  const units = unitsOf(result);
  const inputs = result.inputs.map((input) => [
    h("span", { class: "path" }, input.file),
    input.format,
    h("code", { class: "hash" }, input.sha256),
  ]);
  const metadata = trial.recordings.flatMap((one, k) =>
    Object.entries(one.metadata).map(([key, value]): [string, string] => [trial.recordings.length > 1 ? `${k + 1}: ${key}` : key, value]));
  return h(
    "section",
    { id: `${id}-provenance` },
    heading(level, "Methods and provenance"),
    table("Files", ["file", "format", "SHA-256"], inputs, "files"),
    ...preparationFacts(trial),
    facts([
      ["Estimator", `${methodNames[result.method]}, structure ${result.structure}`],
      ["Data used for the parameters", `${plain(e.duration_s, 4)} s, ${e.samples} samples (${e.parameters_from})`],
      ["Noise correlation time", `${plain(e.hac_lag_s, 3)} s, allowed for in the standard errors`],
      ["Handle mass subtracted", e.handle_mass_kg ? `${plain(e.handle_mass_kg)} kg` : "none"],
      ["Motion", `${significant(x.motion)} ${units.x0} rms${result.axes > 1 && x.motion_ratio !== null ? `, ${fixed(100 * x.motion_ratio, 0)} % as much ${result.axes === 2 ? "across the main direction as along it" : "in the weakest direction as in the strongest"}` : ""}`],
      ["Condition number", `${significant(x.condition, 2)}, rank ${x.rank}`],
      ["Refitted at a lower sample rate", result.decimate_check ? `at ${plain(result.decimate_check.rate_hz)} Hz the model differs by ${significant(percent(result.decimate_check.largest_relative_change), 2)} %` : undefined],
    ]),
    result.notes?.length ? h("div", {}, h("p", {}, h("strong", {}, "Notes from reading the file")), h("ul", {}, ...result.notes.map((note) => h("li", {}, note)))) : "",
    metadata.length
      ? h("details", { class: "metadata", "data-print": true }, h("summary", {}, "Metadata of the recording"), facts(metadata))
      : "",
  );
}

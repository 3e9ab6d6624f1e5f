// Charts to judge the quality of one measurement.
import type { Columns, Diagnostics, Value } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel } from "@mbk/shared/dom";
import { listed, plain, significant } from "@mbk/shared/format";
import { axisNames, axisPrefix, type Trial, unitsOf } from "@mbk/shared/result";
import { type Chart, figure, type Panel, styles } from "./charts";

interface Section {
  title: string;
  charts: Chart[];
  note?: string | undefined;
}

const styleOfAxis = (axis: number) => [styles.first, styles.second, styles.third][axis] ?? styles.third;
const columns = (matrix: Columns): Value[][] => matrix.filter((column) => column.length > 0);
const squared = (unit: string): string => (unit.includes(" or ") ? `(${unit})²/Hz` : `${unit.includes("·") ? `(${unit})` : unit}²/Hz`);

function largest(values: Value[]): number {
  return values.reduce<number>((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
}

/** The same words for each axis. */
const each = (axes: number, words: (axis: number) => string): string =>
  Array.from({ length: axes }, (_, axis) => `${axisPrefix(axes, axis)}${words(axis)}`).join("; ");

export function diagnosticSections(trial: Trial, id: string): Section[] {
  const { diagnostics: d, result } = trial;
  if (!d) return [];
  return [
    predictionSection(d, trial, id),
    residualSection(d, trial, id),
    spectraSection(d, trial, id),
    filterSection(d, trial, id),
    ...(d.acceleration ? [accelerationSection(d.acceleration, result.axes, accelerationUnit(trial), id)] : []),
    recordingSection(d, trial, id),
  ].filter((section) => section.charts.length > 0);
}

const accelerationUnit = (trial: Trial): string => {
  const unit = unitsOf(trial.result).x0;
  return unit.includes(" or ") ? "m/s² or rad/s²" : `${unit}/s²`;
};

function predictionSection(d: Diagnostics, trial: Trial, id: string): Section {
  const { prediction: p } = d;
  const { axes, fit } = trial.result;
  const unit = unitsOf(trial.result).force;
  const where = p.held_out ? "held-out (validation) data" : "the data used for fitting";
  const panels = columns(p.measured).map((measured, axis): Panel => ({
    title: axes === 1 ? "Force" : `Force along ${axisNames(axes)[axis]}`,
    unit,
    series: [
      { name: "measured", x: p.time_s, y: measured, style: styles.measured },
      { name: "predicted by the model", x: p.time_s, y: p.predicted[axis] ?? [], style: styles.predicted },
    ],
  }));
  return {
    title: `Measured and predicted force, on ${where}`,
    charts: panels.length === 0 ? [] : [{
      id: `${id}-prediction`,
      title: `Measured and predicted force on ${where}`,
      howToRead: "The closer the dashed line is to the solid one, the better the model. Where they differ for long, inertia, damping and stiffness do not explain the force.",
      description: each(axes, (axis) => `the model explains ${significant(fit.VAF[axis], 3)} per cent of the force`),
      x: { name: "time", unit: "s" },
      panels,
    }],
  };
}

function residualSection(d: Diagnostics, trial: Trial, id: string): Section {
  const { prediction: p, autocorrelation: a } = d;
  const { axes } = trial.result;
  const unit = unitsOf(trial.result).force;
  const residual = columns(p.residual).map((y, axis): Panel => ({
    title: axes === 1 ? "Residual" : `Residual along ${axisNames(axes)[axis]}`,
    unit,
    series: [{ name: "measured − predicted", x: p.time_s, y, style: styles.residual }],
  }));
  const white = a.white95 ?? 0;
  const series = columns(a.value).map((y, axis) => ({
    name: axes === 1 ? "autocorrelation" : `residual along ${axisNames(axes)[axis]}`,
    x: a.lag_s,
    y,
    style: styleOfAxis(axis),
  }));
  const timeConstants = listed(a.time_constant_s.map((t, axis) => `${axisPrefix(axes, axis)}${t === null ? "longer than shown" : `${significant(t, 2)} s`}`));
  const charts: Chart[] = [];
  if (residual.length > 0) {
    charts.push({
      id: `${id}-residual`,
      title: "Residual force",
      howToRead: "Measured minus predicted force: it should look like noise of constant size, without bursts, drift or rhythm.",
      description: each(axes, (axis) => `largest residual ${significant(largest(p.residual[axis] ?? []))} ${unit}`),
      x: { name: "time", unit: "s" },
      panels: residual,
      panelHeight: 110,
    });
  }
  if (series.length > 0) {
    charts.push({
      id: `${id}-autocorrelation`,
      title: "Autocorrelation of the residual",
      howToRead: "White noise stays within the grey band after lag 0. A slow decay means that fewer samples are independent, which the ± intervals account for.",
      description: `It falls below 1/e after ${timeConstants}. White noise would stay within ±${significant(white, 2)}.`,
      x: { name: "lag", unit: "s" },
      panels: [{ title: "Autocorrelation", unit: "", series, level: { from: -white, to: white, name: "white noise, 95 %" } }],
    });
  }
  return { title: "Fit and residual", charts };
}

function bandOf(trial: Trial): { from: number; to: number; name: string } | undefined {
  const [from, to] = trial.result.preparation[0]?.excited_band_hz ?? [null, null];
  return from === null || to === null || !(from < to) ? undefined : { from, to, name: "excited band" };
}

/** Powers of ten around the values, at most eight. */
function decades(series: (number | null)[][]): [number, number] {
  const powers = series.flat().filter((v): v is number => v !== null && v > 0).map(Math.log10);
  const top = Math.ceil(powers.reduce((a, b) => Math.max(a, b), -Infinity));
  const bottom = Math.floor(powers.reduce((a, b) => Math.min(a, b), Infinity));
  return Number.isFinite(top) ? [10 ** Math.max(bottom, top - 8), 10 ** Math.max(top, bottom + 1)] : [1e-3, 1];
}

function spectraSection(d: Diagnostics, trial: Trial, id: string): Section {
  const { spectra: s } = d;
  const { axes } = trial.result;
  const units = unitsOf(trial.result);
  const band = bandOf(trial);
  // Zero frequency has no place on a logarithmic axis.
  const keep = s.frequency_hz.map((f) => f !== null && f > 0);
  const from = Math.max(keep.indexOf(true), 0);
  const x = s.frequency_hz.slice(from);
  const panel = (title: string, unit: string, matrix: Columns): Panel => ({
    title,
    unit: squared(unit),
    log: true,
    range: decades(columns(matrix)),
    ...(band ? { band } : {}),
    series: columns(matrix).map((y, axis) => ({
      name: axes === 1 ? "spectrum" : `along ${axisNames(axes)[axis]}`,
      x,
      y: y.slice(from),
      style: styleOfAxis(axis),
    })),
  });
  const charts: Chart[] = [];
  const words = band ? `The excited band is ${plain(band.from, 3)} to ${plain(band.to, 3)} Hz.` : "No excited band is known.";
  if (columns(s.position).length > 0) {
    charts.push({
      id: `${id}-spectra`,
      title: "Power spectral densities",
      howToRead: "Position and force as recorded, and the residual after filtering: within the shaded band the force should be well above the residual.",
      description: words,
      x: { name: "frequency", unit: "Hz", log: true },
      panels: [panel("Position", units.x0, s.position), panel("Force", units.force, s.force), panel("Residual", units.force, s.residual)].filter((one) => one.series.length > 0),
      panelHeight: 130,
    });
  }
  if (columns(s.coherence).length > 0) {
    const significantAt = s.coherence_significant ?? 0;
    charts.push({
      id: `${id}-coherence`,
      title: "Coherence of force and motion",
      howToRead: "Near 1 in the shaded band, the force follows the motion linearly there; a dip marks a frequency at which noise or other activity of the limb contributes. Within the grey band it is not significant (95 %).",
      description: `${words} Coherence above ${significant(significantAt, 2)} is significant (95 %).`,
      x: { name: "frequency", unit: "Hz", log: true },
      panels: [{
        title: "Coherence",
        unit: "",
        range: [0, 1],
        ...(band ? { band } : {}),
        level: { from: 0, to: significantAt, name: "not significant (95 %)" },
        series: columns(s.coherence).map((y, axis) => ({
          name: axes === 1 ? "force with motion" : `force along ${axisNames(axes)[axis]}`,
          x,
          y: y.slice(from),
          style: styleOfAxis(axis),
        })),
      }],
    });
  }
  return { title: "Spectra and coherence", charts };
}

function filterSection(d: Diagnostics, trial: Trial, id: string): Section {
  const { filters: f } = d;
  const band = bandOf(trial);
  const keep = f.frequency_hz.findIndex((v) => v !== null && v > 0);
  if (keep < 0) return { title: "", charts: [] };
  const x = f.frequency_hz.slice(keep);
  const line = (name: string, y: Value[], style: (typeof styles)[keyof typeof styles]) => ({ name, x, y: y.slice(keep), style });
  const gains = [...f.smoothing, ...f.first, ...f.second].filter((v): v is number => v !== null && v > 0);
  const top = 10 ** Math.ceil(Math.log10(Math.max(...gains, 1)));
  return {
    title: "Filters",
    charts: [{
      id: `${id}-filters`,
      title: "Gain of the filters",
      howToRead: "Within the shaded band the thick lines should lie on the thin dashed ones, which are ideal; above it they should fall, so that noise is not amplified.",
      description: "Gain of smoothing, first and second derivative against frequency, with the ideal differentiators.",
      x: { name: "frequency", unit: "Hz", log: true },
      panels: [{
        title: "Gain (1, 1/s, 1/s²)",
        unit: "",
        log: true,
        range: [1e-3, top],
        ...(band ? { band } : {}),
        series: [
          line("smoothing", f.smoothing, { ...styles.measured, width: 1.4 }),
          line("first derivative", f.first, { ...styles.first, width: 1.6 }),
          line("second derivative", f.second, { ...styles.third, width: 2 }),
          line("ideal", f.first_ideal, styles.ideal),
          line("ideal", f.second_ideal, styles.ideal),
        ],
      }],
      panelHeight: 250,
    }],
  };
}

function accelerationSection(a: NonNullable<Diagnostics["acceleration"]>, axes: number, unit: string, id: string): Section {
  const words = each(axes, (axis) => `the two differ by ${significant(a.rms_difference[axis], 2)} ${unit} rms, and the derivative explains ${significant(a.VAF[axis], 3)} per cent of the sensor's signal`);
  return {
    title: "Acceleration: derivative and sensor",
    note: `${words}.`,
    charts: [{
      id: `${id}-acceleration`,
      title: "Acceleration from the position and from the accelerometer",
      howToRead: "Two independent estimates of the same acceleration: if the lines agree, position, filters and sensor are consistent.",
      description: words,
      x: { name: "time", unit: "s" },
      panels: columns(a.derivative).map((derivative, axis) => ({
        title: axes === 1 ? "Acceleration" : `Acceleration along ${axisNames(axes)[axis]}`,
        unit,
        series: [
          { name: "accelerometer", x: a.time_s, y: a.sensor[axis] ?? [], style: styles.measured },
          { name: "second derivative of position", x: a.time_s, y: derivative, style: styles.predicted },
        ],
      })),
      panelHeight: 150,
    }],
  };
}

function recordingSection(d: Diagnostics, trial: Trial, id: string): Section {
  const { recording: r } = d;
  const { axes, preparation } = trial.result;
  const units = unitsOf(trial.result);
  const how = preparation[0];
  const panel = (title: string, unit: string, matrix: Columns): Panel => ({
    title,
    unit,
    ...(how && how.from_s < how.to_s ? { band: { from: how.from_s, to: how.to_s, name: "analysed interval" } } : {}),
    series: columns(matrix).map((y, axis) => ({
      name: axes === 1 ? "recorded" : `along ${axisNames(axes)[axis]}`,
      x: r.time_s,
      y,
      style: styleOfAxis(axis),
    })),
  });
  // Each position axis has its own scale: the limb moves by millimetres, decimetres from the origin.
  const places = (title: string, unit: string, matrix: Columns): Panel[] => {
    const whole = panel(title, unit, matrix);
    return whole.series.map((one, axis) => ({
      ...whole,
      title: axes === 1 ? title : `${title} ${axisNames(axes)[axis]}`,
      series: [one],
    }));
  };
  // The reference may be a position or a force; the values do not include its unit.
  return {
    title: "Recording",
    charts: [{
      id: `${id}-recording`,
      title: "The recording from start to end",
      howToRead: "All signals as recorded, before filtering; look for jumps, drift, pauses and saturation.",
      description: "Position, force and reference over the whole recording.",
      x: { name: "time", unit: "s" },
      panels: [...places("Position", units.x0, r.position), panel("Force", units.force, r.force), ...places("Reference", "", r.reference)].filter((one) => one.series.length > 0),
      panelHeight: 110,
    }].filter((chart) => chart.panels.length > 0),
  };
}

export function diagnosticElements(trial: Trial, id: string, level: HeadingLevel): HTMLElement[] {
  if (!trial.diagnostics) {
    return [
      h("section", { id: `${id}-diagnostics` }, heading(level, "Plots"),
        h("p", {}, "There are no plots: the signals of this result were not stored for the report.")),
    ];
  }
  return diagnosticSections(trial, id).map((section, k) =>
    h(
      "section",
      { id: `${id}-diagnostics-${k}` },
      heading(level, section.title),
      section.note ? h("p", {}, section.note) : "",
      ...section.charts.map(figure),
    ),
  );
}

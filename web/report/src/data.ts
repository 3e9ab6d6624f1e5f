// The document of schema mbk.report/1 that stands in the page; docs/guide/report.md describes it.
import type { Alternative, Bootstrap, Disagreement, Energy, Instrument, Method, Passivity } from "./passivity_data";
import type { Model, Value } from "./values";

export type { MatrixName, Model, Value } from "./values";

export interface Ellipse {
  area: Value;
  shape: Value;
  orientation_deg: Value;
  eigenvalues: [Value, Value];
  symmetric_part?: Value[][];
  interval95: { area: [Value, Value]; shape: [Value, Value]; orientation_deg: [Value, Value] };
}

export interface Antisymmetry {
  value: Value;
  value_interval95: [Value, Value];
  zmean_percent: Value;
  interval95: [Value, Value];
}

export interface Warning {
  code: string;
  message: string;
  try: string;
}

export interface Preparation {
  protocol: string;
  protocol_rule: string;
  window_rule: string;
  from_s: number;
  to_s: number;
  split_s?: number;
  perturbations?: number;
  procedure?: string;
  savitzky_golay: { order: number; window: number };
  cutoff_hz: Value;
  cutoff_rule: string;
  excited_band_hz: [Value, Value];
  force_source?: string;
  acceleration: string;
  cut_before_filter: boolean;
}

export interface Result {
  schema: string;
  software: string;
  inputs: { file: string; sha256: string; format: string; duration_s: Value; rate_hz: Value }[];
  notes?: string[];
  mode?: string;
  protocol?: string;
  method: Method;
  axes: number;
  structure: string;
  units?: { M: string; B: string; K: string; x0: string; force: string };
  model: Model;
  standard_error: Model;
  fit: { VAF: Value[]; RMSE: Value[]; validated_on: string; VAF_in_sample: Value[] };
  ellipses?: Record<"inertia" | "damping" | "stiffness", Ellipse>;
  antisymmetry?: Record<"inertia" | "stiffness", Antisymmetry>;
  covariance?: { parameters: string[]; matrix: Value[][] };
  instrument?: Instrument;
  alternatives?: Alternative[];
  disagreement?: Disagreement | null;
  bootstrap?: Bootstrap;
  passivity?: Passivity;
  warnings: Warning[];
  usable: boolean;
  estimation: {
    parameters_from: string;
    samples: number;
    duration_s: Value;
    hac_lag_s: Value;
    handle_mass_kg: Value;
  };
  excitation: { rank: number; condition: Value; motion_ratio: Value; motion: Value; inertia_share: Value };
  decimate_check?: { rate_hz: number; largest_relative_change: number };
  preparation: Preparation[];
}

export interface Posture {
  of: "arm" | "robot" | "hand";
  points_m: [number, number][];
  note?: string;
}

export interface RecordingFacts {
  metadata: Record<string, string>;
  posture?: Posture;
}

/** Signals: one list for each axis. */
export type Columns = Value[][];

export interface Diagnostics {
  prediction: { held_back: boolean; time_s: Value[]; measured: Columns; predicted: Columns; residual: Columns };
  autocorrelation: { lag_s: Value[]; value: Columns; white95: Value; time_constant_s: Value[] };
  spectra: {
    frequency_hz: Value[];
    position: Columns;
    force: Columns;
    residual: Columns;
    coherence: Columns;
    coherence_significant: Value;
  };
  filters: {
    frequency_hz: Value[];
    smoothing: Value[];
    first: Value[];
    second: Value[];
    first_ideal: Value[];
    second_ideal: Value[];
  };
  acceleration?: { time_s: Value[]; derivative: Columns; sensor: Columns; rms_difference: Value[]; VAF: Value[] };
  recording: { time_s: Value[]; position: Columns; force: Columns; reference: Columns };
}

/** One result with what is drawn for it. */
export interface Trial {
  result: Result;
  recordings: RecordingFacts[];
  /** One for each recording. */
  energy?: Energy[];
  diagnostics?: Diagnostics;
}

export interface Report {
  software: string;
  command: string;
  note?: string;
  trials: Trial[];
  summary?: { trials: number; model: Model; between_trial_standard_error: Model };
}

/** Reads the document out of the page. Throws where it is none. */
export function readReport(json: any): Report {
  if (json.schema !== "mbk.report/1") throw new Error(`schema ${String(json.schema)} is not mbk.report/1`);
  const results: Result[] = json.result.results ?? [json.result];
  return {
    software: json.software,
    command: json.command,
    note: json.note,
    summary: json.result.summary,
    trials: results.map((result, k) => ({ result, ...json.trials[k] })),
  };
}

export const matrices = [
  { symbol: "M", name: "inertia", title: "Inertia" },
  { symbol: "B", name: "damping", title: "Damping" },
  { symbol: "K", name: "stiffness", title: "Stiffness" },
] as const;

export interface Units {
  M: string;
  B: string;
  K: string;
  x0: string;
  force: string;
}

/** Units, also where the file does not say what moves. */
export function unitsOf(result: Result): Units {
  return (
    result.units ?? {
      M: "kg or kg·m²",
      B: "N·s/m or N·m·s/rad",
      K: "N/m or N·m/rad",
      x0: "m or rad",
      force: "N or N·m",
    }
  );
}

export const axisNames = (axes: number): string[] => (axes === 1 ? [""] : ["x", "y"]);

/** "x: " before what belongs to one axis; nothing where there is only one. */
export const axisPrefix = (axes: number, axis: number): string => (axes === 1 ? "" : `${axisNames(axes)[axis]}: `);

const basename = (path: string): string => path.split(/[\\/]/).at(-1) ?? path;

export const fileOf = (trial: Trial): string => trial.result.inputs.map((input) => basename(input.file)).join(", ");

/** The metadata of that key where all recordings of the trial agree. */
export function metadataOf(trial: Trial, key: string): string | undefined {
  const values = new Set(trial.recordings.map((one) => one.metadata[key]));
  return values.size === 1 ? [...values][0] : undefined;
}

export const participantOf = (trial: Trial): string | undefined => metadataOf(trial, "participant");

export const conditionOf = (trial: Trial): string | undefined =>
  metadataOf(trial, "condition") ?? metadataOf(trial, "truth_condition");

/** A recording that knows its own truth comes out of a simulation. */
export const isSimulated = (trial: Trial): boolean =>
  trial.recordings.some((one) => Object.keys(one.metadata).some((key) => key.startsWith("truth_")));

/** The model that a method found, and how sure it is; none where the document does not hold it. */
export function modelBy(method: Method, trial: Trial): { model: Model; standard_error: Model } | undefined {
  const { result } = trial;
  return result.method === method ? result : result.alternatives?.find((one) => one.method === method);
}

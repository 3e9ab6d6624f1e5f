// The document of a report with three axes, of round numbers: principal values along the columns of a rotation.
import { withDiagnostics } from "./diagnostics.mjs";

export const frame = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
export const product = (A, B) => A.map((row) => B[0].map((_, i) => row.reduce((sum, a, k) => sum + a * B[k][i], 0)));
export const transposed = (A) => A[0].map((_, i) => A.map((row) => row[i]));
export const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
export const times = (A, v) => A.map((row) => dot(row, v));

/** Rotation about a vector by an angle [rad] (Rodrigues). */
export function rotationAbout(vector, angle) {
  const [x, y, z] = vector.map((value) => value / Math.hypot(...vector));
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [
    [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
    [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
    [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
  ];
}

const crossing = ([x, y, z]) => [[0, -z, y], [z, 0, -x], [-y, x, 0]];

const limb = {
  inertia: { symbol: "M", values: [2.4, 1.5, 0.9], turn: rotationAbout([1, 2, 0.5], 0.8), antisymmetric: [0.02, -0.01, 0.03] },
  damping: { symbol: "B", values: [38, 21, 12], turn: rotationAbout([0.2, 1, 1], -0.6), antisymmetric: [1.2, 0.4, -0.8] },
  stiffness: { symbol: "K", values: [640, 260, 140], turn: rotationAbout([1, -0.4, 2], 1.1), antisymmetric: [11, -6, 18] },
};

const share = 0.06; // half of an interval, of its value
const around = (value, part = share) => [value - part * Math.abs(value), value + part * Math.abs(value)];

/** Z = R (Q diag(λ) Qᵀ + [a]×) Rᵀ, and what mbk says of it. */
function matrixOf({ values, turn, antisymmetric }, R) {
  const Q = product(R, turn);
  const S = product(product(Q, values.map((value, k) => frame[k].map((one) => one * value))), transposed(Q));
  const a = times(R, antisymmetric);
  const Z = S.map((row, j) => row.map((value, i) => value + crossing(a)[j][i]));
  const principal = values.map((value, k) => ({ value, value95: around(value), direction: transposed(Q)[k], half_angle95_deg: 4 + 3 * k }));
  const closed = values[2] > 0;
  const volume = (4 / 3) * Math.PI * values[0] * values[1] * values[2];
  const shape = values[0] / values[2];
  const size = Math.hypot(...a);
  return {
    Z,
    ellipsoid: { principal, volume: closed ? volume : null, shape: closed ? shape : null, closed, symmetric_part: S,
      interval95: { volume: closed ? around(volume, 0.2) : [null, null], shape: closed ? around(shape, 0.1) : [null, null] } },
    circulation: { vector: a, vector95: a.map((value) => around(value, 1.5)), size, size95: [0, 2 * size], significant: false, percent: closed ? (100 * size) / Math.cbrt(values[0] * values[1] * values[2]) : null },
  };
}

/** A result in a frame that is turned by R.   @param changes  of `limb`, by the name of a matrix */
export function spatialResult(R = frame, changes = {}) {
  const found = Object.fromEntries(Object.entries(limb).map(([name, one]) => [name, { symbol: one.symbol, ...matrixOf({ ...one, ...changes[name] }, R) }]));
  const model = { ...Object.fromEntries(Object.values(found).map(({ symbol, Z }) => [symbol, Z])), x0: times(R, [0.42, -0.11, 0.23]) };
  const like = (value, part) => (Array.isArray(value) ? value.map((one) => like(one, part)) : part);
  const error = { M: like(model.M, 0.03), B: like(model.B, 0.8), K: like(model.K, 9), x0: [0.0004, 0.0005, 0.0003] };
  const fit = { VAF: [97.2, 95.8, 93.1], RMSE: [0.31, 0.34, 0.4], validated_on: "held-out", VAF_in_sample: [97.5, 96.1, 93.9] };
  const parameters = [...["m", "b", "k"].flatMap((name) => [..."xyz"].flatMap((row) => [..."xyz"].map((column) => `${name}_${row}${column}`))), "x0_x", "x0_y", "x0_z"];
  const errors = [error.M, error.B, error.K, error.x0].flat(2);
  const covariance = { parameters, matrix: parameters.map((_, j) => parameters.map((__, i) => (i === j ? errors[i] ** 2 : 0))) };
  const other = { method: "iv", model: { ...model, K: model.K.map((row) => row.map((value) => 1.02 * value)) }, standard_error: error, fit, covariance, warnings: [], usable: true,
    instrument: { reference: "position", first_stage_F: Array.from({ length: 9 }, (_, k) => 300 - 10 * k), weakest_F: 220, strong: true, coherent_residual_fraction: [0.02, 0.03, 0.05] } };
  const frequency = Array.from({ length: 40 }, (_, k) => 0.4 * 15 ** (k / 39));
  const index = { frequency_hz: frequency, value: frequency.map((f) => 10 - 1.2 / f), lower95: frequency.map((f) => 8 - 1.5 / f), upper95: frequency.map((f) => 12 - 0.9 / f) };
  const condition = (name, unit, value) => ({ name, source: "theory", unit, value, standard_error: 0.1 * value, lower: 0.8 * value, upper: 1.3 * value, verdict: "passive" });
  const account = { verdict: "passive", reason: "", absorbed_J: 3.1, interval95: [2.6, 3.6], lower95_J: 2.7, upper95_J: 3.5, duration_s: 60, mean_power_W: 0.052, mean_power_interval95: [0.043, 0.06], squared_velocity: 0.2,
    shortage: { at_end: -15, at_end_interval95: [-18, -13], largest: -9, largest_interval95: [-14, -5] }, blocks: 30 };
  return {
    result: {
      schema: "mbk.result/1", software: "mbk 0.0.0", inputs: [{ file: "space.csv", sha256: "0".repeat(64), format: "CSV", duration_s: 62, rate_hz: 1000 }],
      mode: "default", protocol: "sinusoidal", method: "ls", axes: 3, structure: "full", units: { M: "kg", B: "N·s/m", K: "N/m", x0: "m", force: "N" },
      model, standard_error: error, fit,
      ellipsoids: Object.fromEntries(Object.entries(found).map(([name, { ellipsoid }]) => [name, ellipsoid])),
      antisymmetry_vectors: { inertia: found.inertia.circulation, stiffness: found.stiffness.circulation },
      alternatives: [other],
      disagreement: { parameter: "k_zz", least_squares: model.K[2][2], iv_less_ls: 0.02 * model.K[2][2], standard_error: 6, significant: false },
      passivity: {
        trial: { verdict: "passive", absorbed_J: 3.1, interval95: [2.6, 3.6], statement: "the limb absorbed 3.1 J in this trial", reason: "" },
        prediction: { verdict: "passive", symmetric: "passive", antisymmetric: "passive", extrapolated: false, statement: "the model absorbs energy in any motion from 0.4 to 6 Hz" },
        band_hz: [0.4, 6], models: [{
          method: "ls", VAF: fit.VAF, usable: true, fits: true, symmetric: "passive", antisymmetric: "passive", published_rule: "passive", band_hz: [0.4, 6], band_rule: "coherence above 0.8", extrapolated: false,
          min_index: 7, min_index_interval95: [4.2, 9.7], min_index_at_hz: 0.4, circular_hz: [0.1, null],
          conditions: [condition("smallest eigenvalue of M", "kg", 0.9), condition("smallest eigenvalue of K", "N/m", 140), condition("√(det B/uᵀB u) − |ω m_a − k_a/ω| at 0.4 Hz", "N·s/m", 9)],
          eop: { corrected: 12, interval95: [11, 13], published_formula: 19, published_formula_interval95: [18, 20] }, index,
        }],
        energy: account,
      },
      warnings: [], usable: true, covariance,
      estimation: { parameters_from: "all", samples: 4100, duration_s: 41, hac_lag_s: 0.3, handle_mass_kg: 0, handle_mass_from: "" },
      excitation: { rank: 9, condition: 12, motion_ratio: 0.71, motion: 0.006, inertia_share: 0.2 },
      preparation: [{ protocol: "sinusoidal", protocol_rule: "the reference is periodic", window_rule: "while the reference is in steady state", from_s: 1, to_s: 61, savitzky_golay: { order: 5, window: 41 }, cutoff_hz: 10, cutoff_rule: "above the excited band",
        every: 10, excited_band_hz: [0.3, 6], force_source: "sensor", acceleration: "derivative", cut_before_filter: false, split_s: 42 }],
    },
    trial: { recordings: [{ metadata: { participant: "P3", condition: "relaxed" } }],
      energy: [{ window_s: [1, 61], account, shortage_largest_at_s: 7, whole_recording_J: 3.2, time_s: [1, 21, 41, 61], absorbed_J: [0, 1.1, 2.2, 3.1], parts_are: "blocks", parts: [{ from_s: 1, to_s: 31, absorbed_J: 1.6, largest_displacement: 0.01, path_length: 0.9, squared_velocity: 0.1, shortage: -15 }] }] },
  };
}

/** A report on one or several of them. */
export function spatialReport(...all) {
  const results = all.map(({ result }) => result);
  return withDiagnostics({ schema: "mbk.report/1", software: "mbk 0.0.0", command: "mbk measure space.csv --axes 3 --report space.html",
    trials: all.map(({ trial }) => structuredClone(trial)),
    result: results.length === 1 ? results[0] : { schema: "mbk.results/1", software: "mbk 0.0.0", results, no_summary: "the recordings are of different conditions" } });
}

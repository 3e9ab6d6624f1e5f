// Diagnostics of round numbers, for reports that hold none of their own or whose edges are to be seen.

const range = (n, low, high) => Array.from({ length: n }, (_, i) => low + ((high - low) * i) / (n - 1));
const powers = (n, low, high) => range(n, Math.log(low), Math.log(high)).map(Math.exp);

/** Put into every trial of a report's document. */
export function withDiagnostics(document) {
  const results = document.result.results ?? [document.result];
  document.trials.forEach((trial, k) => {
    const axes = results[k].axes;
    const each = (make) => Array.from({ length: axes }, (_, axis) => make(axis));
    const time = range(400, 30, 60);
    time[200] = null;
    const gap = (values) => values.map((v, i) => (i === 200 ? null : v));
    const measured = each((axis) => gap(range(400, 0, 60).map((t) => 2 * Math.sin(t + axis))));
    const residual = each((axis) => gap(range(400, 0, 60).map((t) => 0.2 * Math.sin(7 * t * t + axis))));
    const predicted = measured.map((column, axis) => column.map((v, i) => (v === null ? null : v - residual[axis][i])));
    const lag = range(100, 0, 2);
    const frequency = [0, ...powers(200, 0.05, 100)];
    const low = frequency.map((f) => 1 / (1 + (f / 3) ** 8));
    const gains = powers(200, 0.05, 100);
    const whole = range(500, 0, 62);
    trial.diagnostics = {
      prediction: { held_out: true, time_s: time, measured, predicted, residual },
      autocorrelation: { lag_s: lag, value: each((axis) => lag.map((t) => Math.exp(-t / (0.2 + 0.1 * axis)))), white95: 0.06, time_constant_s: each(() => 0.2) },
      spectra: {
        frequency_hz: frequency,
        position: each(() => low.map((v) => 1e-5 * v)),
        force: each(() => low.map((v) => v + 1e-4)),
        residual: each(() => low.map((v) => 0.01 * v)),
        coherence: each((axis) => low.map((v) => (0.95 - 0.1 * axis) * v)),
        coherence_significant: 0.17,
      },
      filters: {
        frequency_hz: gains,
        smoothing: gains.map((f) => 1 / (1 + (f / 5) ** 10)),
        first: gains.map((f) => (2 * Math.PI * f) / (1 + (f / 5) ** 10)),
        second: gains.map((f) => (2 * Math.PI * f) ** 2 / (1 + (f / 5) ** 10)),
        first_ideal: gains.map((f) => 2 * Math.PI * f),
        second_ideal: gains.map((f) => (2 * Math.PI * f) ** 2),
      },
      acceleration: { time_s: time, derivative: measured, sensor: predicted, rms_difference: each(() => 0.2), VAF: each(() => 97) },
      recording: {
        time_s: whole,
        position: each((axis) => whole.map((t) => 0.3 + 0.01 * Math.sin(t + axis))),
        force: each((axis) => whole.map((t) => 2 * Math.sin(t + axis))),
        reference: each(() => []),
      },
    };
  });
  return document;
}

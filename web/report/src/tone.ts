// Muscle tone and reflexes: EMG after perturbations, resistance to stretches at constant velocity.
import type { EmgChannel, EmgEstimate, Exploration, StretchDirection, StretchEstimate, StretchValue, Value } from "@mbk/shared/documents";
import { facts, h, heading, table } from "@mbk/shared/dom";
import { data, fixed, listed, significant, valueWithInterval } from "@mbk/shared/format";
import { type Chart, figure, styleOf } from "./charts";

const known = (value: Value | undefined): number => value ?? NaN;

/** "+" and "−" with one axis; in the plane the angle from x. */
function directionName({ direction }: { direction: Value[] }): string {
  const axes = direction.length;
  if (axes === 1) return known(direction[0]) > 0 ? "+" : "−";
  if (axes === 2) return `${fixed((Math.atan2(known(direction[1]), known(direction[0])) * 180) / Math.PI, 0)}°`;
  return `[${direction.map((one) => fixed(one, 2)).join(", ")}]`;
}

const milliseconds = (seconds: Value | undefined): string => fixed(1000 * known(seconds), 0);

function emgChart(found: EmgEstimate, channel: EmgChannel): Chart {
  return {
    id: `emg-${channel.name}`,
    title: `${channel.name} after the onset`,
    howToRead: "Mean over the perturbations of the rectified and smoothed EMG, relative to the background before the onset, which is 1.",
    description: `${channel.name}: mean EMG over the background against the time after the onset, one line for each direction of the perturbation.`,
    x: { name: "time after the onset", unit: "ms" },
    panels: [{
      title: channel.name,
      unit: "EMG / background",
      series: channel.directions.map((one, k) => ({
        name: `direction ${directionName(one)}`,
        x: found.curve_time_s.map((time) => (time === null ? null : 1000 * time)),
        y: one.curve.map((value) => (value === null ? null : value / known(one.background))),
        style: styleOf(k),
      })),
    }],
  };
}

export function emgSection(found: EmgEstimate): HTMLElement {
  const analysed = found.channels.filter((channel) => channel.usable);
  const rows = analysed.flatMap((channel) => channel.directions.map((one) => [
    channel.name,
    `${directionName(one)} (${one.trials})`,
    one.latency
      ? h("span", {}, data(one.latency.value_s, milliseconds(one.latency.value_s), `latency-${channel.name}`), ` [${milliseconds(one.latency.interval95[0])}, ${milliseconds(one.latency.interval95[1])}]`)
      : one.windows.some(({ response }) => response === "increase") ? "no clear beginning" : "no response",
    ...one.windows.map((window) => h("span", {},
      valueWithInterval(window.ratio, [window.interval95[0] ?? null, window.interval95[1] ?? null], `ratio-${channel.name}`, (value) => fixed(value, 2)),
      window.response === "none" ? "" : h("strong", {}, ` ${window.response}`))),
  ]));
  const findings = found.channels.flatMap((channel) => channel.findings.map((one) => h("li", {}, `${channel.name}: ${one.message}; ${one.try}`)));
  const { processing } = found;
  return h("section", { id: "emg" }, heading(2, "EMG after perturbations"),
    h("p", {}, `${found.onsets} onsets, found in the ${found.onset_rule}, in ${found.directions.length === 1 ? "one direction" : `${found.directions.length} directions`}${found.omitted ? `; ${found.omitted} more were omitted because they were too close to each other or to an end` : ""}.`),
    table("Mean EMG in each window, relative to the background; brackets are 95 % intervals", [
      "muscle", "direction (perturbations)", "latency, ms",
      ...found.windows.map((window) => `${window.name}, ${milliseconds(window.window_s[0])} to ${milliseconds(window.window_s[1])} ms`)], rows, "numbers"),
    ...analysed.map((channel) => figure(emgChart(found, channel))),
    findings.length ? h("div", {}, h("p", {}, h("strong", {}, "Signals")), h("ul", {}, ...findings)) : "",
    facts([
      ["Processing", `${significant(processing.band_hz[0], 3)} to ${significant(processing.band_hz[1], 3)} Hz, rectified; envelope ${processing.envelope_hz ? `low-pass ${significant(processing.envelope_hz, 3)} Hz` : `RMS over ${milliseconds(processing.envelope_rms_s)} ms`}`],
      ["Background", `${milliseconds(found.background_s)} ms before the onset`],
    ]));
}

/** Scale and units of position and torque. */
function unitsOf({ units }: Exploration): { scale: number; angle: string; speed: string; torque: string; slope: string } {
  return units && units.K !== "N/m"
    ? { scale: 180 / Math.PI, angle: "°", speed: "°/s", torque: "N·m", slope: "N·m·s/rad" }
    : { scale: 1000, angle: "mm", speed: "mm/s", torque: "N", slope: "N·s/m" };
}

const shown = (value: StretchValue | undefined | null, name: string, decimals: number, scale = 1): Node | string => {
  if (!value) return "";
  const scaled = (one: Value | undefined): Value => (one === null || one === undefined ? null : scale * one);
  return valueWithInterval(scaled(value.value), value.interval95 ? [scaled(value.interval95[0]), scaled(value.interval95[1])] : [null, null], name, (one) => fixed(one, decimals));
};

const verdicts: Record<StretchDirection["verdict"], string> = {
  "velocity-dependent": "The resistance rises with the speed of the stretch more than a viscosity explains",
  "not-shown": "No resistance that rises with the speed of the stretch was shown",
  "cannot-be-judged": "Whether the resistance depends on speed cannot be judged",
};

function stretchChart(one: StretchDirection, units: ReturnType<typeof unitsOf>, k: number): Chart {
  const x = one.angle.map((angle) => (angle === null ? null : units.scale * angle));
  return {
    id: `stretch-${k}`,
    title: `Resisting torque, position ${one.direction > 0 ? "increasing" : "decreasing"}`,
    howToRead: "Each line is the mean resistance of the stretches at one speed. The slowest line is taken as passive: weight, elasticity and an unknown offset. Only what lies above it at higher speeds depends on speed.",
    description: `Resisting torque against position, one line for each of ${one.speeds.length} speeds.`,
    x: { name: "position", unit: units.angle },
    panels: [{
      title: "resistance",
      unit: units.torque,
      series: one.speeds.map((speed, at) => ({
        name: `${fixed(units.scale * known(speed.speed), 0)} ${units.speed}`,
        x,
        y: one.passive.map((passive, i) => (passive === null ? null : passive + (speed.excess.length ? known(speed.excess[i]) : 0))),
        style: styleOf(at),
      })),
    }],
  };
}

function muscleParts({ muscles }: StretchDirection, units: ReturnType<typeof unitsOf>, k: number): (Node | string)[] {
  if (!muscles.length) return [];
  return [
    table("Onsets of EMG in these stretches; brackets are 95 % intervals", ["muscle", "speed", "stretches with an onset", `position at the onset, ${units.angle}`],
      muscles.flatMap((muscle) => muscle.speeds.map((one, at) => [
        muscle.name, `${fixed(units.scale * known(one.speed), 0)} ${units.speed}`, `${one.onsets} of ${one.stretches}`,
        shown(one.onset_angle, `onset-${k}-${muscle.name}-${at}`, 1, units.scale),
      ])), "numbers"),
    facts(muscles.map((muscle) => [
      `Threshold at rest (λ), ${muscle.name}`,
      !muscle.usable ? `not analysed: ${muscle.reason}`
        : muscle.threshold ? h("span", {}, shown(muscle.threshold, `lambda-${k}-${muscle.name}`, 1, units.scale), ` ${units.angle}; ${muscle.threshold_note}`)
          : `${muscle.speeds.some((one) => one.onsets) ? "not identified" : "no response"}: ${muscle.threshold_note}`,
    ])),
  ];
}

export function stretchSection(found: StretchEstimate, result: Exploration): HTMLElement {
  const units = unitsOf(result);
  const catchText = { found: "", none: "no catch", "cannot-be-judged": "not judged" };
  return h("section", { id: "stretches" }, heading(2, "Stretches at constant velocity"),
    ...found.directions.flatMap((one, k) => [
      h("p", { "data-name": `stretch-verdict-${k}` }, h("strong", {}, `Position ${one.direction > 0 ? "increasing" : "decreasing"}: `), `${verdicts[one.verdict]}: ${one.verdict_reason}.`),
      figure(stretchChart(one, units, k)),
      table(`Stretches over ${fixed(units.scale * known(one.range[0]), 1)} to ${fixed(units.scale * known(one.range[1]), 1)} ${units.angle}; brackets are 95 % intervals`,
        ["speed", "stretches", `mean resistance, ${units.torque}`, `angle of catch, ${units.angle}`, "work of the loop, J"],
        one.speeds.map((speed, at) => [
          `${fixed(units.scale * known(speed.speed), 0)} ${units.speed}`, String(speed.repetitions), shown(speed.mean_torque, `torque-${k}-${at}`, 3),
          at === 0 ? "passive" : speed.catch === "found" ? shown(speed.catch_angle, `catch-${k}-${at}`, 1, units.scale) : catchText[speed.catch],
          shown(speed.work, `work-${k}-${at}`, 3),
        ]), "numbers"),
      facts([
        ["Slope over speed", one.speeds.length > 1 ? h("span", {}, shown(one.slope, `slope-${k}`, 3), ` ${units.slope}`) : undefined],
        ["Intervals rest on", one.interval_basis],
        ["Threshold at rest", one.reflex_threshold ? h("span", {}, shown(one.reflex_threshold, `threshold-${k}`, 1, units.scale), ` ${units.angle}; ${one.threshold_note}`) : `not identified: ${one.threshold_note}`],
      ]),
      ...muscleParts(one, units, k),
    ]),
    h("p", {}, h("strong", {}, "What these data cannot show")),
    h("ul", {}, ...found.limits.map((limit) => h("li", {}, limit))),
    h("p", {}, "This page describes one measurement. It is not a diagnosis."));
}

/** For the summary: one sentence for each result. */
export function toneSentences(result: Exploration): string[] {
  const sentences: string[] = [];
  if (result.emg) {
    const responded = result.emg.channels.filter((channel) => channel.directions.some((one) => one.windows.some((window) => window.response === "increase"))).map((channel) => channel.name);
    sentences.push(responded.length ? `EMG increased after perturbations in ${listed(responded)}.` : "No muscle responded to the perturbations.");
  }
  if (result.stretch?.directions[0]) sentences.push(`${verdicts[result.stretch.directions[0].verdict]}: ${result.stretch.directions[0].verdict_reason}.`);
  return sentences;
}

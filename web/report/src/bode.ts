// The Bode plot of a response with its 95 % bands.
import type { Value } from "@mbk/shared/documents";
import { significant } from "@mbk/shared/format";
import { type Chart, type Panel, type Series, styles } from "./charts";

type Ends = [Value[], Value[]];

/** A response, with one entry of every list for each frequency. */
export interface Curve {
  frequency_hz: Value[];
  magnitude: Value[];
  magnitude_interval95: Ends;
  phase_deg: Value[];
  phase_interval95_deg: Ends;
  real?: Value[];
  real_interval95?: Ends;
}

interface Signal {
  name: string;
  unit: string;
}

/** "N·m" as "N.m" is written in files. */
export const shownUnit = (unit: string): string => unit.replaceAll(".", "·");

/** The unit of the output over that of the input; nothing where one is not known or both are the same. */
export const ratioUnit = ({ input, output }: { input: Signal; output: Signal }): string => {
  const wrapped = /[·./]/.test(input.unit) ? `(${shownUnit(input.unit)})` : input.unit;
  return !input.unit || !output.unit ? "" : input.unit === output.unit ? "" : `${shownUnit(output.unit)}/${wrapped}`;
};

export interface BodeWords {
  id: string;
  title: string;
  unit: string;
  howToRead: string;
  band?: { from: number; to: number; name: string } | undefined;
  /** Name of the response; default "model". */
  name?: string;
  /** Another response at the same frequencies, without bands. */
  beside?: { name: string; magnitude: Value[]; phase_deg: Value[] };
}

const intervalShade = { color: "var(--second)", opacity: 0.28 }; // unlike the excited band's

/** The phase with lines at whole parts of a turn. */
function phasePanel(response: Curve): Pick<Panel, "range" | "interval"> {
  const known = [response.phase_deg, ...response.phase_interval95_deg].flat().filter((v): v is number => v !== null);
  const line = response.phase_deg.filter((v): v is number => v !== null);
  if (line.length === 0) return {};
  const low = Math.max(Math.min(...known), Math.min(...line) - 180);
  const high = Math.min(Math.max(...known), Math.max(...line) + 180);
  const interval = [15, 30, 45, 90, 180, 360].find((one) => (high - low) / one <= 5) ?? 720;
  return { range: [interval * Math.floor(low / interval), interval * Math.max(Math.ceil(high / interval), Math.floor(low / interval) + 1)], interval };
}

const within = (ends: Ends, [low, high]: [number, number]): Ends =>
  ends.map((end) => end.map((v) => (v === null ? null : Math.min(Math.max(v, low), high)))) as Ends;

/** Whole powers of ten around the line, and around its interval where that is no more than ten times as far. */
function decades(response: Curve): [number, number] {
  const known = (values: Value[]): number[] => values.filter((v): v is number => v !== null && v > 0).map(Math.log10);
  const line = known(response.magnitude);
  if (line.length === 0) return [0.1, 1];
  const [least, most] = [Math.min(...line), Math.max(...line)];
  const [low, high] = response.magnitude_interval95.map(known) as [number[], number[]];
  const bottom = Math.floor(Math.max(Math.min(least, ...low), least - 1));
  const top = Math.ceil(Math.min(Math.max(most, ...high), most + 1));
  return [10 ** bottom, 10 ** Math.max(top, bottom + 1)];
}

export function bode(response: Curve, words: BodeWords): Chart {
  const { frequency_hz: x } = response;
  const [from, to] = [x[0] ?? 0, x.at(-1) ?? 0];
  const band = words.band ? { from: Math.max(words.band.from, from), to: Math.min(words.band.to, to), name: words.band.name } : undefined;
  const name = words.name ?? "model";
  const lines = (y: Value[], [low, high]: Ends, beside?: Value[]): Series[] => [
    { name, x, y, style: styles.first, between: { low, high, name: "95 % interval", shade: intervalShade } },
    ...(words.beside && beside ? [{ name: words.beside.name, x, y: beside, style: styles.second }] : []),
  ];
  const range = decades(response);
  const phase = phasePanel(response);
  const panels: Panel[] = [
    { title: "Magnitude", unit: words.unit, log: true, range, ...(band ? { band } : {}), series: lines(response.magnitude, within(response.magnitude_interval95, range), words.beside?.magnitude) },
    { title: "Phase", unit: "°", ...phase, ...(band ? { band } : {}), series: lines(response.phase_deg, within(response.phase_interval95_deg, phase.range ?? [-180, 180]), words.beside?.phase_deg) },
  ];
  if (response.real && response.real_interval95) {
    panels.push({ title: "Real part", unit: words.unit, zero: true, series: lines(response.real, response.real_interval95) });
  }
  return {
    id: words.id,
    title: words.title,
    howToRead: words.howToRead,
    description: `Magnitude from ${significant(response.magnitude[0])} at ${significant(from)} Hz to ${significant(response.magnitude.at(-1))} at ${significant(to)} Hz; phase from ${significant(response.phase_deg[0])} to ${significant(response.phase_deg.at(-1))} degrees.`,
    x: { name: "frequency", unit: "Hz", log: true, range: [from, to] },
    panels,
  };
}

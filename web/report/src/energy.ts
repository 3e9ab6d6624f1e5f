// Energy that the limb absorbed (Dyck 2013, figs. 3.15, 3.17, 4.3 to 4.5).
import type { Energy, EnergyAccount, Value } from "@mbk/shared/documents";
import { h, heading, type HeadingLevel, table } from "@mbk/shared/dom";
import { data, fixed, significant, withInterval } from "@mbk/shared/format";
import { type Trial, unitsOf } from "@mbk/shared/result";
import { type Chart, figure, type Series, styleOf, styles, symbolOf } from "./charts";
import { threeDigits, verdictBadge } from "./passivity";

interface Named {
  name: string;
  energy: Energy;
}

const finite = (values: Value[]): number[] => values.filter((value): value is number => value !== null);
const lastOf = (energy: Energy): Value => finite(energy.absorbed_J).at(-1) ?? null;

const basename = (path: string): string => path.split(/[\\/]/).at(-1) ?? path;

/** The recordings of a trial, each with what distinguishes it. */
const recordingsOf = (trial: Trial): Named[] =>
  (trial.energy ?? []).map((energy, k) => ({ name: basename(trial.result.inputs[k]?.file ?? `recording ${k + 1}`), energy }));

function overTime(all: Named[], id: string): Chart {
  const only = all.length === 1 ? all[0]?.energy : undefined;
  const words = all.map(({ name, energy }) => `${name}: ${significant(lastOf(energy))} J at the end`);
  const curl: Series[] = only?.curl
    ? [{ name: "part due to the antisymmetric stiffness", x: only.time_s, y: only.curl.over_time_J, style: styles.second }]
    : [];
  return {
    id: `${id}-energy-over-time`,
    title: "Energy that the limb absorbed",
    howToRead: "A rise means that the limb absorbs energy from the machine, a fall that it delivers energy. A spring stores energy and returns it, so small waves are normal: a sustained fall is energy that the limb delivered.",
    description: `${words.join("; ")}.`,
    x: { name: "time", unit: "s" },
    panels: [{
      title: "Energy",
      unit: "J",
      zero: true,
      ...(only ? { band: { from: only.window_s[0], to: only.window_s[1], name: "analysed interval" } } : {}),
      series: [
        ...all.map(({ name, energy }, k) => ({ name: only ? "absorbed" : name, x: energy.time_s, y: energy.absorbed_J, style: styleOf(k) })),
        ...curl,
      ],
    }],
  };
}

function perPart(all: Named[], unit: string, id: string): Chart | undefined {
  const drawn = all.filter(({ energy }) => energy.parts.length > 0);
  if (drawn.length === 0) return undefined;
  const each = drawn.every(({ energy }) => energy.parts_are === "perturbations") ? "perturbation" : "block";
  const [scale, shown] = unit === "m" ? [1000, "mm"] : [1, unit];
  const marks = (of: (part: Energy["parts"][number]) => Value): Series[] =>
    drawn.map(({ name, energy }, k) => ({
      name: drawn.length === 1 ? `each ${each}` : name,
      x: energy.parts.map((_, i) => i + 1),
      y: energy.parts.map(of),
      style: styleOf(k),
      marks: symbolOf(k),
    }));
  const most = Math.max(...drawn.map(({ energy }) => energy.parts.length));
  const words = drawn.map(({ energy }) => {
    const absorbed = finite(energy.parts.map((part) => part.absorbed_J));
    return `the limb delivered energy in ${absorbed.filter((value) => value < 0).length} of ${absorbed.length}`;
  });
  return {
    id: `${id}-parts`,
    title: `Energy and displacement of each ${each}`,
    howToRead: `A mark below zero is a ${each} in which the limb delivered energy. Compare with the displacement below: the limb may yield to the same push or push back.`,
    description: `${words.join("; ")}.`,
    x: { name: each, unit: "number", range: [0, most + 1] },
    panels: [
      { title: "Energy absorbed", unit: "J", zero: true, series: marks((part) => part.absorbed_J) },
      { title: "Largest displacement", unit: shown, zero: true, series: marks((part) => (part.largest_displacement === null ? null : scale * part.largest_displacement)) },
    ],
    panelHeight: 130,
  };
}

/** An excess is a shortage with the opposite sign. */
function negated(value: Value, [low, high]: [Value, Value]): [Value, [Value, Value]] {
  const minus = (one: Value): Value => (one === null ? null : -one);
  return [minus(value), [minus(high), minus(low)]];
}

function accountTable(columns: { name: string; key: string; account: EnergyAccount }[], unit: string): HTMLElement {
  const row = (name: string, shown: string, key: string, of: (account: EnergyAccount) => [Value, [Value, Value]]): (Node | string)[] => [
    name,
    ...columns.map((column) => {
      const [value, interval] = of(column.account);
      return h("span", { class: "number" }, withInterval(value, interval, `${column.key}-${key}`, threeDigits(value)), ` ${shown}`);
    }),
  ];
  return table("Energy account; brackets are 95 % intervals", ["", ...columns.map(({ name }) => name)], [
    ["verdict", ...columns.map(({ account }) => verdictBadge(account.verdict))],
    row("absorbed", "J", "absorbed", (a) => [a.absorbed_J, a.interval95]),
    row("mean power", "W", "power", (a) => [a.mean_power_W, a.mean_power_interval95]),
    row("excess of passivity at the end", unit, "excess-end", (a) => negated(a.shortage.at_end, a.shortage.at_end_interval95)),
    row("excess, worst case during the trial", unit, "excess-worst", (a) => negated(a.shortage.largest, a.shortage.largest_interval95)),
    ["intervals based on", ...columns.map(({ account }) => `${account.blocks} parts`)],
  ], "numbers account");
}

export function energySection(trial: Trial, id: string, level: HeadingLevel): HTMLElement | undefined {
  const recordings = recordingsOf(trial);
  const account = trial.result.passivity?.energy;
  if (recordings.length === 0 && !account) return undefined;
  const units = unitsOf(trial.result);
  const rows = recordings.map(({ name, energy }, k) => ({ name, key: `energy${k}`, account: energy.account }));
  if (account && rows.length !== 1) rows.push({ name: "together", key: "energy", account });
  const parts = perPart(recordings, units.x0, id);
  const curl = recordings[0]?.energy.curl;
  return h("section", { id: `${id}-energy` },
    heading(level, "Energy"),
    h("p", {}, "Energy that the limb absorbed from the machine, computed from force and motion without a model."),
    accountTable(rows, units.B),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "The excess of passivity is the damping that could be removed before the limb would have generated energy. A negative excess is a shortage: the damping that would have to be added."),
    ...(recordings.length ? [figure(overTime(recordings, id))] : []),
    parts ? figure(parts) : "",
    curl && recordings.length === 1 && trial.result.usable
      ? h("p", {}, "The antisymmetric stiffness of ", data(curl.k_a, significant(curl.k_a), "curl-k_a"), ` ${units.K} absorbed `, data(curl.absorbed_J, significant(curl.absorbed_J), "curl-absorbed"), " J of it",
        curl.share === null ? "" : [" (", `${fixed(100 * curl.share, 0)} %`, ")"].join(""), ". A spring cannot do this: it is the work of the model's antisymmetric (rotational) stiffness along the path of the hand.")
      : "");
}

/** Several trials in one chart. */
export function energySideBySide(trials: Trial[], nameOf: (trial: Trial) => string): HTMLElement | undefined {
  const all = trials.flatMap((trial) => recordingsOf(trial).map(({ name, energy }, _, own) => ({ name: own.length > 1 ? `${nameOf(trial)}: ${name}` : nameOf(trial), energy })));
  return all.length < 2 ? undefined : figure(overTime(all, `all-${trials.length}`));
}

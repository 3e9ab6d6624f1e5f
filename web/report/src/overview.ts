// Several recordings side by side.
import type { Passivity, Prediction, Value } from "@mbk/shared/documents";
import { h, heading, table } from "@mbk/shared/dom";
import { anyAngle, ellipsesSideBySide } from "@mbk/shared/ellipses";
import { data, decimalsFor, fixed, normal95, significant, withInterval } from "@mbk/shared/format";
import { axisNames, matrices, type Trial, unitsOf } from "@mbk/shared/result";
import { conditionOf, fileOf, participantOf, type Report } from "./data";
import { ellipsoidsOfSeveral } from "./ellipsoids";
import { energySideBySide } from "./energy";
import { verdictBadge } from "./passivity";
import { saveable } from "./picture";
import { ellipsesCsv } from "./sections";
import { verdict } from "./summary";
import { methodNames } from "./words";

/** "P1, relaxed (log_3.mat)": participant and condition, and the file. */
export function nameOf(trial: Trial, all: Trial[]): string {
  const said = [participantOf(trial), conditionOf(trial)].filter(Boolean).join(", ");
  const file = filesOf(all).get(trial) ?? fileOf(trial);
  return said ? `${said} (${file})` : file;
}

const known = new WeakMap<Trial[], Map<Trial, string>>();

/** File name of each, with as many parent folders as needed to distinguish it from the others. */
function filesOf(all: Trial[]): Map<Trial, string> {
  const found = known.get(all);
  if (found) return found;
  const names = new Map<Trial, string>();
  known.set(all, names);
  const folders = 8; // beyond these it is the same file
  const end = (trial: Trial, parts: number) => (trial.name ? [trial.name] : trial.result.inputs.map(({ file }) => file)).map((file) => file.split(/[\\/]/).slice(-parts).join("/")).join(", ");
  for (let parts = 1; parts <= folders && names.size < all.length; ++parts) {
    const left = all.filter((trial) => !names.has(trial));
    const count = new Map<string, number>();
    for (const trial of left) count.set(end(trial, parts), (count.get(end(trial, parts)) ?? 0) + 1);
    for (const trial of left) if (parts === folders || count.get(end(trial, parts)) === 1) names.set(trial, end(trial, parts === folders ? 1 : parts));
  }
  return names;
}

/** Sorted by participant, condition and file; results of a comparison in the order given. */
export function inOrder(trials: Trial[]): { trial: Trial; id: string }[] {
  const key = (trial: Trial) => trial.name ? [] : [participantOf(trial) ?? "", conditionOf(trial) ?? "", fileOf(trial)];
  const compare = new Intl.Collator("en", { numeric: true }).compare;
  return trials
    .map((trial, k) => ({ trial, id: `trial-${k + 1}` }))
    .sort((a, b) => {
      const [first, second] = [key(a.trial), key(b.trial)];
      return first.map((word, k) => compare(word, second[k] ?? "")).find((order) => order !== 0) ?? 0;
    });
}

/** Rows of a matrix under each other, each value with its half width; no more digits than fit side by side. */
function matrix(values: Value[][], halves: Value[][], name: string): HTMLElement {
  const largest = Math.max(...values.flat().map((value) => Math.abs(value ?? 0)));
  const most = largest > 0 ? Math.max(3 - Math.floor(Math.log10(largest)), 0) : 0;
  return h("div", { class: values.length > 2 ? "matrix large" : "matrix", style: `grid-template-columns: repeat(${values.length}, auto)` },
    ...values.flatMap((row, j) => row.map((value, i) => {
      const half = halves[j]?.[i] ?? null;
      const decimals = Math.min(decimalsFor(half), most);
      return h("span", { class: "number" }, data(value, half === null ? significant(value) : fixed(value, decimals), `${name}${j}${i}`),
        half === null ? "" : h("span", { class: "half" }, ` ± ${fixed(half, decimals)}`));
    })));
}

const scaled = (values: Value[][], factor: number): Value[][] => values.map((row) => row.map((value) => (value === null ? null : factor * value)));

/** What happened in the trial, and what its model predicts. */
function verdicts(passivity: Passivity | undefined): HTMLElement[] {
  if (!passivity) return [];
  const badge = (what: string, verdict: Prediction): HTMLElement => h("span", { "data-statement": what }, `${what} `, verdictBadge(verdict));
  return [badge("trial", passivity.trial?.verdict ?? "none"), badge("prediction", passivity.prediction.verdict)];
}

export function overviewSection(report: Report): HTMLElement {
  const { trials, summary, noSummary, failed } = report;
  const rows = inOrder(trials);
  const first = trials[0] as Trial;
  const sameUnits = trials.every((trial) => unitsOf(trial.result).M === unitsOf(first.result).M);
  const unit = (trial: Trial, symbol: "M" | "B" | "K") => (sameUnits ? "" : ` ${unitsOf(trial.result)[symbol]}`);
  const told = [
    { name: "participant", of: participantOf },
    { name: "condition", of: conditionOf },
  ].filter(({ of }) => trials.some((trial) => of(trial) !== undefined));
  const judged = trials.some((trial) => trial.result.passivity);
  const head = ["recording", ...told.map(({ name }) => name), judged ? "usable; trial, prediction" : "usable", ...matrices.map(({ symbol, title }) => `${title} ${symbol}${sameUnits ? ` [${unitsOf(first.result)[symbol]}]` : ""}`), "VAF [%]"];
  const body: (Node | string)[][] = rows.map(({ trial, id }) => {
    const { result } = trial;
    const said = verdict(trial);
    return [
      h("a", { href: `#${id}` }, filesOf(trials).get(trial) ?? fileOf(trial)),
      ...told.map(({ of }) => of(trial) ?? "–"),
      h("div", { class: "badges" },
        h("span", { class: `badge ${said.kind}` }, `${said.sign} ${result.usable ? (said.kind === "care" ? "with care" : "usable") : "not usable"}`),
        ...verdicts(result.passivity)),
      ...matrices.map(({ symbol }) => result.usable ? h("div", {}, matrix(result.model[symbol], scaled(result.standard_error[symbol], normal95), symbol), unit(trial, symbol)) : "–"),
      h("div", {}, ...result.fit.VAF.map((vaf, axis) =>
        h("div", { class: "number" }, result.axes === 1 ? "" : `${axisNames(result.axes)[axis]} `, data(vaf, fixed(vaf, 1), `VAF${axis}`)))),
    ];
  });
  if (summary) {
    const all = summary.trials + summary.omitted.length;
    body.push([`mean of ${summary.trials}${summary.omitted.length > 0 ? ` of ${all}` : ""}, by ${methodNames[summary.method]}`, ...told.map(() => ""), "", ...matrices.map(({ symbol }) => matrix(summary.model[symbol], summary.half_width95[symbol], `mean-${symbol}`)), ""]);
  }
  const two = trials.some((trial) => trial.result.ellipses && trial.result.usable);
  const ellipseRows: (Node | string)[][] = rows.filter(({ trial }) => trial.result.ellipses && trial.result.usable).map(({ trial }) => [
    nameOf(trial, trials),
    ...matrices.flatMap(({ name }) => {
      const e = trial.result.ellipses?.[name];
      if (!e) return ["", "", ""];
      return [
        e.area === null ? "none" : data(e.area, significant(e.area), `${name}-area`),
        e.shape === null ? "none" : data(e.shape, fixed(e.shape, 2), `${name}-shape`),
        anyAngle(e.interval95.orientation_deg) ? "any" : withInterval(e.orientation_deg, e.interval95.orientation_deg, `${name}-orientation`, 0),
      ];
    }),
  ]);
  const names = axisNames(first.result.axes);
  const order = names.length > 1 ? ` Each matrix is shown as ${names.map((row) => names.map((column) => row + column).join(", ")).join(" above ")}.` : "";
  return h(
    "section",
    { id: "overview" },
    heading(2, "Comparison of recordings"),
    table("Model of each recording, by participant and condition", head, body, "numbers overview"),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), `± is half of the 95 % interval: for a recording, from its own data; for the mean, from the differences between recordings.${order}`),
    noSummary ? h("p", { "data-name": "no-summary" }, h("strong", {}, "No mean: "), `${noSummary}.`) : "",
    ...(summary?.omitted ?? []).map(({ file, why }) => h("p", { "data-name": "omitted" }, h("strong", {}, "Not in the mean: "), `${file}: ${why}.`)),
    ...failed.map(({ file, message, try: what }) => h("p", { "data-name": "failed" }, h("strong", {}, first.name ? "Omitted: " : "Not measured: "), `${file}: ${message}; ${what}.`)),
    two ? table("Ellipses: area in the square of the matrix's unit, shape, orientation in degrees with its 95 % interval", ["recording", ...matrices.flatMap(({ symbol }) => [`${symbol} area`, `${symbol} shape`, `${symbol} angle`])], ellipseRows, "numbers overview") : "",
    ...ellipsoidsOfSeveral(rows.map(({ trial }) => trial), (trial) => nameOf(trial, trials)),
    energySideBySide(rows.map(({ trial }) => trial), (trial) => nameOf(trial, trials)),
    saveable(ellipsesSideBySide(rows.map(({ trial }) => trial), (trial) => nameOf(trial, trials)), {
      name: "ellipses-side-by-side", title: "Ellipses side by side", csv: () => ellipsesCsv(rows.map(({ trial }) => ({ name: nameOf(trial, trials), trial }))),
    }),
  );
}

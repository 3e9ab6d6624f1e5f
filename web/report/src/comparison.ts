// How far results are from the first of them: a document of schema mbk.compare_report/1. Every number in it was computed by mbk.
import type { Comparison, ComparisonReport, Interval, Value, Width } from "@mbk/shared/documents";
import { h, heading, table } from "@mbk/shared/dom";
import { data, fixed, significant } from "@mbk/shared/format";
import { matrices, methodNames, type Trial } from "@mbk/shared/result";
import { csvOf } from "@mbk/shared/sheet";
import type { Report } from "./data";
import { nameOf } from "./overview";
import { saveable } from "./picture";
import { forest, type ForestRow } from "./study_drawings";

const between = (value: Value, [low, high]: Interval, name: string): HTMLElement =>
  h("span", { class: "number" }, data(value, significant(value, 3), name), low === null || high === null ? "" : h("span", { class: "half" }, ` [${significant(low, 3)}, ${significant(high, 3)}]`));

/** "× 2.1 [1.8, 2.5] at 107°" */
function times(width: Width, k: number, name: string): (Node | string)[] {
  const one = width.second_to_first[k];
  if (!one) return [];
  return ["×\u00a0", between(one.ratio, one.interval95, name), one.direction_deg === undefined ? "" : ` at ${fixed(one.direction_deg, 0)}°`];
}

function row(name: string, matrix: string, comparison: Comparison, of: keyof Comparison["width"]): (Node | string)[] {
  const width = comparison.width[of];
  if (!width) return [name, matrix, h("span", { "data-name": "refused" }, `none: ${comparison.refused[of] ?? "undefined"}`), "", "", ""];
  const several = width.second_to_first.length > 1;
  return [name, matrix, between(width.distance, width.interval95, `width-${of}`),
    h("span", {}, ...times(width, 0, `least-${of}`)), several ? h("span", {}, ...times(width, width.second_to_first.length - 1, `most-${of}`)) : "",
    h("span", {}, width.distinguishable ? h("strong", {}, "differs") : "no detectable difference", width.surely_positive ? "" : "; the interval is unreliable: an eigenvalue may be zero")];
}

const shortened = (name: string): string => (name.length > 20 ? `${name.slice(0, 12)}…${name.slice(-7)}` : name);

/** How many times the first each is, along the directions in which that is least and most. */
function ratiosDrawing(report: Report, comparisons: Comparison[]): HTMLElement | undefined {
  const rows = matrices.flatMap(({ symbol, name }) => comparisons.flatMap((comparison, k): ForestRow[] => {
    const width = comparison.width[name];
    const trial = report.trials[k + 1];
    if (!width || !trial) return [];
    const ends = [[""], ["least", "most"], ["least", "middle", "most"]][width.second_to_first.length - 1] ?? [];
    return width.second_to_first.map(({ ratio, interval95: [low, high] }, i) => ({
      name: [comparisons.length > 1 ? shortened(nameOf(trial, report.trials)) : "", symbol, ends[i]].filter(Boolean).join(", "),
      value: ratio, low, high, text: `× ${significant(ratio, 3)}${low === null || high === null ? "" : ` [${significant(low, 3)}, ${significant(high, 3)}]`}`,
    }));
  }));
  if (rows.length === 0) return undefined;
  const title = "Ratio to the first result";
  return saveable(h("figure", { "aria-label": title },
    forest(`${title}: ${rows.map(({ name, text }) => `${name} ${text}`).join("; ")}`, "ratio to the first", rows, 1),
    h("figcaption", {}, h("strong", {}, "How to read this. "), "A ratio of 1 means no change. Squares are the minimum and maximum over all directions, lines their 95 % intervals.")), {
    name: "ratios",
    title,
    csv: () => csvOf(["result", "matrix", "ratio", "low", "high", "direction [°]"], comparisons.flatMap((comparison, k) => matrices.flatMap(({ symbol, name }) =>
      (comparison.width[name]?.second_to_first ?? []).map(({ ratio, interval95: [low, high], direction_deg }) => [nameOf(report.trials[k + 1] ?? report.trials[0]!, report.trials), symbol, ratio, low, high, direction_deg])))),
  });
}

export function comparisonSection(report: Report, { comparisons }: ComparisonReport): HTMLElement {
  const [first] = report.trials;
  const named = (trial: Trial) => `${nameOf(trial, report.trials)}, by ${methodNames[trial.result.method]}`;
  const shown = comparisons.flatMap((comparison, k) => {
    const other = report.trials[k + 1];
    if (!first?.result.usable || !other?.result.usable) return [];
    return matrices.map(({ symbol, name, title }) => row(named(other), `${title} ${symbol}`, comparison, name));
  });
  const left = report.trials.filter(({ result }) => !result.usable);
  return h("section", { id: "comparison" },
    heading(2, "Differences"),
    first ? h("p", {}, "Each result is compared with the first: ", h("strong", {}, named(first)), ".") : "",
    shown.length > 0 ? table("Width and ratio to the first result; brackets are 95 % intervals", ["result", "", "width", "ratio, minimum", "ratio, maximum", ""], shown, "numbers widths") : "",
    ...left.map((trial) => h("p", { "data-name": "not-compared" }, h("strong", {}, "Not compared: "), `${nameOf(trial, report.trials)} is not usable${trial === first ? ", so nothing can be compared with it" : ""}.`)),
    shown.length > 0 && left.length === 0 ? ratiosDrawing(report, comparisons) : "",
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "The width √(Σ ln² λ) over the eigenvalues λ of Z₁⁻¹Z₂ is 0 if both are equal, and 2.75 if the second is seven times the first in every direction. Noise alone gives a width above 0: the symmetric parts differ significantly (95 %) only if the last column shows “differs”."));
}

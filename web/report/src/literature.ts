// Values from the literature beside those of this recording (literature.json).
import { h, table } from "@mbk/shared/dom";
import { significant } from "@mbk/shared/format";
import { matrices, type MatrixName, type Trial, unitsOf } from "@mbk/shared/result";
import literature from "./literature.json";

type Span = [number, number];
const spanOf = (values: number[]): Span => [Math.min(...values), Math.max(...values)];

/** "92 to 171"; one number where both are the same. */
const between = ([low, high]: Span): string => (low === high ? significant(low, 2) : `${significant(low, 2)} to ${significant(high, 2)}`);

interface Printed {
  short: string;
  source: string;
  conditions: string;
  people: number;
  /** From the smallest to the largest of the people, of the maximum and of the minimum over all directions. */
  of: Record<MatrixName, { maximum: Span; minimum: Span }>;
}

const planarHand: Printed[] = literature.planar_hand.map(({ short, source, conditions, people }) => {
  const rows = Object.values(people);
  const axes = (k: number) => ({
    maximum: spanOf(rows.map((row) => Math.sqrt(((row[k] ?? 0) * (row[k + 1] ?? 0)) / Math.PI))),
    minimum: spanOf(rows.map((row) => Math.sqrt((row[k] ?? 0) / (Math.PI * (row[k + 1] ?? 1))))),
  });
  return { short, source, conditions, people: rows.length, of: { M: axes(0), B: axes(2), K: axes(4) } };
});

/** What is comparable with the trial: hands that moved in a plane. */
const beside = (trial: Trial): Printed[] => (trial.result.axes === 2 && unitsOf(trial.result).K === "N/m" ? planarHand : []);

/** Below the number of a card. */
export function literatureLine(trial: Trial, symbol: MatrixName): HTMLElement | undefined {
  const [first] = beside(trial);
  if (!first) return undefined;
  return h("p", { class: "beside", title: `${first.source}: ${first.conditions}` }, `Relaxed arms, ${first.people} people: ${between(first.of[symbol].maximum)} ${unitsOf(trial.result)[symbol]} `, h("span", { class: "half" }, `(${first.short})`));
}

export function literatureTable(trial: Trial): HTMLElement | undefined {
  const all = beside(trial);
  const { ellipses, usable } = trial.result;
  if (all.length === 0 || !ellipses || !usable) return undefined;
  const units = unitsOf(trial.result);
  const rows = matrices.flatMap(({ symbol, name }) => (["maximum", "minimum"] as const).map((which) => [
    `${name} ${symbol}, ${which}`,
    h("span", { class: "number" }, significant(ellipses[name].eigenvalues[which === "maximum" ? 1 : 0], 3)),
    ...all.map(({ of }) => between(of[symbol][which])),
    units[symbol],
  ]));
  return h("div", { class: "literature" },
    table("Values from the literature: minimum and maximum over all directions, range over the participants", ["", "this recording", ...all.map(({ short, people }) => `${short}, ${people} people`), "unit"], rows, "numbers"),
    h("ul", { class: "reading" }, ...all.map(({ source, conditions }) => h("li", {}, h("strong", {}, `${source}. `), `Conditions: ${conditions}.`))),
    h("p", { class: "reading" }, "Another task, posture or perturbation gives different values; gripping and muscle tension raise them. These are not normative values."));
}

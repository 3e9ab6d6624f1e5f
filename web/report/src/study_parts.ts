// What the page of a study and that of one of its people share.
import type { Analysis, Course, ListedRecording, OutcomeCourses, ParticipantReport, SessionChange, SessionMatrix, StudyReport } from "@mbk/shared/documents";
import { h, table } from "@mbk/shared/dom";
import { niceBelow } from "@mbk/shared/ellipses";
import { listed, plain } from "@mbk/shared/format";
import { download } from "@mbk/shared/sheet";
import { conditionName, inOutcomeOrder, isMain, outcomeName, withUnit } from "./outcomes";
import { saveable } from "./picture";
import { ellipseLegend, ellipsePanel, largestOf } from "./study_drawings";

export const counted = (n: number, one: string, more: string): string => `${n} ${n === 1 ? one : more}`;

/** "mbk 0.1.0, --cutoff 5" */
export function analysisText(analysis: Analysis | null): string {
  if (!analysis) return "nothing was measured";
  const options = Object.entries(analysis.options).map(([name, values]) => (values.length > 0 ? values.map((value) => `${name} ${value}`).join(" ") : name));
  return `analysis ${analysis.number}: mbk ${analysis.version}, ${options.length > 0 ? options.join(" ") : "default options"}`;
}

export const verdictWords: Record<SessionChange["verdict"], { text: string; kind: string }> = {
  "beyond-error": { text: "more than measurement error", kind: "care-text" },
  uncertain: { text: "more than the MDC, which is uncertain", kind: "" },
  "within-error": { text: "no detectable change", kind: "" },
  unknown: { text: "not known", kind: "" },
};

const stateWords: Record<ListedRecording["state"], string> = {
  usable: "usable",
  "not-usable": "not usable",
  failed: "could not be measured",
  "not-measured": "not measured",
  excluded: "excluded",
};

const hasRaters = (recordings: ListedRecording[]): boolean => recordings.some(({ rater }) => rater);

/** Recordings of which no number counts, each with its reason. */
export function leftOutTable(recordings: ListedRecording[], withParticipant: boolean): HTMLElement {
  const left = recordings.filter(({ state }) => state !== "usable");
  if (left.length === 0) return h("p", {}, "Every recording has a usable result and is included.");
  const raters = hasRaters(left);
  const participant = (one: ListedRecording) => (withParticipant ? [String(one.participant)] : []);
  return table(`${counted(left.length, "recording is omitted", "recordings are omitted")}`,
    ["recording", ...(withParticipant ? ["participant"] : []), "session", "condition", ...(raters ? ["rater"] : []), "trial", "state", "reason"],
    left.map((one) => [String(one.number), ...participant(one), String(one.session), one.condition || "–", ...(raters ? [one.rater || "–"] : []), String(one.trial), stateWords[one.state], one.reason || "–"]), "left-out");
}

export function recordingsTable(recordings: ListedRecording[]): HTMLElement {
  const raters = hasRaters(recordings);
  return table("Every recording", ["recording", "participant", "session", "condition", ...(raters ? ["rater"] : []), "trial", "length [s]", "state"],
    recordings.map((one) => [String(one.number), String(one.participant), String(one.session), one.condition || "–", ...(raters ? [one.rater || "–"] : []), String(one.trial), plain(one.duration_s, 4), stateWords[one.state]]), "values");
}

/** RFC 4180; what a spreadsheet would take for a formula begins with an apostrophe. */
function field(value: string | number | null | undefined): string {
  if (value === null || value === undefined) return "";
  if (typeof value === "number") return String(value);
  const text = /^[=+\-@\t\r]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
export const csvOf = (head: string[], rows: (string | number | null | undefined)[][]): string => `${[head, ...rows].map((row) => row.map(field).join(",")).join("\n")}\n`;

/** One row per number of each usable result, as `mbk study export` writes it. */
function resultsCsv({ recordings, outcomes = [], results = [] }: StudyReport | ParticipantReport): string {
  const by = new Map(recordings.map((one) => [one.number, one]));
  const raters = hasRaters(recordings);
  return csvOf(["participant", "session", "condition", ...(raters ? ["rater"] : []), "trial", "recording", "outcome", "value", "standard_error", "unit"],
    results.flatMap(({ recording, values, standard_errors }) => {
      const one = by.get(recording);
      if (!one) return [];
      return outcomes.flatMap(({ name, unit }, k) => {
        const value = values[k] ?? null;
        return value === null ? [] : [[one.participant, one.session, one.condition, ...(raters ? [one.rater ?? ""] : []), one.trial, one.number, name, value, standard_errors[k] ?? null, unit]];
      });
    }));
}

export function coursesCsv(courses: OutcomeCourses[]): string {
  return csvOf(["participant", "condition", "outcome", "unit", "session", "results", "mean", "difference_from_first", "mdc95", "mdc95_low", "mdc95_high", "verdict"],
    courses.flatMap(({ condition, outcome, unit, participants }) => participants.flatMap(({ participant, sessions, changes }) => sessions.map(({ session, results, mean }) => {
      const change = changes.find(({ last_session }) => last_session === session);
      return [participant, condition, outcome, unit, session, results, mean, change?.difference, change?.mdc95, change?.mdc95_interval[0], change?.mdc95_interval[1], change?.verdict];
    }))));
}

const button = (text: string, act: () => void): HTMLButtonElement => {
  const made = h("button", { type: "button" }, text);
  made.addEventListener("click", act);
  return made;
};

export function downloads(report: StudyReport | ParticipantReport, name: string): HTMLElement {
  return h("div", { class: "tools" },
    report.results ? button("Save results (CSV)", () => download(`${name}_results.csv`, resultsCsv(report))) : "",
    button("Save sessions and changes (CSV)", () => download(`${name}_sessions.csv`, coursesCsv(report.courses))),
    button("Save everything (JSON)", () => download(`${name}.json`, `${JSON.stringify(report, null, 1)}\n`)),
    report.results ? "" : h("span", { class: "reading" }, "The study has too many results for this page; mbk study export writes them."));
}

export const conditionsOf = (courses: OutcomeCourses[]): string[] => [...new Set(courses.map(({ condition }) => condition))];
export const sessionsOf = (courses: Course[]): number[] => [...new Set(courses.flatMap(({ sessions }) => sessions.map(({ session }) => session)))].sort((a, b) => a - b);
export const mainOutcomes = (courses: OutcomeCourses[]): string[] =>
  inOutcomeOrder([...new Set(courses.map(({ outcome }) => outcome))], (name) => name).filter(isMain);

/** What is drawn again for each outcome that is chosen; `outcome` first. On paper only the chosen one. */
export function chooser(courses: OutcomeCourses[], outcome: string, draw: (chosen: OutcomeCourses[]) => HTMLElement): HTMLElement {
  const names = inOutcomeOrder([...new Set(courses.map((one) => one.outcome))], (name) => name);
  const place = h("div", {});
  const show = (name: string) => {
    const chosen = courses.filter((one) => one.outcome === name);
    const { unit = "" } = chosen[0] ?? {};
    place.replaceChildren(h("p", { class: "panel-title chosen" }, unit ? `${outcomeName(name)} [${unit}]` : outcomeName(name)), draw(chosen));
  };
  const select = h("select", { "aria-label": "Outcome" }, ...names.map((name) => h("option", { value: name, selected: name === outcome }, outcomeName(name))));
  select.addEventListener("change", () => show(select.value));
  show(outcome);
  return h("div", { class: "chooser" }, h("div", { class: "tools" }, h("label", {}, "Outcome ", select)), place);
}

const matrixNames = { K: "stiffness K", B: "damping B", M: "inertia M" } as const;

/** Ellipses of a matrix: one panel for each person and condition. */
export function ellipseFigure(matrices: SessionMatrix[], matrix: keyof typeof matrixNames, nameOf: (participant: number, condition: string) => string): HTMLElement | undefined {
  const all = matrices.filter((one) => one.matrix === matrix);
  const first = all[0];
  if (!first) return undefined;
  const largest = largestOf(all);
  const reference = niceBelow(0.8 * largest);
  const panels = new Map<string, SessionMatrix[]>();
  for (const one of all) {
    const key = JSON.stringify([one.participant, one.condition]);
    panels.set(key, [...(panels.get(key) ?? []), one]);
  }
  return saveable(h("figure", { class: "people-ellipses" },
    h("p", { class: "panel-title" }, matrixNames[matrix]),
    ellipseLegend(Math.max(...[...panels.values()].map(({ length }) => length)), `equal in all directions, ${withUnit(plain(reference), first.unit)}`),
    h("div", { class: "small-panels" }, ...[...panels.values()].map((sessions) => {
      const { participant, condition } = sessions[0] as SessionMatrix;
      const name = nameOf(participant, condition);
      return h("div", { class: "small-panel" }, ellipsePanel(`${name}: ${matrixNames[matrix]}`, sessions, largest, reference),
        h("p", { class: "panel-name" }, name), h("p", { class: "panel-note" }, `session${sessions.length === 1 ? "" : "s"} ${listed(sessions.map(({ session }) => String(session)))}`));
    }))), {
    name: `ellipses_${matrix}`,
    title: `Ellipses of ${matrixNames[matrix]}`,
    csv: () => csvOf(["participant", "condition", "session", "results", "matrix", "unit", "xx", "xy", "yy"],
      all.map(({ participant, condition, session, results, unit, symmetric }) => [participant, condition, session, results, matrix, unit, ...symmetric])),
  });
}

/** Means with their intervals, of each person and of all. */
export function meansCsv(courses: OutcomeCourses[]): string {
  return csvOf(["condition", "outcome", "unit", "participant", "mean", "low95", "high95"],
    courses.flatMap(({ condition, outcome, unit, participants, mean, interval95 }) => [
      ...participants.map((one) => [condition, outcome, unit, one.participant, one.mean, one.interval95[0], one.interval95[1]]),
      [condition, outcome, unit, "all", mean, interval95[0], interval95[1]],
    ]));
}

export const titleOf = (title: string): string => title || "A study";
export const ofCondition = (condition: string, all: string[]): string => (all.length > 1 || condition ? conditionName(condition) : "");

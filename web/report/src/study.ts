// The page of a study: a document of schema mbk.study_report/1, drawn. Every number in it was computed by mbk.
import type { Course, OutcomeCourses, StudyReport, Value } from "@mbk/shared/documents";
import { facts, h, heading, table } from "@mbk/shared/dom";
import { data, fixed } from "@mbk/shared/format";
import { among, conditionName, inOutcomeOrder, isFirst, isMain, outcomeName, percentOf, plainly, signed, withUnit } from "./outcomes";
import { saveable } from "./picture";
import { commonRange, courseLegend, coursePanel, forest, type ForestRow } from "./study_drawings";
import { analysisText, chooser, conditionsOf, counted, coursesCsv, csvOf, downloads, ellipseFigure, leftOutTable, meansCsv, ofCondition, recordingsTable, sessionsOf, titleOf } from "./study_parts";

type Summary = StudyReport["summary"];
type Reliability = Summary["reliability"][number];
type Comparison = NonNullable<Summary["comparison"]>["outcomes"][number];

export function studyHead({ summary, note }: StudyReport): HTMLElement {
  const { counts } = summary;
  document.title = `${titleOf(summary.title)} – study`;
  const left = [`${counts.usable} usable`, ...([["not_usable", "not usable"], ["failed", "could not be measured"], ["not_measured", "not measured"], ["excluded", "excluded"]] as const)
    .flatMap(([key, words]) => (counts[key] > 0 ? [`${counts[key]} ${words}`] : []))];
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, "Study"),
    h("h1", { class: "study-title" }, titleOf(summary.title)),
    note ? h("p", { class: "note" }, note) : "",
    facts([
      ["Participants", String(counts.participants)],
      ["Recordings", `${counts.recordings}: ${left.join(", ")}`],
      ["Measured by", analysisText(summary.analysis)],
    ]));
}

const range = (low: Value, high: Value, decimals: number): string => (low === null || high === null ? "" : ` [${fixed(low, decimals)}, ${fixed(high, decimals)}]`);

/** "0.87 [0.61, 0.97]" */
const iccText = (value: Value, [low, high]: [Value, Value]): HTMLElement =>
  h("span", { class: "number" }, data(value, fixed(value, 2), "icc"), h("span", { class: "half" }, range(low, high, 2)));

const sized = (value: Value, [low, high]: [Value, Value], name: string): HTMLElement =>
  h("span", { class: "number" }, data(value, plainly(value), name), h("span", { class: "half" }, low === null || high === null ? "" : ` [${among(low, value)}, ${among(high, value)}]`));

const icc = (one: Reliability) => one.between_sessions.icc.find(({ form, averaged }) => form === "agreement" && averaged === 1);
const error = (one: Reliability) => one.between_sessions.error.find(({ form }) => form === "agreement");

/** Why it is not reported. */
function lack({ repeated_participants, between_sessions }: Reliability): string {
  if (between_sessions.support === "too few people") return `too few people: ${repeated_participants} with two sessions or more`;
  return between_sessions.support;
}

function meanOf(courses: OutcomeCourses[], condition: string, outcome: string): HTMLElement | string {
  const one = courses.find((c) => c.condition === condition && c.outcome === outcome);
  return one ? sized(one.mean, one.interval95 as [Value, Value], "mean") : "–";
}

function summarySection(report: StudyReport, conditions: string[]): HTMLElement {
  const { summary, primary, courses } = report;
  const cards = conditions.flatMap((condition) => {
    const course = courses.find((one) => one.condition === condition && one.outcome === primary);
    const one = summary.reliability.find((r) => r.condition === condition && r.outcome === primary);
    if (!course) return [];
    const [agreement, sem] = one ? [icc(one), error(one)] : [];
    const share = sem && sem.mdc95 !== null && course.mean ? ` (${fixed((100 * sem.mdc95) / Math.abs(course.mean), 0)} % of the mean)` : "";
    return [h("div", { class: "card", "data-condition": condition },
      h("p", { class: "card-title" }, h("strong", {}, ofCondition(condition, conditions) || "All recordings"), h("span", {}, outcomeName(primary))),
      h("p", { class: "headline" }, data(course.mean, withUnit(plainly(course.mean), course.unit), "mean")),
      h("p", {}, `Mean of ${counted(course.participants.length, "participant", "participants")}`, course.interval95[0] === null ? "" : `, 95 % interval ${among(course.interval95[0] ?? null, course.mean)} to ${among(course.interval95[1] ?? null, course.mean)}`, "."),
      h("p", {}, "Between sessions: ", agreement ? h("span", {}, "ICC(A,1) ", iccText(agreement.value, agreement.interval95 as [Value, Value])) : `no reliability stated, ${one ? lack(one) : "nothing was measured"}`, "."),
      h("p", {}, "Minimal detectable change: ", sem ? h("span", {}, data(sem.mdc95, withUnit(plainly(sem.mdc95), course.unit), "mdc"), share) : "not known", "."))];
  });
  const nothing = summary.counts.recordings === 0 ? "The study has no recordings yet." : summary.counts.usable === 0 ? "No recording has a usable, included result: there is nothing to summarise." : "";
  return h("section", { id: "summary" }, heading(2, "Summary"),
    nothing ? h("p", { class: "said" }, nothing) : h("div", { class: "cards" }, ...cards),
    ...(summary.notes ?? []).map((note) => h("p", { class: "note", "data-name": "note" }, sentence(note))));
}

const sentence = (text: string): string => `${text.charAt(0).toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`;

/** What must be known beside the numbers; many are folded, but not on paper. */
function noteList(notes: HTMLElement[]): HTMLElement | "" {
  if (notes.length === 0) return "";
  const list = h("ul", { class: "notes" }, ...notes);
  return notes.length < 5 ? list : h("details", { class: "notes-block", "data-print": true }, h("summary", {}, `${notes.length} notes on these numbers`), list);
}

/** Which outcomes are shown at once. */
const firstOf = ({ courses }: StudyReport) => (courses.some(({ outcome }) => isFirst(outcome)) ? isFirst : isMain);

function reliabilityTable(report: StudyReport, condition: string, conditions: string[], main: boolean): HTMLElement | undefined {
  const all = inOutcomeOrder(report.summary.reliability.filter((one) => one.condition === condition && firstOf(report)(one.outcome) === main), ({ outcome }) => outcome);
  if (all.length === 0) return undefined;
  const rows = all.map((one) => {
    const [agreement, sem] = [icc(one), error(one)];
    const model = one.mixed_model.of_trials[0];
    return [
      one.unit ? `${outcomeName(one.outcome)} [${one.unit}]` : outcomeName(one.outcome),
      agreement ? `${one.between_sessions.participants} × ${one.between_sessions.sessions.length}` : `${one.participants}`,
      meanOf(report.courses, condition, one.outcome),
      agreement ? iccText(agreement.value, agreement.interval95 as [Value, Value]) : lack(one),
      sem ? sized(sem.sem, sem.sem95 as [Value, Value], "sem") : "–",
      sem ? sized(sem.mdc95, sem.mdc95_interval as [Value, Value], "mdc") : "–",
      model && one.mixed_model.support === "enough" ? iccText(model.icc, model.icc95 as [Value, Value]) : "–",
    ];
  });
  const name = ofCondition(condition, conditions);
  return table(name || "Between sessions", ["outcome", "people × sessions", "mean", "ICC(A,1)", "SEM", "MDC (95 %)", "ICC, mixed model"], rows, "numbers reliability");
}

/** Of one trial by any one rater; nothing where no rater is recorded. */
function ratersTable(report: StudyReport, condition: string, conditions: string[]): HTMLElement | undefined {
  const all = inOutcomeOrder(report.summary.reliability.filter((one) => one.condition === condition && one.raters && firstOf(report)(one.outcome)), ({ outcome }) => outcome);
  if (all.length === 0) return undefined;
  const name = ofCondition(condition, conditions);
  return table(`${name ? `${name}: ` : ""}one trial by one rater in one session`, ["outcome", "people × raters", "Φ", "G", "SEM, any rater", "MDC, any rater", "MDC, same rater"],
    all.map(({ outcome, unit, raters }) => {
      const one = raters?.of_numbers[0];
      const label = unit ? `${outcomeName(outcome)} [${unit}]` : outcomeName(outcome);
      if (!one) return [label, `${raters?.participants} × ${raters?.raters}`, raters?.support ?? "", "–", "–", "–", "–"];
      return [label, `${raters?.participants} × ${raters?.raters}`, iccText(one.absolute, one.absolute95 as [Value, Value]), iccText(one.relative, one.relative95 as [Value, Value]),
        sized(one.absolute_error.sem, one.absolute_error.sem95 as [Value, Value], "rater-sem"), sized(one.absolute_error.mdc95, one.absolute_error.mdc95_interval as [Value, Value], "rater-mdc"),
        sized(one.same_raters.mdc95, one.same_raters.mdc95_interval as [Value, Value], "same-rater-mdc")];
    }), "numbers reliability raters");
}

function ratersSection(report: StudyReport, conditions: string[]): HTMLElement | undefined {
  const tables = conditions.flatMap((condition) => ratersTable(report, condition, conditions) ?? []);
  if (tables.length === 0) return undefined;
  return h("section", { id: "raters" }, heading(2, "Raters"), ...tables,
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "Φ: dependability, the share of the variance that is due to differences between people, if any rater measures; G: if the same raters measure everybody and only differences between people matter. SEM and MDC are those of one trial. “Same rater”: between two sessions by the same rater; undefined if the study has no sessions apart from raters. All by restricted maximum likelihood; brackets are 95 % intervals. The other tables take results of different raters as trials."));
}

function reliabilitySection(report: StudyReport, conditions: string[]): HTMLElement | undefined {
  const tables = conditions.flatMap((condition) => reliabilityTable(report, condition, conditions, true) ?? []);
  const others = conditions.flatMap((condition) => reliabilityTable(report, condition, conditions, false) ?? []);
  const said = (first: boolean) => inOutcomeOrder(report.summary.reliability.filter(({ outcome }) => firstOf(report)(outcome) === first), ({ outcome }) => outcome)
    .flatMap(({ outcome, condition, notes }) => notes.map((note) => h("li", {}, `${[outcomeName(outcome), ofCondition(condition, conditions)].filter(Boolean).join(", ")}: ${note.replace(/(^|[ [(])-(?=[\d.])/g, "$1−")}${/[.]$/.test(note) ? "" : "."}`)));
  const [notes, more] = [said(true), said(false)];
  if (tables.length === 0) return undefined;
  return h("section", { id: "reliability" }, heading(2, "Reliability"), ...tables,
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "ICC(A,1): share of the variance between single sessions that is due to differences between people; a change common to all people counts as error; 1 is perfect. SEM: standard error of measurement, the standard deviation of one person’s sessions (agreement). MDC: minimal detectable change, 1.96 √2 SEM; a smaller difference between two sessions may be measurement error. Brackets are 95 % intervals, for ICC(A,1) after McGraw and Wong; an ICC below 0 counts as 0. Intervals of SEM and MDC allow for errors with a kurtosis up to 6 (normal: 3); heavier tails are noted. All these use session means of people with all compared sessions; the mixed model uses every trial and refers to single trials."),
    noteList(notes),
    others.length > 0 ? h("details", { class: "data-table" }, h("summary", {}, "Other outcomes"), ...others, noteList(more)) : "");
}

/** Enough decimals to distinguish people. */
function spreadOf(courses: Course[]): Value {
  const means = courses.map(({ mean }) => mean).filter((v): v is number => v !== null);
  if (means.length < 2) return means[0] === undefined ? null : Math.abs(means[0]) / 10;
  return means.reduce((a, b) => Math.max(a, b)) - means.reduce((a, b) => Math.min(a, b)) || Math.abs(means[0] ?? 0) / 10;
}

const intervalText = ([low, high]: Value[], spread: Value): string => (low === null || low === undefined || high === null || high === undefined ? "" : ` [${among(low, spread)}, ${among(high, spread)}]`);

function peopleForest(one: OutcomeCourses, conditions: string[]): HTMLElement {
  const spread = spreadOf(one.participants);
  const rows: ForestRow[] = one.participants.map(({ participant, mean, interval95 }) => ({
    name: `participant ${participant}`, value: mean, low: interval95[0] ?? null, high: interval95[1] ?? null, text: `${among(mean, spread)}${intervalText(interval95, spread)}` }));
  if (one.participants.length > 1) {
    rows.push({ name: "mean of all", value: one.mean, low: one.interval95[0] ?? null, high: one.interval95[1] ?? null, text: `${among(one.mean, spread)}${intervalText(one.interval95, spread)}`, whole: true });
  }
  const name = ofCondition(one.condition, conditions);
  const axis = one.unit ? `${outcomeName(one.outcome)} [${one.unit}]` : outcomeName(one.outcome);
  return h("div", { class: "forest-block" }, name ? h("p", { class: "panel-title" }, name) : "",
    forest(`${axis}${name ? `, ${name}` : ""}: ${rows.map(({ name: who, text }) => `${who} ${text}`).join("; ")}`, axis, rows),
    one.why_unknown ? h("p", { class: "reading" }, `No intervals for single participants: ${one.why_unknown}.`) : "");
}

function participantsSection({ courses, primary }: StudyReport, conditions: string[]): HTMLElement {
  return h("section", { id: "participants" }, heading(2, "Participants"),
    saveable(h("figure", {}, chooser(courses, primary, (chosen) => h("div", {}, ...chosen.map((one) => peopleForest(one, conditions)))),
      h("figcaption", {}, h("strong", {}, "How to read this. "), "Each square is the mean of one person’s sessions. Its line is the 95 % interval from the variances of the study between sessions and between trials, assumed equal for all people. The diamond is the mean of all people with its 95 % interval.")), { name: "participants", title: "Participants", csv: () => meansCsv(courses) }));
}

function coursesSection({ courses, primary }: StudyReport, conditions: string[]): HTMLElement | undefined {
  if (!courses.some(({ participants }) => participants.some(({ sessions }) => sessions.length > 1))) return undefined;
  const drawn = (one: OutcomeCourses) => {
    const several = one.participants.filter(({ sessions }) => sessions.length > 1);
    const range_ = commonRange(several);
    const all = sessionsOf(several);
    const alone = one.participants.length - several.length;
    const name = ofCondition(one.condition, conditions);
    return h("div", { class: "courses-block" }, name ? h("p", { class: "panel-title" }, name) : "",
      h("div", { class: "small-panels wide" }, ...several.map((course) => {
        const change = course.changes.at(-1);
        const size = change ? percentOf(change, one) || withUnit(signed(change.difference), one.unit) : "";
        return h("div", { class: "small-panel", "data-participant": course.participant, "data-verdict": change?.verdict },
          h("p", { class: "panel-name" }, `participant ${course.participant}`), coursePanel(one, course, range_, all, "small"),
          h("p", { class: "panel-note" }, change ? `${size} since session ${change.first_session}${change.verdict === "beyond-error" ? ": more than error" : change.verdict === "uncertain" ? ": uncertain" : change.why_not_comparable ? `: not comparable (${change.why_not_comparable})` : ""}` : ""));
      })),
      alone > 0 ? h("p", { class: "reading" }, `${counted(alone, "participant has", "participants have")} only one session and ${alone === 1 ? "is" : "are"} not drawn.`) : "",
      one.why_unknown ? h("p", { class: "reading", "data-name": "mdc-unknown" }, `The minimal detectable change is not known: ${one.why_unknown}. No difference here can be distinguished from measurement error.`) : "");
  };
  return h("section", { id: "sessions" }, heading(2, "Each participant over the sessions"),
    saveable(h("figure", {}, chooser(courses, primary, (chosen) => h("div", {}, courseLegend(chosen), ...chosen.map(drawn))),
      h("figcaption", {}, h("strong", {}, "How to read this. "), "Horizontal: sessions; vertical: outcome, on the same scale for all. The band is the minimal detectable change around the first session: a person who did not change stays within it (95 %). It is computed from the variances of the mixed model and this person’s number of trials; for an outlying participant, from the variances of all others. For each session, 5 % of the people who did not change leave the band by chance. If most people changed between sessions, this change widens the band.")), { name: "sessions", title: "Each participant over the sessions", csv: () => coursesCsv(courses) }));
}

function ellipsesSection({ matrices }: StudyReport, conditions: string[]): HTMLElement | undefined {
  const name = (participant: number, condition: string) => [`participant ${participant}`, ofCondition(condition, conditions)].filter(Boolean).join(", ");
  const [first, ...more] = (["K", "B", "M"] as const).flatMap((matrix) => ellipseFigure(matrices, matrix, name) ?? []);
  if (!first) return undefined;
  return h("section", { id: "ellipses" }, heading(2, "Ellipses"), first,
    ...(more.length > 0 ? [h("details", { class: "data-table" }, h("summary", {}, "Damping and inertia"), ...more)] : []),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "Each ellipse is of the mean matrix of a session, all at the same scale. The longer it is in a direction, the more force it takes to move the hand that way."));
}

const differenceWords: Record<Comparison["verdict"], string> = { differs: "differs", "not shown": "no detectable difference", "too few people": "too few people", "no variation": "no variation" };

function differencesTable(name: string, tests: number, all: Comparison[]): HTMLElement {
  return table(`${name}; p by Student’s t, corrected for ${tests} tests (Holm)`, ["outcome", "people", "difference", "p", "p corrected", "p by permutation", "verdict"],
    all.map((one) => [one.unit ? `${outcomeName(one.outcome)} [${one.unit}]` : outcomeName(one.outcome),
      one.pairing === "paired" ? `${one.first_participants} paired` : `${one.first_participants}, ${one.second_participants}`,
      one.interval95 ? sized(one.difference, one.interval95 as [Value, Value], "difference") : plainly(one.difference),
      pText(one.p), pText(one.p_holm), pText(one.permutation.p), differenceWords[one.verdict]]), "numbers comparison");
}

const pText = (value: Value): string => (value === null ? "–" : value < 0.001 ? "< 0.001" : fixed(value, 3));

function comparisonSection({ summary }: StudyReport): HTMLElement | undefined {
  const { comparison } = summary;
  if (!comparison) return undefined;
  const blocks = new Map<string, Comparison[]>();
  for (const one of comparison.outcomes) {
    const key = [one.condition ? `${one.condition}: ` : "", `${conditionName(one.second)} against ${conditionName(one.first)}`].join("");
    blocks.set(key, [...(blocks.get(key) ?? []), one]);
  }
  return h("section", { id: "comparison" }, heading(2, `Differences between ${comparison.by}s`), ...[...blocks].map(([name, all]) => {
    const ordered = inOutcomeOrder(all, ({ outcome }) => outcome);
    const drawn = ordered.filter(({ effect, outcome }) => effect && isMain(outcome));
    return h("div", {}, h("p", { class: "panel-title" }, name),
      drawn.length > 0 ? saveable(h("figure", { "aria-label": name }, forest(`Effect sizes of ${name}: ${drawn.map((one) => `${outcomeName(one.outcome)} ${fixed(one.effect?.g ?? null, 2)}`).join("; ")}`, "standardised difference g (Hedges)",
        drawn.map((one) => ({ name: shortName(one.outcome), value: one.effect?.g ?? null, low: one.effect?.interval95[0] ?? null, high: one.effect?.interval95[1] ?? null,
          text: `${fixed(one.effect?.g ?? null, 2)}${range(one.effect?.interval95[0] ?? null, one.effect?.interval95[1] ?? null, 2)}` })), 0)), {
        name: "differences",
        title: `Standardised differences, ${name}`,
        csv: () => csvOf(["outcome", "first", "second", "g", "low95", "high95"], drawn.map((one) => [one.outcome, one.first, one.second, one.effect?.g, one.effect?.interval95[0], one.effect?.interval95[1]])),
      }) : "",
      differencesTable(name, comparison.tests, ordered.filter(({ outcome }) => isMain(outcome))),
      ordered.some(({ outcome }) => !isMain(outcome))
        ? h("details", { class: "data-table" }, h("summary", {}, "Other outcomes"), differencesTable(name, comparison.tests, ordered.filter(({ outcome }) => !isMain(outcome)))) : "");
  }), h("p", { class: "reading" }, "“No detectable difference” does not prove that there is none."));
}

const shortName = (outcome: string): string => outcomeName(outcome).replace(" of the ellipse", "");

function limitsSection(): HTMLElement {
  return h("section", { id: "limits" }, heading(2, "Limitations"),
    h("ul", { class: "limits" },
      h("li", {}, "Reliability and minimal detectable change apply to these people, this apparatus and these sessions only."),
      h("li", {}, "A change that exceeds measurement error need not matter clinically, and its cause is not known."),
      h("li", {}, "Results that are not usable and excluded recordings are omitted; they are listed below with the reasons.")));
}

export function studySections(report: StudyReport): HTMLElement[] {
  const conditions = conditionsOf(report.courses);
  const drawn = report.courses.length > 0;
  const sections = [
    summarySection(report, conditions),
    drawn && reliabilitySection(report, conditions),
    drawn && ratersSection(report, conditions),
    comparisonSection(report),
    drawn && participantsSection(report, conditions),
    drawn && coursesSection(report, conditions),
    ellipsesSection(report, conditions),
    limitsSection(),
    h("section", { id: "left-out" }, heading(2, "Omitted recordings"), report.recordings.length > 0 ? leftOutTable(report.recordings, true) : h("p", {}, "There are no recordings.")),
    h("section", { id: "data" }, heading(2, "Data"), downloads(report, "study"),
      report.recordings.length > 0 ? h("details", { class: "data-table" }, h("summary", {}, "Every recording"), recordingsTable(report.recordings)) : ""),
  ];
  return sections.filter((section): section is HTMLElement => section instanceof HTMLElement);
}

export const studyGlossary: [string, string][] = [
  ["ICC", "intraclass correlation: the share of the total variance that is due to differences between people. Near 1, one measurement distinguishes people; near 0, it does not"],
  ["SEM", "standard error of measurement: the standard deviation of one person’s repeated measurements"],
  ["MDC", "minimal detectable change: 95 % of people who did not change differ by less than this between two measurements"],
  ["Ellipse", "for each direction, how strongly the hand resists being moved that way. Area: overall size; shape: major over minor axis; orientation: angle of the major axis, counter-clockwise from x"],
  ["Usable", "mbk found no problem that rules out using the result"],
];

// The page of one participant, which a clinician reads in a minute. Whether a change is more than measurement error was
// decided by mbk, in the report; here it is said in words, and never more than that.
import type { OutcomeCourses, ParticipantReport, SessionChange } from "@mbk/shared/documents";
import { facts, h, heading, table } from "@mbk/shared/dom";
import { data } from "@mbk/shared/format";
import { among, inOutcomeOrder, isFirst, isMain, outcomeName, percentOf, plainly, signed, withUnit } from "./outcomes";
import { controlsSection, sidesSection } from "./controls";
import { saveable } from "./picture";
import { commonRange, courseLegend, coursePanel } from "./study_drawings";
import { analysisText, conditionsOf, counted, coursesCsv, downloads, ellipseFigure, leftOutTable, ofCondition, sessionsOf, titleOf, verdictWords } from "./study_parts";

export function participantHead(report: ParticipantReport): HTMLElement {
  document.title = `Participant ${report.participant} – ${titleOf(report.title)}`;
  return h("header", { class: "page-head" },
    h("p", { class: "kicker study-title" }, titleOf(report.title)),
    h("h1", {}, `Participant ${report.participant}`),
    report.note ? h("p", { class: "note" }, report.note) : "");
}

const lastOf = ({ participants }: OutcomeCourses): SessionChange | undefined => participants[0]?.changes.at(-1);

/** Both numbers so that what matters of their difference can be seen. */
function pair({ first, last, difference, mdc95 }: SessionChange): [string, string] {
  const size = Math.max(Math.abs(difference ?? 0), mdc95 ?? 0);
  return [among(first, size), among(last, size)];
}
const moved = ({ difference, mdc95 }: SessionChange): string => signed(difference, Math.max(Math.abs(difference ?? 0), mdc95 ?? 0));

const claimed = (one: OutcomeCourses): boolean => ["beyond-error", "uncertain"].includes(lastOf(one)?.verdict ?? "");

/** Outcomes that the page looks at under a condition: all that describe the limb. */
const lookedAt = (courses: OutcomeCourses[], condition: string): OutcomeCourses[] =>
  inOutcomeOrder(courses.filter((one) => one.condition === condition && isMain(one.outcome)), ({ outcome }) => outcome);

/** What else changed, so that one outcome that did not hides no other that did. */
function othersThatChanged(primary: OutcomeCourses, courses: OutcomeCourses[]): HTMLElement[] {
  const others = lookedAt(courses, primary.condition).filter((one) => one.outcome !== primary.outcome);
  const sentence = (verdict: SessionChange["verdict"], words: string) => {
    const changed = others.filter((one) => lastOf(one)?.verdict === verdict);
    if (changed.length === 0) return [];
    const names = changed.slice(0, 6).map((one) => {
      const change = lastOf(one) as SessionChange;
      return `${outcomeName(one.outcome)} (${percentOf(change, one) || withUnit(moved(change), one.unit)})`;
    });
    const more = changed.length > names.length ? ` and ${changed.length - names.length} more` : "";
    return [h("p", { class: "others", "data-verdict": verdict }, `${counted(changed.length, "other outcome", "other outcomes")} of ${others.length} changed by ${words}: ${names.join(", ")}${more}.`)];
  };
  return [...sentence("beyond-error", "more than measurement error explains"), ...sentence("uncertain", "more than the minimal detectable change, which is itself uncertain")];
}

/** The last session beside the one before. */
function latestText(change: SessionChange, one: OutcomeCourses): string {
  const words: Record<SessionChange["verdict"], string> = {
    "beyond-error": "more than measurement error explains", uncertain: "more than the minimal detectable change, which is itself uncertain",
    "within-error": "no detectable change", unknown: "whether that is more than measurement error is not known" };
  if (change.why_not_comparable) return `Session ${change.first_session}, the one before, is not comparable: ${change.why_not_comparable}.`;
  return `Since session ${change.first_session}, the one before: ${withUnit(moved(change), one.unit)}; ${words[change.verdict]}${change.mdc95 === null ? "" : ` (minimal detectable change ${withUnit(plainly(change.mdc95), one.unit)})`}.`;
}

/** What happened between the first session and the last, and whether that is more than error. */
function statement(one: OutcomeCourses, courses: OutcomeCourses[], conditions: string[]): HTMLElement {
  const course = one.participants[0];
  const change = lastOf(one);
  const condition = ofCondition(one.condition, conditions);
  const name = outcomeName(one.outcome);
  const lead = condition ? h("span", { class: "condition" }, condition) : "";
  if (!course || !change) {
    const session = course?.sessions[0];
    return h("div", { class: "statement", "data-verdict": "none" }, lead,
      h("p", { class: "said" }, `Only one session${session ? ` (${session.session})` : ""} has a usable result: nothing can be compared yet.`),
      session ? h("p", {}, `${name}: `, data(session.mean, withUnit(plainly(session.mean), one.unit), "only"), ".") : "");
  }
  const [first, last] = pair(change);
  const size = percentOf(change, one);
  const higher = (change.difference ?? 0) > 0;
  const movement = one.axial
    ? `turned by ${withUnit(plainly(Math.abs(change.difference ?? 0)), one.unit)}`
    : `is ${size ? `${size.replace(/^[+−]/, "")} ` : ""}${higher ? "higher" : "lower"} than in session ${change.first_session}`;
  const same = change.difference === 0;
  const latest = course.latest ? [h("p", { "data-name": "latest", "data-verdict": course.latest.verdict }, latestText(course.latest, one))] : [];
  const mdc = withUnit(plainly(change.mdc95), one.unit);
  const [low, high] = change.mdc95_interval.map((value) => among(value, change.mdc95)) as [string, string];
  const whose = change.by_others ? "; from all other people of the study" : "";
  const verdicts: Record<SessionChange["verdict"], [string, string]> = {
    "beyond-error": [
      `In session ${change.last_session} the ${name} ${movement}: more than measurement error explains.`,
      `The minimal detectable change is ${mdc} (95 % interval ${low} to ${high}${whose}).`],
    uncertain: [
      `In session ${change.last_session} the ${name} ${movement}. It is not certain that this is more than measurement error.`,
      `It is more than the minimal detectable change of ${mdc}, but that value is only known to lie between ${low} and ${high} (95 %${whose}).`],
    "within-error": [
      `Between session ${change.first_session} and session ${change.last_session} there is no detectable change in the ${name}.`,
      `The difference does not exceed the minimal detectable change of ${mdc} (95 % interval ${low} to ${high}), so it may be measurement error. This does not prove that nothing changed.`],
    unknown: change.why_not_comparable ? [
      `The ${name} of session ${change.last_session} is not comparable with that of session ${change.first_session}.`,
      `The stretches differ: ${change.why_not_comparable}.`] : [
      same ? `In session ${change.last_session} the ${name} is the same as in session ${change.first_session}.`
        : `In session ${change.last_session} the ${name} ${movement}. Whether that is more than measurement error is not known.`,
      `The minimal detectable change is not known: ${one.why_unknown ?? "the difference is undefined"}.`],
  };
  const [said, why] = verdicts[change.verdict];
  const tails = change.heavy_tails ? " Measurement errors in this study have heavier tails than a normal distribution (some sessions are outliers), so the interval of the minimal detectable change is not valid and no change is certain." : "";
  return h("div", { class: "statement", "data-verdict": change.verdict, "data-condition": one.condition }, lead,
    h("p", { class: "said" }, said),
    ...othersThatChanged(one, courses),
    ...latest,
    h("p", {}, `Session ${change.first_session}: `, data(change.first, withUnit(first, one.unit), "first"), `; session ${change.last_session}: `, data(change.last, withUnit(last, one.unit), "last"),
      "; difference ", data(change.difference, withUnit(moved(change), one.unit), "difference"), size ? ` (${size})` : "", ". ", why, tails));
}

function courseFigures(primary: OutcomeCourses[], conditions: string[]): HTMLElement {
  const all = sessionsOf(primary.flatMap(({ participants }) => participants));
  return saveable(h("figure", { class: "courses" },
    courseLegend(primary),
    h("div", { class: "large-panels" }, ...primary.map((one) => {
      const course = one.participants[0];
      if (!course) return "";
      return h("div", {}, h("p", { class: "panel-title" }, [ofCondition(one.condition, conditions), one.unit ? `${outcomeName(one.outcome)} [${one.unit}]` : outcomeName(one.outcome)].filter(Boolean).join(": ")),
        coursePanel(one, course, commonRange([course]), all, "large"));
    }))), { name: "sessions_first_outcome", title: "Change since the first session", csv: () => coursesCsv(primary) });
}

function changesTable(courses: OutcomeCourses[], condition: string, conditions: string[]): HTMLElement | undefined {
  const first = courses.some(({ outcome }) => isFirst(outcome)) ? isFirst : isMain;
  const rows = lookedAt(courses, condition).filter((one) => first(one.outcome) || claimed(one))
    .flatMap((one) => {
      const change = lastOf(one);
      if (!change) return [];
      const [first, last] = pair(change);
      const said = verdictWords[change.verdict];
      return [[one.unit ? `${outcomeName(one.outcome)} [${one.unit}]` : outcomeName(one.outcome), data(change.first, first), data(change.last, last),
        h("span", { class: "number" }, data(change.difference, moved(change)), h("span", { class: "half" }, percentOf(change, one) ? ` (${percentOf(change, one)})` : "")),
        change.mdc95 === null ? "not known" : h("span", { class: "number" }, data(change.mdc95, plainly(change.mdc95)), h("span", { class: "half" }, ` [${among(change.mdc95_interval[0] ?? null, change.mdc95)}, ${among(change.mdc95_interval[1] ?? null, change.mdc95)}]`)),
        h("span", { class: said.kind }, change.why_not_comparable ? `not comparable: ${change.why_not_comparable}` : said.text)]];
    });
  if (rows.length === 0) return undefined;
  const change = courses.filter((one) => one.condition === condition).map(lastOf).find((one) => one !== undefined) as SessionChange;
  const name = ofCondition(condition, conditions);
  return table(`${name ? `${name}: ` : ""}first and last session; MDC: minimal detectable change with its 95 % interval`, ["outcome", `session\u00a0${change.first_session}`, `session\u00a0${change.last_session}`, "change", "MDC", "verdict"], rows, "changes");
}

function limits(report: ParticipantReport, shown: number): HTMLElement {
  const known = report.courses.filter(({ why_unknown }) => !why_unknown);
  return h("section", { id: "limits" }, heading(2, "Limitations"),
    h("ul", { class: "limits" },
      h("li", {}, "This page does not show whether a change is good or bad, what caused it, or whether it matters to the person. It is not a diagnosis, and mbk is not a medical device."),
      h("li", {}, "“No detectable change” does not mean that nothing changed: a change below the minimal detectable change cannot be seen."),
      ...(report.controls || report.stretches.length > 0 ? [
        h("li", {}, "Being outside the range of the controls is not a disorder, and being inside it excludes none. The range assumes normally distributed values; it applies to people like these controls, with this apparatus and procedure. Of many values, some are outside by chance."),
        h("li", {}, "Resistance to a stretch does not show its cause: a reflex, voluntary contraction and stiff tissue can look alike. It is not a clinical score such as the Modified Ashworth Scale."),
        h("li", {}, "Resistance, work and catch at the fastest speed are compared with results whose fastest speed differs by at most 10 % and whose positions are the same by at least 80 %; slope, rise and threshold with results over the same positions at any speeds. The minimal detectable change is from results that are comparable with the last session.")] : []),
      shown > 1 ? h("li", {}, `Of people who did not change at all, 5 % differ by more than the minimal detectable change in any one outcome. This page shows ${shown}; a single one that stands out is not significant.`) : "",
      known.length > 0
        ? h("li", {}, `The minimal detectable change is from this study: from ${counted(Math.max(...known.map(({ repeated_participants }) => repeated_participants)), "person", "people")} with two sessions or more with this apparatus. An outlying participant is judged by the variances of all others. If most people really changed, it is too large; it does not apply to other people or another apparatus.`)
        : h("li", {}, "The minimal detectable change is not known, so no difference on this page can be distinguished from measurement error.")));
}

export function participantSections(report: ParticipantReport): HTMLElement[] {
  const conditions = conditionsOf(report.courses);
  const primary = report.courses.filter(({ outcome }) => outcome === report.primary);
  const tables = conditions.flatMap((condition) => changesTable(report.courses, condition, conditions) ?? []);
  const shown = conditions.reduce((sum, condition) => sum + lookedAt(report.courses, condition).filter(lastOf).length, 0);
  const usable = report.recordings.filter(({ state }) => state === "usable").length;
  const ellipses = ellipseFigure(report.matrices, "K", (_, condition) => ofCondition(condition, conditions) || "stiffness");
  const before = [controlsSection(report), sidesSection(report)].filter((one): one is HTMLElement => one !== undefined);
  return [
    ...before,
    h("section", { id: "change" }, heading(2, "Change since the first session"),
      ...(primary.length > 0 ? primary.map((one) => statement(one, report.courses, conditions)) : [h("p", { class: "said" }, report.courses.length > 0 ? `This participant has no result for the ${outcomeName(report.primary)}.` : "This participant has no usable result.")]),
      primary.some(lastOf) ? courseFigures(primary.filter(lastOf), conditions) : ""),
    limits(report, shown),
    ...(tables.length > 0 ? [h("section", { id: "outcomes" }, heading(2, "All outcomes"), ...tables)] : []),
    ...(ellipses ? [h("section", { id: "ellipses" }, heading(2, "Stiffness in all directions"), ellipses,
      h("p", { class: "reading" }, "The longer the ellipse in a direction, the more force it takes to move the hand that way."))] : []),
    h("section", { id: "recordings" }, heading(2, "Recordings and analysis"),
      facts([["Recordings", `${report.recordings.length}, of which ${usable} usable`], ["Sessions", [...new Set(report.recordings.map(({ session }) => session))].sort((a, b) => a - b).join(", ")],
        ["Study", counted(report.study_participants, "participant", "participants")], ["Measured by", analysisText(report.analysis)]]),
      leftOutTable(report.recordings, false),
      downloads(report, `participant_${report.participant}`)),
  ];
}

// Turns the document in the page into the report.
import apache from "echarts/LICENSE?raw";
import apacheNotice from "echarts/NOTICE?raw";
import d3 from "echarts/licenses/LICENSE-d3?raw";
import tslib from "tslib/CopyrightNotice.txt?raw";
import zrender from "zrender/LICENSE?raw";
import type { ComparisonReport, ExplorationReport, ParticipantReport, StudyReport, TransferFunctionReport } from "@mbk/shared/documents";
import { facts, h, heading, type HeadingLevel } from "@mbk/shared/dom";
import type { Trial } from "@mbk/shared/result";
import { followPageAndPrinter } from "./charts";
import { comparisonSection } from "./comparison";
import { conditionOf, fileOf, metadataOf, participantOf, readComparison, readReport, type Report } from "./data";
import { diagnosticElements } from "./diagnostics";
import { ellipsoidsSection } from "./ellipsoids";
import { energySection } from "./energy";
import { explorationHead, explorationSections } from "./exploration";
import { forceFieldSection } from "./force_field";
import { methodsSection } from "./methods";
import { inOrder, nameOf, overviewSection } from "./overview";
import { participantHead, participantSections } from "./participant";
import { passivityDetails, passivitySection } from "./passivity";
import { ellipsesSection, modelSection, provenanceSection, recordingSection, simulatedNote } from "./sections";
import { studyGlossary, studyHead, studySections } from "./study";
import { summarySection, verdict, warningsSection } from "./summary";
import { transferFunctionHead, transferFunctionSections } from "./transfer_function";
import { explorationGlossary, glossaryOf, transferFunctionGlossary } from "./words";
import "./style.css";

function trialSections(trial: Trial, id: string, level: HeadingLevel): HTMLElement[] {
  const sections = [
    summarySection(trial, id, level),
    warningsSection(trial, id, level),
    recordingSection(trial, id, level),
    passivitySection(trial, id, level),
    modelSection(trial, id, level),
    ellipsesSection(trial, id, level),
    ellipsoidsSection(trial, id, level),
    forceFieldSection(trial, id, level),
    methodsSection(trial, id, level),
    passivityDetails(trial, id, level),
    energySection(trial, id, level),
    ...diagnosticElements(trial, id, level),
    provenanceSection(trial, id, level),
  ];
  return sections.filter((section): section is HTMLElement => section !== undefined);
}

function recordingsSection(report: Report): HTMLElement {
  return h("section", { id: "recordings" },
    heading(2, "Each recording"),
    ...inOrder(report.trials).map(({ trial, id }) => {
      const said = verdict(trial);
      const details = h("details", { class: "trial", id, "data-print": true },
        h("summary", {}, h("h3", {}, nameOf(trial, report.trials)), h("span", { class: `badge ${said.kind}` }, `${said.sign} ${said.word}`)),
        ...trialSections(trial, id, 4));
      return details;
    }));
}

function contents(sections: HTMLElement[], trials: Trial[] = []): HTMLElement {
  const several = trials.length > 1;
  const entries = sections.filter((section) => section.id).flatMap((section) => {
    const entry = { id: section.id, name: section.querySelector("h2")?.textContent ?? "", inner: false };
    if (!several || section.id !== "recordings") return [entry];
    return [entry, ...inOrder(trials).map(({ trial, id }) => ({ id, name: nameOf(trial, trials), inner: true }))];
  });
  return h("nav", { "aria-label": "Contents" }, h("details", { open: matchMedia("(min-width: 78rem)").matches }, h("summary", { class: "nav-title" }, "Contents"),
    h("ul", {}, ...entries.map(({ id, name, inner }) => h("li", inner ? { class: "inner" } : {}, h("a", { href: `#${id}` }, name))))));
}

/** A link to a recording opens it. */
function openTargets(): void {
  const open = () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const details = target?.closest<HTMLDetailsElement>("details.trial");
    if (details) details.open = true;
  };
  addEventListener("hashchange", open);
  open();
}

function head(report: Report, named?: string): HTMLElement {
  const first = report.trials[0] as Trial;
  const several = report.trials.length > 1;
  const participant = participantOf(first);
  const said = [participant && `Participant ${participant}`, conditionOf(first)].filter(Boolean).join(", ");
  const title = named ?? (several ? `${report.trials.length} recordings` : said || fileOf(first));
  const beside = several ? "" : [said && !named ? fileOf(first) : "", metadataOf(first, "date"), metadataOf(first, "posture")].filter(Boolean).join(", ");
  document.title = `${title} – mechanical impedance`;
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, first.result.axes === 1 ? "Mechanical impedance of a limb" : "Mechanical impedance of the arm"),
    h("h1", {}, title),
    beside ? h("p", { class: "note beside" }, beside) : "",
    report.note ? h("p", { class: "note" }, report.note) : "",
    simulatedNote(report.trials));
}

function foot(): HTMLElement {
  return h("footer", {},
    h("details", { class: "licences" }, h("summary", {}, "Software inside this file, and its licences"),
      h("p", {}, "This page draws with Apache ECharts, zrender and tslib."),
      ...[["Apache ECharts: notice", apacheNotice], ["Apache ECharts: licence", apache], ["d3, parts of which are in ECharts", d3], ["zrender", zrender], ["tslib", tslib]].map(([name, text]) =>
        h("div", {}, h("p", {}, h("strong", {}, name)), h("pre", { tabindex: 0, role: "group", "aria-label": name }, text)))));
}

const reproduceSection = (command: string, software: string): HTMLElement =>
  h("section", { id: "reproduce" }, heading(2, "How to reproduce this"),
    h("p", {}, "The same files, options and version give exactly the same numbers and the same page."),
    h("pre", { class: "command" }, command),
    h("p", {}, "Made with ", h("strong", {}, software), "."));

const glossarySection = (terms: [string, string][]): HTMLElement =>
  h("section", { id: "glossary" }, heading(2, "Glossary"), facts(terms));

function show(top: HTMLElement, nav: HTMLElement | "", sections: HTMLElement[], kind = ""): void {
  document.getElementById("report")?.replaceWith(
    h("div", { class: kind ? `page ${kind}` : "page" }, top, nav, h("main", { id: "content", tabindex: -1 }, ...sections), foot()));
  openTargets();
  followPageAndPrinter();
}

function drawTransferFunction(report: TransferFunctionReport): void {
  const sections = [...transferFunctionSections(report), reproduceSection(report.command, report.software), glossarySection(transferFunctionGlossary)];
  show(transferFunctionHead(report), contents(sections), sections);
}

function drawExploration(report: ExplorationReport): void {
  const sections = [...explorationSections(report), reproduceSection(report.command, report.software), glossarySection(explorationGlossary)];
  show(explorationHead(report), contents(sections), sections);
}

function drawStudy(report: StudyReport): void {
  const sections = [...studySections(report), reproduceSection(report.command, report.software), glossarySection(studyGlossary)];
  show(studyHead(report), contents(sections), sections, "of-study");
}

function drawParticipant(report: ParticipantReport): void {
  const sections = [...participantSections(report), reproduceSection(report.command, report.software)];
  show(participantHead(report), "", sections, "of-study");
}

function drawComparison(document_: ComparisonReport): void {
  const report = readComparison(document_);
  const sections = [comparisonSection(report, document_), overviewSection(report), recordingsSection(report),
    reproduceSection(report.command, report.software), glossarySection(glossaryOf(report.trials))];
  const top = head(report, `${report.trials.length} results compared`);
  show(top, contents(sections, report.trials), sections);
}

function draw(report: Report): void {
  const several = report.trials.length > 1 || report.failed.length > 0;
  const sections = several
    ? [overviewSection(report), recordingsSection(report)]
    : trialSections(report.trials[0] as Trial, "trial-1", 2);
  sections.push(
    reproduceSection(report.command, report.software),
    glossarySection(glossaryOf(report.trials)),
  );
  show(head(report), contents(sections, report.trials), sections);
}

try {
  const json = JSON.parse(document.getElementById("report-data")?.textContent ?? "");
  if (json.schema === "mbk.tf_report/1") drawTransferFunction(json);
  else if (json.schema === "mbk.explore_report/1") drawExploration(json);
  else if (json.schema === "mbk.study_report/1") drawStudy(json);
  else if (json.schema === "mbk.participant_report/1") drawParticipant(json);
  else if (json.schema === "mbk.compare_report/1") drawComparison(json);
  else draw(readReport(json));
} catch (error) {
  console.error(error);
  document.getElementById("report")?.replaceWith(
    h("main", { id: "content", class: "page" }, h("h1", {}, "This report cannot be shown"), h("p", {}, `The data in this file cannot be read: ${String(error)}`)));
}

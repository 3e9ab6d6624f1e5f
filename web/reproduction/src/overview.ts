// What this is, how the printed numbers fare, and what the signs mean.
import type { Provenance, Reproduction } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { cellsOf, provenancesOf } from "./document";
import { agreements, provenances, provenanceSign } from "./words";

export function head(reproduction: Reproduction): HTMLElement {
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, "Reproduction"),
    h("h1", {}, "Reproduction of the thesis"),
    h("p", { class: "source" }, reproduction.source),
    h("p", {}, "mbk grew from this thesis. Its tables and figures are reproduced here, one by one, beside the printed numbers, with the errata found in it, its research questions and its future work."));
}

/** @param show  asked with the agreement whose exhibits are to be shown */
export function tallySection(reproduction: Reproduction, show: (agreement: string) => void): HTMLElement {
  const entries = Object.entries(agreements) as [keyof typeof agreements, (typeof agreements)[keyof typeof agreements]][];
  const all = entries.reduce((sum, [agreement]) => sum + reproduction.agreement[agreement], 0);
  const printed = reproduction.exhibits.some((exhibit) => cellsOf(exhibit).some((cell) => cell.printed !== null));
  const beside = reproduction.exhibits.reduce((sum, exhibit) => sum + cellsOf(exhibit).filter((cell) => cell.printed_value !== null && cell.agreement === "not compared").length, 0);
  return h("section", { id: "tally", "aria-labelledby": "tally-heading" },
    h("h2", { id: "tally-heading" }, "How the printed numbers fare"),
    h("p", {}, all > 0
      ? `Of ${all} printed numbers that follow from other printed numbers:`
      : printed ? "No printed number on this page follows from other printed numbers." : "No printed number stands beside ours on this page."),
    h("ul", { class: "tally" },
      ...entries.map(([agreement, { sign, name, word, meaning }]) => {
        const cells = reproduction.agreement[agreement];
        const button = h("button", { type: "button" }, "Show where");
        button.addEventListener("click", () => show(agreement));
        return h("li", { class: name },
          h("p", { class: "headline" }, h("span", { class: `mark ${name}`, "aria-hidden": "true" }, sign), h("data", { value: cells, "data-name": `tally-${name}` }, String(cells))),
          h("p", { class: "tally-word" }, word),
          h("p", { class: "tally-meaning" }, meaning),
          cells > 0 ? button : "");
      })),
    beside > 0 ? h("p", { class: "note" }, `${beside} more stand beside simulated ones, which need not be the same; they are not counted.`) : "");
}

export function legendSection(reproduction: Reproduction): HTMLElement {
  const each = (provenance: Provenance) => reproduction.exhibits.filter((exhibit) => provenancesOf(exhibit).has(provenance)).length;
  return h("section", { id: "legend", "aria-labelledby": "legend-heading" },
    h("h2", { id: "legend-heading" }, "Provenance of our numbers"),
    h("dl", { class: "provenances" },
      ...(Object.keys(provenances) as Provenance[]).map((provenance) =>
        h("div", { class: provenances[provenance].name },
          h("dt", {}, provenanceSign(provenance), provenances[provenance].word),
          h("dd", {}, provenances[provenance].meaning, h("span", { class: "how-many" }, ` ${each(provenance)} on this page.`))))),
    h("div", { class: "cell-legend" },
      h("table", { class: "sample", "aria-hidden": "true" }, h("tbody", {}, h("tr", {}, h("td", {},
        h("span", { class: "ours" }, "5.69", h("span", { class: "half" }, " ± 0.03"), h("span", { class: "mark within-rounding" }, "✓")),
        h("span", { class: "range" }, "[5.62, 5.75]"),
        h("span", { class: "printed" }, "5.7"))))),
      h("p", {}, "In a table, ours stands on top, with ± its spread where there is one and the mark of its agreement. In brackets is what the rounding of the printed inputs leaves open. ",
        h("span", { class: "printed inline" }, "The printed number"), " stands below, as it is printed. Choose a cell, or use the arrow keys in a table, for every digit and the difference.")));
}

// What this is, how ours agrees with the printed numbers, and what the signs mean.
import type { Provenance, Reproduction } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { provenancesOf } from "./document";
import { agreements, provenances, provenanceSign } from "./words";

export function head(reproduction: Reproduction): HTMLElement {
  return h("header", { class: "page-head" },
    h("p", { class: "kicker" }, "Reproduction"),
    h("h1", {}, "Reproduction of the thesis"),
    h("p", { class: "source" }, reproduction.source),
    h("p", {}, "mbk grew out of this thesis. This page reproduces its tables and figures next to the printed numbers, and adds its errata, research questions and future work."));
}

/** @param show  asked with the agreement whose exhibits are to be shown */
export function tallySection(reproduction: Reproduction, show: (agreement: string) => void): HTMLElement {
  const entries = Object.entries(agreements) as [keyof typeof agreements, (typeof agreements)[keyof typeof agreements]][];
  const aside = reproduction.agreement["not compared"];
  const all = entries.reduce((sum, [agreement]) => sum + reproduction.agreement[agreement], aside);
  const simulated = reproduction.exhibits.flatMap(({ tables }) => tables.filter(({ provenance }) => provenance === "simulated"))
    .reduce((sum, { rows }) => sum + rows.flatMap(({ cells }) => cells).filter(({ printed }) => printed !== null).length, 0);
  return h("section", { id: "tally", "aria-labelledby": "tally-heading" },
    h("h2", { id: "tally-heading" }, "Agreement with the printed numbers"),
    h("p", {}, all > 0 ? `Of ${all} printed numbers and words that are compared with ours:` : "This page compares nothing with printed numbers."),
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
      }),
      h("li", { class: "not-compared" },
        h("p", { class: "headline" }, h("data", { value: aside, "data-name": "tally-not-compared" }, String(aside))),
        h("p", { class: "tally-word" }, "are not compared"),
        h("p", { class: "tally-meaning" }, `${simulated} are next to simulated numbers, which need not be equal; for ${aside - simulated}, the printed value or ours is text.`))));
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
      h("p", {}, "In a table our number comes first, with ± its spread, if any, and a mark for the agreement. Brackets give its range due to the rounding of the printed inputs. ",
        h("span", { class: "printed inline" }, "The printed number"), " is below it. Select a cell, or use the arrow keys in a table, for all digits and the difference.")));
}

// One exhibit: a table, a figure, an erratum, a question or a piece of future work.
import type { Exhibit } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { chartsBlock } from "./charts";
import { count, shortName } from "./document";
import { tableBlock } from "./tables";
import { agreements, chip, scripted } from "./words";

/** "8 agree within rounding", for what there is of it. */
function tally(exhibit: Exhibit): HTMLElement | undefined {
  const parts = Object.entries(agreements)
    .map(([agreement, { sign, name, several }]) => ({ agreement, sign, name, several, cells: count(exhibit, agreement as keyof typeof agreements) }))
    .filter(({ cells }) => cells > 0);
  if (parts.length === 0) return undefined;
  return h("span", { class: "tally-line" },
    ...parts.map(({ agreement, sign, name, several, cells }) =>
      h("span", {}, h("span", { class: `mark ${name}`, "aria-hidden": "true" }, sign), ` ${cells} ${cells === 1 ? agreement : several}`)));
}

function commandBlock(command: string): HTMLElement {
  const copy = h("button", { type: "button", "aria-label": `Copy: ${command}` }, "Copy");
  const code = h("code", {}, command);
  copy.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(command);
    } catch {
      // Without a clipboard of its own the browser may still copy what is selected.
      getSelection()?.selectAllChildren(code);
      document.execCommand("copy");
    }
    copy.textContent = "Copied";
    setTimeout(() => (copy.textContent = "Copy"), 2000);
  });
  return h("div", { class: "command-line" }, h("pre", {}, code), copy);
}

function relatedLinks(ids: string[], known: Set<string>): HTMLElement {
  return h("ul", { class: "related" },
    ...ids.map((id) => h("li", {}, known.has(id) ? h("a", { href: `#${id}` }, shortName(id)) : h("span", { title: "not on this page" }, shortName(id)))));
}

/** @param known  ids that a link can lead to    @param explains  exhibits whose tables name this erratum */
export function exhibitArticle(exhibit: Exhibit, drawings: string[], known: Set<string>, explains: string[]): HTMLElement {
  const empty = exhibit.text.length === 0 && exhibit.tables.length === 0 && exhibit.charts.length === 0;
  const related = [...new Set([...explains, ...exhibit.related])];
  const reason = exhibit.provenance === "not recoverable";
  return h("article", { id: exhibit.id, "aria-labelledby": `${exhibit.id}-heading`, "data-kind": exhibit.kind, tabindex: -1 },
    h("p", { class: "exhibit-name" }, h("a", { href: `#${exhibit.id}`, title: "Link to this" }, shortName(exhibit.id)), chip(exhibit.provenance), tally(exhibit)),
    h("h3", { id: `${exhibit.id}-heading` }, ...scripted(exhibit.title)),
    h("div", { class: reason ? "text reason" : "text" }, ...exhibit.text.map((paragraph) => h("p", {}, ...scripted(paragraph)))),
    empty ? h("p", { class: "none" }, "No numbers for this exhibit.") : "",
    exhibit.charts.length > 0 ? chartsBlock(exhibit, drawings) : "",
    ...exhibit.tables.map((_, k) => tableBlock(exhibit, k, known)),
    exhibit.commands.length > 0
      ? h("details", { class: "commands" }, h("summary", {}, "How to reproduce this"), ...exhibit.commands.map(commandBlock))
      : "",
    related.length > 0 ? h("div", { class: "see-also" }, h("span", {}, "See also"), relatedLinks(related, known)) : "");
}

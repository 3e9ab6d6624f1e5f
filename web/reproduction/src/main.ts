// Turns the document in the page into the reproduction, exhibit by exhibit.
import type { ReproductionPage } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { contents } from "./contents";
import { type Group, grouped, readPage } from "./document";
import { exhibitArticle } from "./exhibit";
import { head, legendSection, tallySection } from "./overview";
import "./style.css";

/** An address with an exhibit behind # leads there, also where the filter hides it, and the keyboard goes on from there. */
function followAddress(reveal: (id: string) => void): void {
  const go = () => {
    const id = location.hash.slice(1).replace(/^slip-(?=\d)/, "erratum-"); // the name that they had before
    reveal(id);
    const target = document.getElementById(id);
    target?.scrollIntoView();
    if (target?.tagName === "ARTICLE") target.focus({ preventScroll: true });
  };
  addEventListener("hashchange", go);
  if (location.hash) go();
}

function followPrinter(): void {
  const opened: HTMLDetailsElement[] = [];
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll<HTMLDetailsElement>("details.commands:not([open])")) {
      details.open = true;
      opened.push(details);
    }
  });
  addEventListener("afterprint", () => {
    for (const details of opened.splice(0)) details.open = false;
  });
}

function groupSection(group: Group, articles: Map<string, HTMLElement>): HTMLElement {
  return h("section", { class: "group", id: group.id, "aria-labelledby": `${group.id}-heading` },
    h("h2", { id: `${group.id}-heading` }, group.title), ...group.exhibits.map(({ id }) => articles.get(id)));
}

function draw({ reproduction, drawings }: ReproductionPage): void {
  const { exhibits } = reproduction;
  const known = new Set(exhibits.map(({ id }) => id));
  const explains = (erratum: string) => exhibits.filter(({ tables }) => tables.some((table) => table.erratum === erratum)).map(({ id }) => id);
  const articles = new Map(exhibits.map((exhibit) => [exhibit.id, exhibitArticle(exhibit, drawings[exhibit.id] ?? [], known, explains(exhibit.id))]));
  const groups = grouped(exhibits);
  const place = h("div", { class: "sidebar-place" });
  const main = h("main", { id: "content", tabindex: -1 },
    head(reproduction),
    tallySection(reproduction, (agreement) => found.showAgreement(agreement)),
    legendSection(reproduction),
    h("p", { id: "nothing", hidden: true }, exhibits.length > 0 ? "No exhibit matches the filter." : "This page has no exhibits."),
    ...groups.map((group) => groupSection(group, articles)),
    h("footer", {},
      h("p", {}, "All numbers in one file in this folder: ", h("a", { href: "reproduction.json" }, "reproduction.json"), ", of schema mbk.reproduction/2."),
      h("p", {}, "Made with ", h("strong", {}, reproduction.software), ". The same version and seed give exactly the same numbers.")));
  document.getElementById("page")?.replaceWith(h("div", { class: "page" }, place, main));
  const found = contents(groups, articles);
  place.replaceWith(found.element);
  followAddress((id) => found.reveal(id));
  followPrinter();
}

try {
  draw(readPage(JSON.parse(document.getElementById("report-data")?.textContent ?? "")));
} catch (error) {
  document.getElementById("page")?.replaceWith(
    h("main", { id: "content", class: "page" }, h("h1", {}, "This page cannot be shown"), h("p", {}, `The numbers in this file cannot be read: ${String(error)}`)));
}

// The way around: what there is, by chapter, and a filter.
import type { Agreement, Exhibit, Provenance } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { count, type Group, provenancesOf, shortName } from "./document";
import { showDifferences } from "./tables";
import { agreements, provenances, provenanceSign, scripted } from "./words";

export interface Contents {
  element: HTMLElement;
  /** Shows only what has a number that stands so to the printed one. */
  showAgreement(agreement: string): void;
  /** Takes the filter away where it hides this. */
  reveal(id: string): void;
}

const lower = (text: string): string => text.toLocaleLowerCase("en").replaceAll("−", "-");

/** Everything of an exhibit that a reader may look for. */
function wordsOf(exhibit: Exhibit): string {
  const tables = exhibit.tables.flatMap((table) => [table.title, table.what_rows_are, ...table.columns.map(({ name }) => name), ...table.rows.map(({ name }) => name)]);
  const charts = exhibit.charts.flatMap((chart) => [chart.title, chart.x.label, chart.y.label, ...chart.notes, ...chart.series.map(({ name }) => name)]);
  return lower([exhibit.id, shortName(exhibit.id), exhibit.kind, exhibit.title, ...exhibit.text, ...exhibit.commands, ...tables, ...charts].join("\n"));
}

const signsOf = (exhibit: Exhibit): HTMLElement[] =>
  (["erratum", "differs"] as const).filter((agreement) => count(exhibit, agreement) > 0)
    .map((agreement) => h("span", { class: `mark ${agreements[agreement].name}`, title: `${count(exhibit, agreement)} ${agreement}`, "aria-hidden": "true" }, agreements[agreement].sign));

/** Which exhibit is being read, and its entry in view. */
function followReading(articles: Map<string, HTMLElement>, links: Map<string, HTMLElement>, room: HTMLElement): void {
  const visible = new Set<string>();
  let current: string | undefined;
  const observer = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) visible.add(target.id);
      else visible.delete(target.id);
    }
    const first = [...articles.keys()].find((id) => visible.has(id));
    // Between two exhibits the last one is still the current one; above all of them none is.
    if (first === current || (first === undefined && scrollY > innerHeight)) return;
    if (current) links.get(current)?.removeAttribute("aria-current");
    current = first;
    if (first === undefined) {
      room.scrollTop = 0;
      return;
    }
    const link = links.get(first);
    link?.setAttribute("aria-current", "true");
    if (!link || room.scrollHeight <= room.clientHeight) return;
    const top = link.getBoundingClientRect().top - room.getBoundingClientRect().top;
    if (top < 0 || top > room.clientHeight - 60) room.scrollTop += top - room.clientHeight / 3;
  }, { rootMargin: "-10% 0px -70% 0px" });
  for (const article of articles.values()) observer.observe(article);
}

export function contents(groups: Group[], articles: Map<string, HTMLElement>): Contents {
  const exhibits = groups.flatMap((group) => group.exhibits);
  const words = new Map(exhibits.map((exhibit) => [exhibit.id, wordsOf(exhibit)]));
  const links = new Map(exhibits.map((exhibit) => [exhibit.id,
    h("a", { href: `#${exhibit.id}` }, provenanceSign(exhibit.provenance), h("span", { class: "entry" }, h("strong", {}, shortName(exhibit.id)), h("span", {}, ...scripted(exhibit.title))), ...signsOf(exhibit))]));
  const lists = groups.map((group) => ({
    group,
    element: h("li", {}, h("a", { class: "group", href: `#${group.id}` }, group.title), h("ul", {}, ...group.exhibits.map(({ id }) => h("li", {}, links.get(id))))),
  }));

  const search = h("input", { type: "search", id: "filter-text", placeholder: "stiffness, table 3.6, erratum …", autocomplete: "off" });
  const boxes = (Object.keys(provenances) as Provenance[]).map((provenance) => {
    const box = h("input", { type: "checkbox", checked: true, value: provenance });
    return { provenance, box, label: h("label", {}, box, provenanceSign(provenance), provenance) };
  });
  const agreement = h("select", { id: "filter-agreement" }, h("option", { value: "" }, "any numbers"),
    ...Object.entries(agreements).map(([value, { which }]) => h("option", { value }, `numbers ${which}`)));
  const shownCount = h("p", { class: "shown-count", role: "status" });
  const clear = h("button", { type: "button" }, "Show all");
  const nothing = document.getElementById("nothing");

  const matches = (exhibit: Exhibit): boolean => {
    const searched = lower(search.value).split(/\s+/).filter(Boolean);
    const from = provenancesOf(exhibit);
    return boxes.some(({ provenance, box }) => box.checked && from.has(provenance))
      && (agreement.value === "" || count(exhibit, agreement.value as Agreement) > 0)
      && searched.every((word) => words.get(exhibit.id)?.includes(word));
  };
  const apply = (): void => {
    let shown = 0;
    for (const { group, element } of lists) {
      const before = shown;
      for (const exhibit of group.exhibits) {
        const fits = matches(exhibit);
        shown += Number(fits);
        articles.get(exhibit.id)!.hidden = !fits;
        links.get(exhibit.id)!.closest("li")!.hidden = !fits;
      }
      element.hidden = shown === before;
      document.getElementById(group.id)!.hidden = shown === before;
    }
    clear.hidden = shown === exhibits.length;
    shownCount.textContent = shown === exhibits.length ? `${shown} shown` : `${shown} of ${exhibits.length} shown`;
    if (nothing) nothing.hidden = shown > 0;
  };
  const reset = (): void => {
    search.value = "";
    agreement.value = "";
    for (const { box } of boxes) box.checked = true;
    apply();
  };
  search.addEventListener("input", apply);
  agreement.addEventListener("change", apply);
  for (const { box } of boxes) box.addEventListener("change", apply);
  clear.addEventListener("click", () => {
    reset();
    search.focus();
  });

  const differences = h("input", { type: "checkbox" });
  differences.addEventListener("change", () => {
    for (const block of document.querySelectorAll<HTMLElement>(".table-block")) showDifferences(block, differences.checked);
  });

  const nav = h("nav", { "aria-label": "Contents" }, h("ul", {}, ...lists.map(({ element }) => element)));
  const form = h("form", { role: "search", "aria-label": "Filter" },
    h("label", { for: "filter-text" }, "Filter"), search,
    h("fieldset", {}, h("legend", {}, "Provenance of our numbers"), ...boxes.map(({ label }) => label)),
    h("label", { for: "filter-agreement" }, "With"), agreement,
    h("div", { class: "filter-foot" }, shownCount, clear),
    h("label", { class: "all-differences" }, differences, "Show differences in all tables"));
  form.addEventListener("submit", (event) => event.preventDefault());

  const room = h("div", { class: "sidebar-room" }, form, nav);
  const details = h("details", { class: "sidebar" }, h("summary", {}, "Contents and filter"), room);
  const broad = matchMedia("(min-width: 64rem)");
  const arrange = () => (details.open = broad.matches);
  broad.addEventListener("change", arrange);
  arrange();
  nav.addEventListener("click", (event) => {
    if (!broad.matches && (event.target as HTMLElement).closest("a")) details.open = false;
  });
  details.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || broad.matches || !details.open) return;
    details.open = false;
    details.querySelector("summary")?.focus();
  });
  followReading(articles, links, room);
  apply();
  return {
    element: details,
    showAgreement(value) {
      reset();
      agreement.value = value;
      apply();
      articles.get(exhibits.find(matches)?.id ?? "")?.focus();
    },
    reveal(id) {
      if (articles.get(id)?.hidden) reset();
    },
  };
}

// The document of schema mbk.reproduction/2 that stands in the page, with the drawing of each chart.
import type { Agreement, Cell, Exhibit, Provenance, ReproductionPage } from "@mbk/shared/documents";

/** Reads the document out of the page. Throws where it is none. */
export function readPage(json: ReproductionPage): ReproductionPage {
  const schema = json?.reproduction?.schema;
  if (schema !== "mbk.reproduction/2") throw new Error(`schema ${String(schema)} is not mbk.reproduction/2`);
  return { reproduction: json.reproduction, drawings: json.drawings ?? {} };
}

/** "Table 3.6" of "table-3.6", "Future work 4" of "future-work-4". */
export function shortName(id: string): string {
  const [, kind = id, rest = ""] = /^([a-z]+(?:-work)?)-(.+)$/i.exec(id) ?? [];
  const words = kind.replaceAll("-", " ");
  const name = `${words.slice(0, 1).toUpperCase()}${words.slice(1)}`;
  return rest ? `${name} ${/^[a-z]\./.test(rest) ? rest.toUpperCase() : rest.replaceAll("-", " ")}` : name;
}

export interface Group {
  id: string;
  title: string;
  exhibits: Exhibit[];
}

const groups: [id: string, title: string, belongs: (exhibit: Exhibit) => boolean][] = [
  ["errata", "Errata in the source", ({ kind }) => kind === "erratum"],
  ["questions", "Research questions", ({ kind }) => kind === "question"],
  ["future-work", "Future work", ({ kind }) => kind === "future work"],
  ["chapter-3", "Chapter 3: the relaxed arm", ({ chapter }) => chapter === 3],
  ["chapter-4", "Chapter 4: the arm with a task", ({ chapter }) => chapter === 4],
  ["chapter-5", "Chapter 5: force without a sensor", ({ chapter }) => chapter === 5],
  ["chapter-6", "Chapter 6: conclusions", ({ chapter }) => chapter === 6],
  ["appendices", "Appendices", () => true],
];
const order = ["chapter-3", "chapter-4", "chapter-5", "chapter-6", "appendices", "errata", "questions", "future-work"];

const rank = (exhibit: Exhibit): number => ["table", "figure"].indexOf(exhibit.kind);
const byNumber = new Intl.Collator("en", { numeric: true }).compare;

/** The exhibits by chapter, tables before figures, by number; groups without any are left out. */
export function grouped(exhibits: Exhibit[]): Group[] {
  const groupOf = (exhibit: Exhibit) => groups.find(([, , belongs]) => belongs(exhibit))?.[0];
  return order
    .map((id) => ({
      id,
      title: groups.find(([name]) => name === id)?.[1] ?? id,
      exhibits: exhibits
        .filter((exhibit) => groupOf(exhibit) === id)
        .sort((a, b) => rank(a) - rank(b) || byNumber(a.id, b.id)),
    }))
    .filter((group) => group.exhibits.length > 0);
}

export const cellsOf = (exhibit: Exhibit): Cell[] =>
  exhibit.tables.flatMap((table) => table.rows.flatMap((row) => row.cells));

export const count = (exhibit: Exhibit, agreement: Agreement): number =>
  cellsOf(exhibit).filter((cell) => cell.agreement === agreement).length;

/** An exhibit shows numbers of each of these. */
export const provenancesOf = (exhibit: Exhibit): Set<Provenance> =>
  new Set([exhibit.provenance, ...exhibit.tables.map((table) => table.provenance)]);

/** Name of the files of table k, without extension, beside the page. */
export const tableFile = (exhibit: Exhibit, k: number): string =>
  exhibit.tables.length === 1 ? exhibit.id : `${exhibit.id}-${k + 1}`;

export const chartFile = (exhibit: Exhibit, k: number): string => `${exhibit.id}-${k + 1}`;

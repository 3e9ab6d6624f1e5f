// The document of schema mbk.reproduction/1 that stands in the page, with the drawing of each chart.
import type { Value } from "../../report/src/data";

export type Provenance = "recomputed" | "simulated" | "not recoverable";
export type Agreement = "not compared" | "within rounding" | "slip" | "differs";

export interface Cell {
  /** As it stands in print. */
  printed: string | null;
  printed_value: Value;
  rounding: Value;
  /** A number, words where it is none, null where it cannot be had. */
  ours: Value | string;
  difference: Value;
  spread: Value;
  range: [Value, Value] | null;
  agreement: Agreement;
}

export interface Column {
  name: string;
  unit: string;
  decimals: number;
}

export interface Table {
  id: string;
  title: string;
  provenance: Provenance;
  what_rows_are: string;
  spread_is: string;
  slip: string | null;
  columns: Column[];
  rows: { name: string; cells: Cell[] }[];
}

export interface Axis {
  label: string;
  unit: string;
  logarithmic: boolean;
}

export interface Chart {
  title: string;
  x: Axis;
  y: Axis;
  identity: boolean;
  horizontal: { value: Value; name: string }[];
  vertical: { value: Value; name: string }[];
  notes: string[];
  series: { name: string; drawn: "line" | "marks"; x: Value[]; y: Value[]; intervals: [Value, Value][] }[];
}

export interface Exhibit {
  id: string;
  kind: "table" | "figure" | "slip" | "question" | "future work";
  chapter: number;
  title: string;
  provenance: Provenance;
  text: string[];
  commands: string[];
  related: string[];
  tables: Table[];
  charts: Chart[];
}

export interface Reproduction {
  software: string;
  source: string;
  agreement: Record<Exclude<Agreement, "not compared">, number>;
  exhibits: Exhibit[];
}

export interface Page {
  reproduction: Reproduction;
  /** One SVG for each chart, by the id of the exhibit. */
  drawings: Record<string, string[]>;
}

/** Reads the document out of the page. Throws where it is none. */
export function readPage(json: any): Page {
  const schema = json?.reproduction?.schema;
  if (schema !== "mbk.reproduction/1") throw new Error(`schema ${String(schema)} is not mbk.reproduction/1`);
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
  ["slips", "Slips in the source", ({ kind }) => kind === "slip"],
  ["questions", "Research questions", ({ kind }) => kind === "question"],
  ["future-work", "Future work", ({ kind }) => kind === "future work"],
  ["chapter-3", "Chapter 3: the relaxed arm", ({ chapter }) => chapter === 3],
  ["chapter-4", "Chapter 4: the arm with a task", ({ chapter }) => chapter === 4],
  ["chapter-5", "Chapter 5: force without a sensor", ({ chapter }) => chapter === 5],
  ["chapter-6", "Chapter 6: conclusions", ({ chapter }) => chapter === 6],
  ["appendices", "Appendices", () => true],
];
const order = ["chapter-3", "chapter-4", "chapter-5", "chapter-6", "appendices", "slips", "questions", "future-work"];

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

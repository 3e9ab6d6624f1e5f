// What the pages ask of a result.
import type { Method, ReportedTrial, Result, Units } from "./documents";

/** One result with what is drawn for it. */
export interface Trial extends ReportedTrial {
  result: Result;
  /** Of the result's own file, where it came from one. */
  name?: string;
}

export const methodNames: Record<Method, string> = { ls: "least squares", iv: "instrumental variables" };

export type MatrixName = "M" | "B" | "K";

export const matrices = [
  { symbol: "M", name: "inertia", title: "Inertia" },
  { symbol: "B", name: "damping", title: "Damping" },
  { symbol: "K", name: "stiffness", title: "Stiffness" },
] as const;

/** Units, also where the file does not say what moves. */
export function unitsOf(result: Result): Record<keyof Units, string> {
  return (
    result.units ?? {
      M: "kg or kg·m²",
      B: "N·s/m or N·m·s/rad",
      K: "N/m or N·m/rad",
      x0: "m or rad",
      force: "N or N·m",
    }
  );
}

export const axisNames = (axes: number): string[] => (axes === 1 ? [""] : ["x", "y", "z"].slice(0, axes));

/** Row and column of each element of a matrix, row by row, with its name: "xx", "xy" …; force, then motion. */
export const elementsOf = (axes: number): { name: string; j: number; i: number }[] =>
  axisNames(axes).flatMap((row, j) => axisNames(axes).map((column, i) => ({ name: row + column, j, i })));

/** "x: " before what belongs to one axis; nothing where there is only one. */
export const axisPrefix = (axes: number, axis: number): string => (axes === 1 ? "" : `${axisNames(axes)[axis]}: `);

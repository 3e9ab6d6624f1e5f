// Matrices as rows of a table: an element a column, or where those are too many, a row for each axis of the force.
import { axisNames, elementsOf } from "@mbk/shared/result";

const mostColumns = 4;
const byElement = (axes: number): boolean => axes * axes <= mostColumns;

/** Heads of the columns of the elements.   @param only  that of a single number */
export function elementHeads(axes: number, only: string): string[] {
  if (axes === 1) return [only];
  return byElement(axes) ? elementsOf(axes).map(({ name }) => name) : axisNames(axes).map((axis) => `motion ${axis}`);
}

/** @param more  what follows the elements, made for each row */
export function matrixRows(name: string, axes: number, cell: (j: number, i: number) => Node | string, more: () => (Node | string)[]): (Node | string)[][] {
  if (byElement(axes)) return [[name, ...elementsOf(axes).map(({ j, i }) => cell(j, i)), ...more()]];
  return axisNames(axes).map((axis, j) => [`${name}, force ${axis}`, ...axisNames(axes).map((_, i) => cell(j, i)), ...more()]);
}

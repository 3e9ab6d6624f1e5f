// Numbers of a document, and the model that they make.
export type Value = number | null;
export type MatrixName = "M" | "B" | "K";

export interface Model {
  M: Value[][];
  B: Value[][];
  K: Value[][];
  x0: Value[];
}

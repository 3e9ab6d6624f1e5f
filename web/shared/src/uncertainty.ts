// What the covariance of a matrix means for its ellipse: draws from it, by direction.
import type { Result, Value } from "./documents";

const draws = 1000;
const tail = Math.round(0.025 * draws);
export const directions = 72; // of the outline, all around

/** Uniform in [0, 1), the same on every machine (mulberry32). */
function uniform(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Standard normal, by Box and Muller. */
function normal(random: () => number): () => number {
  return () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
}

/** Three for each draw, always the same. */
const standard = Float64Array.from({ length: 3 * draws }, normal(uniform(1)));

/** Lower triangular L of L Lᵀ = C; zero where C has no variance left. */
function cholesky(C: number[][]): number[][] {
  const L = C.map((row) => row.map(() => 0));
  const at = (i: number, j: number) => L[i]?.[j] ?? 0;
  for (let j = 0; j < C.length; ++j) {
    for (let i = j; i < C.length; ++i) {
      let rest = C[i]?.[j] ?? 0;
      for (let k = 0; k < j; ++k) rest -= at(i, k) * at(j, k);
      const row = L[i] as number[];
      if (i === j) row[j] = Math.sqrt(Math.max(rest, 0));
      else row[j] = at(j, j) > 0 ? rest / at(j, j) : 0;
    }
  }
  return L;
}

/** How far each ellipse {S u : |u| = 1} of `drawn`, three numbers xx, xy, yy each, reaches in a direction: 1/|S⁻¹ u|. */
function reaches(drawn: Float64Array, angle: number, into: Float64Array): void {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  for (let one = 0; one < draws; ++one) {
    const [xx, xy, yy] = [drawn[3 * one] as number, drawn[3 * one + 1] as number, drawn[3 * one + 2] as number];
    const [along, across] = [yy * c - xy * s, xx * s - xy * c];
    const inverse = Math.sqrt(along * along + across * across);
    into[one] = inverse > 0 ? Math.abs(xx * yy - xy * xy) / inverse : 0;
  }
}

/** Covariance of xx, (xy + yx)/2, yy; none where the result does not hold it. */
function covarianceOf(symbol: string, result: Result): number[][] | undefined {
  const { parameters, matrix } = result.covariance ?? { parameters: [], matrix: [] };
  const place = ["xx", "xy", "yx", "yy"].map((pair) => parameters.indexOf(`${symbol.toLowerCase()}_${pair}`));
  const weights = [[1, 0, 0, 0], [0, 0.5, 0.5, 0], [0, 0, 0, 1]];
  const of = (i: number, j: number): Value => matrix[place[i] ?? -1]?.[place[j] ?? -1] ?? null;
  const four = [0, 1, 2, 3].map((i) => [0, 1, 2, 3].map((j) => of(i, j)));
  if (four.flat().some((value) => value === null)) return undefined;
  return weights.map((a) => weights.map((b) =>
    a.reduce((sum, wa, i) => sum + b.reduce((inner, wb, j) => inner + wa * wb * (four[i]?.[j] as number), 0), 0)));
}

export interface Band {
  /** 2.5 % and 97.5 % of the reach in each direction, counter-clockwise from x. */
  low: number[];
  high: number[];
}

/** How far the ellipse of a matrix may reach in each direction, by draws from the covariance. */
export function ellipseBand(symbol: "M" | "B" | "K", result: Result): Band | undefined {
  const model = result.model[symbol];
  const mean = [model[0]?.[0], ((model[0]?.[1] ?? Number.NaN) + (model[1]?.[0] ?? Number.NaN)) / 2, model[1]?.[1]];
  const covariance = covarianceOf(symbol, result);
  if (!covariance || mean.some((value) => typeof value !== "number" || !Number.isFinite(value))) return undefined;
  if (!covariance.some((row, i) => (row[i] ?? 0) > 0)) return undefined;
  const L = cholesky(covariance);
  const drawn = new Float64Array(3 * draws);
  mean.forEach((m, i) => {
    const [l0, l1, l2] = L[i] as [number, number, number];
    for (let at = 0; at < drawn.length; at += 3) {
      drawn[at + i] = (m as number) + (l0 * (standard[at] as number) + l1 * (standard[at + 1] as number) + l2 * (standard[at + 2] as number));
    }
  });
  const radii = new Float64Array(draws);
  const quantiles = Array.from({ length: directions / 2 }, (_, k) => {
    reaches(drawn, (2 * Math.PI * k) / directions, radii);
    radii.sort();
    return [radii[tail] ?? 0, radii[draws - 1 - tail] ?? 0] as const;
  });
  const all = [...quantiles, ...quantiles]; // an ellipse reaches as far to the other side
  return { low: all.map(([low]) => low), high: all.map(([, high]) => high) };
}

// M, B and K as they are known so far, with what is left of doubt.
import type { LiveEstimate, Value } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { ellipsePanels } from "@mbk/shared/ellipses";
import { fixed, withHalfWidth } from "@mbk/shared/format";
import { matrices, methodNames, unitsOf } from "@mbk/shared/result";
import { type Band, ellipseBand } from "@mbk/shared/uncertainty";
import { plainWarnings } from "@mbk/shared/warnings";

const cells: [number, number][] = [[0, 0], [0, 1], [1, 0], [1, 1]];
const kept = 24; // half widths of the last estimates that the small picture shows

/** How the half widths of the diagonal have shrunk since the first estimate. */
class Tightening {
  private readonly first = new Map<string, number>();
  private readonly history: number[] = [];

  clear(): void {
    this.first.clear();
    this.history.length = 0;
  }

  /** Mean of half width over the first one, over the diagonal elements of all three matrices. */
  add(errors: Record<string, Value[][]>): number[] {
    const shares: number[] = [];
    for (const { symbol } of matrices) {
      for (const axis of [0, 1]) {
        const error = errors[symbol]?.[axis]?.[axis];
        if (error === null || error === undefined || !(error > 0)) continue;
        const key = `${symbol}${axis}`;
        if (!this.first.has(key)) this.first.set(key, error);
        shares.push(error / (this.first.get(key) as number));
      }
    }
    if (shares.length > 0) this.history.push(shares.reduce((sum, one) => sum + one, 0) / shares.length);
    if (this.history.length > kept) this.history.splice(1, 1);
    return this.history;
  }
}

export class EstimatePanel {
  readonly element = h("section", { class: "estimate", "aria-labelledby": "estimate-title" });
  private readonly tightening = new Tightening();
  private newest: LiveEstimate | undefined;

  constructor() {
    this.show({ type: "estimate" });
  }

  /** The bands of the ellipses first, each in a task of its own: together they would take a picture of the traces. */
  show(estimate: LiveEstimate, bands: (Band | undefined)[] = []): void {
    if (bands.length === 0) this.newest = estimate;
    else if (this.newest !== estimate) return;
    const { result } = estimate;
    const next = matrices[bands.length];
    if (!result?.usable || !next) return this.draw(estimate, bands);
    const band = ellipseBand(next.symbol, result);
    setTimeout(() => this.show(estimate, [...bands, band]));
  }

  private draw(estimate: LiveEstimate, bands: (Band | undefined)[]): void {
    const { result } = estimate;
    const title = (words: string) => h("h2", { id: "estimate-title" }, "Impedance", h("small", {}, words));
    if (!result) {
      if (estimate.final === undefined) this.tightening.clear();
      this.element.replaceChildren(title(""), h("p", { class: "not-yet" }, estimate.why ? `Not yet available: ${estimate.why}.` : "M, B and K appear two seconds after the perturbation starts."));
      return;
    }
    const units = unitsOf(result);
    const from = estimate.from_s ?? 0;
    // those of a few seconds are wider than those of all: they did not narrow
    const history = from > 0 ? [] : this.tightening.add(result.standard_error as unknown as Record<string, Value[][]>);
    const seconds = ((estimate.perturbed_s ?? 0) - from).toFixed(0);
    const span = estimate.final ? ` from the whole perturbation, ${seconds} s` : from > 0 ? ` from the last ${seconds} s, because the stiffness changed` : ` so far, from ${seconds} s`;
    const ellipses = result.usable ? ellipsePanels(result, undefined, bands) : undefined;
    this.element.replaceChildren(
      title(`${span}, by ${methodNames[result.method]}`),
      !result.usable ? "" : h(
        "div",
        { class: "matrices" },
        ...matrices.map(({ symbol, title: name }) =>
          h(
            "div",
            { class: "matrix" },
            h("p", { class: "matrix-name" }, h("strong", {}, symbol), ` ${name.toLowerCase()} [${units[symbol]}]`),
            h("div", { class: "cells" }, ...cells.map(([i, j]) =>
              withHalfWidth(result.model[symbol][i]?.[j] ?? null, result.standard_error[symbol][i]?.[j] ?? null, `${symbol}${i}${j}`))),
          )),
      ),
      ellipses ?? "",
      h(
        "p",
        { class: "tightening" },
        history.length > 1
          ? `95 % intervals narrowed by ${(100 * (1 - (history.at(-1) as number))).toFixed(0)} % since the first estimate. `
          : "± is half the width of the 95 % interval. ",
        `Model explains ${result.fit.VAF.map((value, k) => `${fixed(value, 1)} % in ${"xy"[k]}`).join(", ")}.`,
        result.usable ? "" : h("strong", { class: "care-text" }, estimate.final ? " ▲ Not usable." : " ▲ Not usable yet."),
      ),
      h("ul", { class: "warnings" }, ...result.warnings.map(({ code, message }) => h("li", {}, `▲ ${plainWarnings[code]?.title ?? message}`))),
    );
  }
}

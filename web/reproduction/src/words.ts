// The three provenances and how numbers agree: a sign, a colour and words for each, so that nothing hangs on one of them.
import type { Agreement, Provenance } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";

export const provenances: Record<Provenance, { sign: string; name: string; word: string; meaning: string }> = {
  recomputed: {
    sign: "=",
    name: "recomputed",
    word: "Recomputed from printed numbers",
    meaning: "The source prints what it follows from. Ours has to be the printed number, up to what rounding leaves open.",
  },
  simulated: {
    sign: "≈",
    name: "simulated",
    word: "Simulated by mechanism",
    meaning: "The recordings were never published. Simulated participants, robots or rigs stand in for them: expect the same form and the same findings, not the same values.",
  },
  "not recoverable": {
    sign: "∅",
    name: "not-recoverable",
    word: "Not recoverable",
    meaning: "What it rests on was never published, and nothing can stand in for it. The reason is given; no number is invented.",
  },
};

export const agreements: Record<Exclude<Agreement, "not compared">, { sign: string; name: string; word: string; meaning: string }> = {
  "within rounding": {
    sign: "✓",
    name: "within-rounding",
    word: "agree within rounding",
    meaning: "What the rounding of the printed inputs leaves open reaches the printed number.",
  },
  erratum: {
    sign: "!",
    name: "erratum",
    word: "are errata of the source",
    meaning: "Rounding does not account for the difference, and the source is at fault: the mark leads to the erratum.",
  },
  differs: {
    sign: "≠",
    name: "differs",
    word: "differ",
    meaning: "Rounding does not account for the difference, and nothing else does.",
  },
};

export const provenanceSign = (provenance: Provenance): HTMLElement =>
  h("span", { class: `sign ${provenances[provenance].name}`, "aria-hidden": "true" }, provenances[provenance].sign);

export const chip = (provenance: Provenance): HTMLElement =>
  h("span", { class: `chip ${provenances[provenance].name}`, "data-provenance": provenance, title: provenances[provenance].meaning },
    provenanceSign(provenance), provenances[provenance].word);

/** k_xx with xx as a subscript: one letter with a short index, as formulas have it. */
export function scripted(text: string): (Node | string)[] {
  return text.split(/(?<![\p{L}\p{N}_])(\p{L}_[a-z0-9]{1,3})(?![\p{L}\p{N}_])/u).map((part, k) =>
    k % 2 === 1 ? h("span", { class: "symbol" }, part.slice(0, 1), h("sub", {}, part.slice(2))) : part);
}

export const hidden = (text: string): HTMLElement => h("span", { class: "hidden" }, text);

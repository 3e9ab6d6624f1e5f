// The three provenances and the agreements: a sign, a colour and words for each, so that none of them is needed alone.
import type { Agreement, Provenance } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";

export const provenances: Record<Provenance, { sign: string; name: string; word: string; meaning: string }> = {
  recomputed: {
    sign: "=",
    name: "recomputed",
    word: "Recomputed from printed numbers",
    meaning: "Computed from other numbers printed in the source. Ours must equal the printed number within rounding.",
  },
  simulated: {
    sign: "≈",
    name: "simulated",
    word: "Simulated by mechanism",
    meaning: "The recordings were never published; simulated participants, robots or rigs replace them. Expect the same form and findings, not the same values.",
  },
  "not recoverable": {
    sign: "∅",
    name: "not-recoverable",
    word: "Not recoverable",
    meaning: "The underlying data were never published and cannot be replaced. The reason is given; no number is invented.",
  },
};

/** `several`: for several cells; `which`: in "numbers that …"; `word`: after a count of all. */
export const agreements: Record<Exclude<Agreement, "not compared">, { sign: string; name: string; several: string; which: string; word: string; meaning: string }> = {
  "within rounding": {
    sign: "✓",
    name: "within-rounding",
    several: "within rounding",
    which: "within rounding",
    word: "agree within rounding",
    meaning: "Computed from other printed numbers; their rounding explains any difference.",
  },
  erratum: {
    sign: "!",
    name: "erratum",
    several: "errata",
    which: "that are errata",
    word: "are errata of the source",
    meaning: "Computed from other printed numbers; rounding does not explain the difference, and the source is wrong: the mark links to the erratum.",
  },
  differs: {
    sign: "≠",
    name: "differs",
    several: "differ",
    which: "that differ",
    word: "differ",
    meaning: "Computed from other printed numbers; the difference is not explained.",
  },
  "round trip": {
    sign: "↺",
    name: "round-trip",
    several: "round trips",
    which: "that make a round trip",
    word: "make a round trip",
    meaning: "Computed from the printed number and back to it. This checks the formulas, not the source.",
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

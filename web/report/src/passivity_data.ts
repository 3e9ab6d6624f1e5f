// What the document says of passivity, of energy and of how sure the numbers are.
import type { Model, Value } from "./values";

export type Verdict = "passive" | "active" | "undecided";
export type Interval = [Value, Value];
export type Method = "ls" | "iv";

/** A condition of passivity: it must be positive. */
export interface Condition {
  name: string;
  source: string;
  unit: string;
  value: Value;
  standard_error: Value;
  /** Above it with 95 % confidence. */
  lower95: Value;
  /** Below it with 95 % confidence for all conditions at once. */
  upper: Value;
  verdict: Verdict;
}

export interface ModelPassivity {
  method: Method;
  verdict: Verdict;
  symmetric_part: Verdict;
  published_rule: "passive" | "active";
  band_hz: [number, number];
  band_rule: string;
  min_index: Value;
  min_index_interval95: Interval;
  min_index_at_hz: number;
  nonpassive_below_hz: Value;
  conditions: Condition[];
  eop?: { corrected: Value; interval95: Interval; published_formula: Value; published_formula_interval95: Interval };
  index: { frequency_hz: Value[]; value: Value[]; lower95: Value[]; upper95: Value[] };
}

export interface EnergyAccount {
  verdict: Verdict;
  reason: string;
  absorbed_J: Value;
  interval95: Interval;
  duration_s: Value;
  mean_power_W: Value;
  mean_power_interval95: Interval;
  shortage: { at_end: Value; at_end_interval95: Interval; largest: Value; largest_interval95: Interval };
  blocks: number;
}

export interface Passivity {
  verdict: Verdict;
  decided_by: "model" | "energy";
  reason: string;
  explained_percent: Value;
  /** The one that speaks for the limb comes first. */
  models?: ModelPassivity[];
  energy?: EnergyAccount;
}

/** Energy in one recording. */
export interface Energy {
  window_s: [number, number];
  account: EnergyAccount;
  time_s: Value[];
  absorbed_J: Value[];
  parts_are: "perturbations" | "blocks";
  parts: { from_s: number; to_s: number; absorbed_J: Value; largest_displacement: Value; path_length: Value; shortage: Value }[];
  curl?: { k_a: Value; absorbed_J: Value; share: Value; over_time_J: Value[] };
}

export interface Instrument {
  reference: string;
  /** Of acceleration, velocity and position, each along all axes. */
  first_stage_F: Value[];
  weakest_F: Value;
  strong: boolean;
  answered_share: Value[];
}

/** The same measurement by the other method. */
export interface Alternative {
  method: Method;
  model: Model;
  standard_error: Model;
  fit: { VAF: Value[]; validated_on: string };
  usable: boolean;
  instrument?: Instrument;
}

export interface Disagreement {
  parameter: string;
  iv_less_ls: Value;
  standard_error: Value;
  significant: boolean;
}

export interface Bootstrap {
  replicates: number;
  block_s: number;
  seed: number;
  quantities: { name: string; unit: string; value: Value; interval95: Interval; delta_interval95: Interval }[];
}

export const methodNames: Record<Method, string> = { ls: "least squares", iv: "instrumental variables" };

// The document of schema mbk.report/1 that stands in the page.
import type { ComparisonReport, Failure, Method, Model, Report as ReportDocument, Summary } from "@mbk/shared/documents";
import type { Trial } from "@mbk/shared/result";

/** The document as the page goes through it. */
export interface Report {
  software: string;
  command: string;
  note: string | undefined;
  trials: Trial[];
  summary: Summary | undefined;
  /** Why there is no summary of several recordings. */
  noSummary: string | undefined;
  /** Recordings that could not be measured. */
  failed: Failure[];
}

/** Reads the document out of the page. Throws where it is none. */
export function readReport(json: ReportDocument): Report {
  if (json.schema !== "mbk.report/1") throw new Error(`schema ${String(json.schema)} is not mbk.report/1`);
  const { software, command, note, result } = json;
  const several = "results" in result;
  return {
    software,
    command,
    note,
    summary: several ? result.summary : undefined,
    noSummary: several ? result.no_summary : undefined,
    failed: (several ? result.failed : undefined) ?? [],
    trials: (several ? result.results : [result]).map((one, k) => ({ ...(json.trials[k] ?? { recordings: [] }), result: one })),
  };
}

/** The results of a comparison as a report has them, each with the name of its file. */
export function readComparison({ names, comparisons: _, ...document }: ComparisonReport): Report {
  const report = readReport({ ...document, schema: "mbk.report/1" });
  return { ...report, trials: report.trials.map((trial, k) => ({ ...trial, name: names[k] ?? "" })) };
}

export const basename = (path: string): string => path.split(/[\\/]/).at(-1) ?? path;

export const fileOf = (trial: Trial): string => trial.result.inputs.map((input) => basename(input.file)).join(", ");

/** The metadata of that key where all recordings of the trial agree. */
export function metadataOf(trial: Trial, key: string): string | undefined {
  const values = new Set(trial.recordings.map((one) => one.metadata[key]));
  return values.size === 1 ? [...values][0] : undefined;
}

export const participantOf = (trial: Trial): string | undefined => metadataOf(trial, "participant");

export const conditionOf = (trial: Trial): string | undefined =>
  metadataOf(trial, "condition") ?? metadataOf(trial, "truth_condition");

/** A recording that knows its own truth comes out of a simulation. */
export const isSimulated = (trial: Trial): boolean =>
  trial.recordings.some((one) => Object.keys(one.metadata).some((key) => key.startsWith("truth_")));

/** The model that a method found, and how sure it is; none where the document does not hold it. */
export function modelBy(method: Method, trial: Trial): { model: Model; standard_error: Model } | undefined {
  const { result } = trial;
  return result.method === method ? result : result.alternatives?.find((one) => one.method === method);
}

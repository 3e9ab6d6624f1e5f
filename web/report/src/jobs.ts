// What the jobs of many processes took: where their time went, what was lost, and each task.
import type { JobEfficiency } from "@mbk/shared/documents";
import { facts, h, heading, table } from "@mbk/shared/dom";
import { data, fixed, plain } from "@mbk/shared/format";
import { counted } from "./study_parts";

const seconds = (s: number): string => `${plain(s, 3)} s`;
const shareOf = (part: number, whole: number): string => (whole > 0 ? `${fixed((100 * part) / whole, 0)} %` : "–");

function lossTable(name: string, reasons: Record<string, number>): HTMLElement | "" {
  const rows = Object.entries(reasons).sort(([, a], [, b]) => b - a).map(([why, count]) => [String(count), why]);
  return rows.length > 0 ? table(name, ["how many", "reason"], rows, "left-out") : "";
}

/** Time from the first look at the job until its results were taken, as parts of one bar. */
function timeBar({ working_s, waiting_s, merge_s }: JobEfficiency): HTMLElement {
  const parts = ([["working", working_s], ["waiting", waiting_s], ["taking the results", merge_s]] as const).filter(([, s]) => s > 0);
  const whole = parts.reduce((sum, [, s]) => sum + s, 0);
  return h("div", { class: "job-time", role: "img", "aria-label": parts.map(([name, s]) => `${name} ${seconds(s)}`).join(", ") },
    ...parts.map(([name, s]) => h("span", { class: `job-${name.split(" ")[0]}`, style: `flex-grow: ${(s / whole).toFixed(4)}` })));
}

function jobBlock(job: JobEfficiency): HTMLElement {
  const { tasks = [] } = job;
  const whole = job.elapsed_s + job.merge_s;
  const done = job.finished_chunks < job.chunks ? `${job.finished_chunks} of ${job.chunks} chunks, ${job.finished_units} of ${job.units} units` : `${counted(job.units, "unit", "units")} in ${counted(job.chunks, "chunk", "chunks")}`;
  return h("div", { class: "job" },
    h("p", { class: "panel-title" }, job.title),
    timeBar(job),
    facts([
      ["Engine", job.engine || "none has looked after it yet"],
      ["Work", `${done}${job.failed_units > 0 ? `, ${job.failed_units} of them gave nothing` : ""}`],
      ["Throughput", h("span", {}, data(job.units_per_s, plain(job.units_per_s, 3), "units_per_s"), " units/s")],
      ["Working", `${seconds(job.working_s)}, ${shareOf(job.working_s, whole)} of the time; at most ${counted(job.most_at_a_time, "task", "tasks")} at a time, ${fixed(100 * job.busy, 0)} % of their time used`],
      ["Waiting", `${seconds(job.waiting_s)}, ${shareOf(job.waiting_s, whole)}`],
      ["Taking the results", job.merge_s > 0 ? `${seconds(job.merge_s)}, ${shareOf(job.merge_s, whole)}` : "not yet"],
      ["Processor busy", `${shareOf(job.cpu_s, job.wall_s)} of the tasks’ time`],
      ["Lost", job.lost_s > 0 ? seconds(job.lost_s) : undefined],
    ]),
    lossTable("Tasks that ended without a result, and were begun again", job.losses),
    lossTable("Units that gave nothing", job.failures),
    job.hosts.length > 1
      ? table("By machine", ["machine", "tasks", "units", "failed", "time [s]", "processor busy"],
        job.hosts.map((one) => [one.host, String(one.tasks), String(one.units), String(one.failed), plain(one.wall_s, 3), shareOf(one.cpu_s, one.wall_s)]), "values")
      : "",
    tasks.length > 0
      ? h("details", { class: "data-table" }, h("summary", {}, "Every task"),
        table("Every task", ["chunk", "machine", "units", "failed", "attempts", "expected [s]", "waited [s]", "worked [s]", "processor busy"],
          tasks.map((one) => [String(one.chunk), one.host, String(one.units), String(one.failed), String(one.attempts), plain(one.expected_s, 3), plain(one.waited_s, 3), plain(one.wall_s, 3), shareOf(one.cpu_s, one.wall_s)]), "values"))
      : h("p", { class: "reading" }, "There are too many tasks to list them."));
}

export function jobsSection(jobs: JobEfficiency[] = []): HTMLElement | undefined {
  if (jobs.length === 0) return undefined;
  return h("section", { id: "jobs" }, heading(2, "Computing by many processes"), ...jobs.map(jobBlock),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "),
      "Working: at least one task ran. Waiting: none did, while the scheduler or the file system was waited for. A task waits from being handed out until it runs. No result depends on any of this."));
}

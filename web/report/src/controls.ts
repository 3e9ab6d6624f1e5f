// The page of one participant: the last session beside the controls of the study, and left beside right.
import type { NormalRange, OutcomeRange, ParticipantReport, SideDifference, StretchCurve, StretchCurves, Value } from "@mbk/shared/documents";
import { h, heading, svg, table } from "@mbk/shared/dom";
import { data, fixed } from "@mbk/shared/format";
import { among, inOutcomeOrder, isFirst, isMain, outcomeName, plainly, signed, ticks, tickText } from "./outcomes";
import { saveable } from "./picture";
import { counted, csvOf, ofCondition, verdictWords } from "./study_parts";

const fewest = 5; // controls that a range needs, as in mbk

const speedText = ({ speed }: StretchCurve, { position_unit }: StretchCurves): string => `${fixed(speed, 0)} ${position_unit}/s`;
const directionText = ({ direction }: StretchCurves): string => `position ${direction > 0 ? "increasing" : "decreasing"}`;
const nameOf = (one: StretchCurves, all: StretchCurves[]): string =>
  [ofCondition(one.condition, [...new Set(all.map(({ condition }) => condition))]), all.some(({ direction }) => direction !== one.direction) ? directionText(one) : ""].filter(Boolean).join(", ");

const finite = (values: Value[]): number[] => values.filter((v): v is number => v !== null);

/** Low and high end of all lines and ranges, so that the panels can be compared. */
function torques(all: StretchCurves[]): [number, number] {
  const values = all.flatMap(({ speeds }) => speeds.flatMap(({ torque, low95, high95 }) => finite([...torque, ...low95, ...high95])));
  const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
  if (!(low < high)) return [Number.isFinite(low) ? low - 1 : 0, Number.isFinite(low) ? low + 1 : 1];
  return [low - 0.04 * (high - low), high + 0.04 * (high - low)];
}

/** Runs of points that have both coordinates, as one path. */
function path(points: [number, Value][], x: (v: number) => number, y: (v: number) => number): string {
  let pen = "M";
  return points.map(([at, value]) => {
    if (value === null) {
      pen = "M";
      return "";
    }
    const step = `${pen} ${x(at).toFixed(1)} ${y(value).toFixed(1)}`;
    pen = "L";
    return step;
  }).join(" ");
}

/** Resistance over position at one speed, over the range of the controls. */
function curvePanel(curve: StretchCurve, of: StretchCurves, [low, high]: [number, number], name: string): SVGSVGElement {
  const [width, height] = [190, 150];
  const position = of.position.map((one) => one ?? 0);
  const [from, to] = [Math.min(...position), Math.max(...position)];
  const marks = ticks(low, high, 4);
  const step = marks.length > 1 ? (marks[1] as number) - (marks[0] as number) : 1;
  const below = ticks(from, to, 3);
  const belowStep = below.length > 1 ? (below[1] as number) - (below[0] as number) : 1;
  const left = 10 + 7 * Math.max(...marks.map((at) => tickText(at, step).length));
  const [right, top, bottom] = [width - 10, 8, height - 22];
  const x = (value: number) => (from < to ? left + ((value - from) / (to - from)) * (right - left) : (left + right) / 2);
  const y = (value: number) => bottom - ((value - low) / (high - low)) * (bottom - top);
  const at = position.map((value, k) => ({ value, low: curve.low95[k] ?? null, high: curve.high95[k] ?? null })).filter((one): one is { value: number; low: number; high: number } => one.low !== null && one.high !== null);
  const edge = (points: [number, number][]) => points.map(([a, b]) => `${x(a).toFixed(1)} ${y(b).toFixed(1)}`);
  const band = [...edge(at.map((one) => [one.value, one.high])), ...edge(at.map((one) => [one.value, one.low])).reverse()];
  const points = (values: Value[]) => position.map((one, k): [number, Value] => [one, values[k] ?? null]);
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", class: "course curve-panel", "aria-label": `${name}, ${speedText(curve, of)}: resistance over position. ${beyondText(curve)}` },
    ...marks.map((one) => svg("line", { x1: left, x2: right, y1: y(one), y2: y(one), class: "grid" })),
    ...marks.map((one) => svg("text", { x: left - 5, y: y(one) + 4, "text-anchor": "end" }, tickText(one, step))),
    band.length > 0 && svg("path", { d: `M ${band.join(" L ")} Z`, class: "band" }),
    svg("line", { x1: left, x2: right, y1: bottom, y2: bottom, class: "origin" }),
    ...below.map((one) => svg("text", { x: x(one), y: bottom + 15, "text-anchor": "middle" }, tickText(one, belowStep))),
    svg("path", { d: path(points(curve.mean), x, y), class: "mean-line" }),
    svg("path", { d: path(points(curve.torque), x, y), class: "own-line" }));
}

const percent = (share: Value): string => `${fixed(100 * (share ?? 0), 0)}\u00a0%`;

/** Where the line is beside the range. */
function beyondText({ above, below, controls }: StretchCurve): string {
  if (above === null || below === null) return controls < fewest ? `No range: ${counted(controls, "control", "controls")}; ${fewest} are needed.` : "No range: the controls do not vary, or share no position.";
  const parts = [...(above > 0 ? [`above the range at ${percent(above)}`] : []), ...(below > 0 ? [`below it at ${percent(below)}`] : [])];
  return `${parts.length > 0 ? `${parts.join(", ")} of the positions` : "within the range everywhere"} (${controls} controls)`.replace(/^./, (c) => c.toUpperCase());
}

const curvesCsv = (all: StretchCurves[]): string =>
  csvOf(["condition", "session", "direction", "speed", "position", "torque", "controls", "controls_mean", "controls_low95", "controls_high95"],
    all.flatMap(({ condition, session, direction, position, speeds }) => speeds.flatMap((curve) => position.map((at, k) =>
      [condition, session, direction, curve.speed, at, curve.torque[k] ?? null, curve.controls, curve.mean[k] ?? null, curve.low95[k] ?? null, curve.high95[k] ?? null]))));

function stretchFigure(all: StretchCurves[], compared: boolean): HTMLElement {
  const ranged = all.some(({ speeds }) => speeds.some(({ above }) => above !== null));
  const entry = (drawing: SVGElement, text: string) => h("li", {}, svg("svg", { width: 24, height: 12, "aria-hidden": "true", class: "course" }, drawing), text);
  const line = (kind: string) => svg("line", { x1: 0, x2: 24, y1: 6, y2: 6, class: kind });
  const blocks = all.map((one) => {
    const range = torques(all.filter(({ torque_unit }) => torque_unit === one.torque_unit));
    const name = nameOf(one, all);
    return h("div", { class: "courses-block", "data-condition": one.condition, "data-direction": one.direction },
      h("p", { class: "panel-title" }, `${name ? `${name}: ` : ""}resistance [${one.torque_unit}] over position [${one.position_unit}], session ${one.session}`),
      h("div", { class: "small-panels wide" }, ...one.speeds.map((curve) => h("div", { class: "small-panel" },
        h("p", { class: "panel-name" }, speedText(curve, one)), curvePanel(curve, one, range, name),
        compared ? h("p", { class: "panel-note" }, beyondText(curve)) : ""))));
  });
  return saveable(h("figure", { class: "stretch-curves" },
    h("ul", { class: "legend" }, entry(line("own-line"), "this participant"), ranged && entry(line("mean-line"), "mean of the controls"),
      ranged && entry(svg("rect", { x: 0.5, y: 0.5, width: 23, height: 11, class: "band" }), "range of the controls (95 %)")),
    ...blocks,
    h("figcaption", {}, h("strong", {}, "How to read this. "), "Each panel is one speed of the stretch. The slowest shows weight, elasticity and an unknown offset; what is added at higher speeds depends on speed.",
      ranged ? " At each position, 95 % of further people like the controls are expected in the range. Over all positions and speeds, the line of a healthy person leaves it more often." : "")),
    { name: "stretches", title: "Resistance to stretches", csv: () => curvesCsv(all) });
}

/** "0.10 to 0.14 (8)" */
function rangeCell(normal: NormalRange, without = 0): HTMLElement | string {
  const [low, high] = [normal.range95[0] ?? null, normal.range95[1] ?? null];
  const left = without + normal.not_comparable;
  const people = left > 0 ? `${normal.controls} of ${normal.controls + left}` : String(normal.controls);
  if (low === null || high === null) return normal.controls < fewest ? `not known: ${people} controls; ${fewest} are needed` : "not known: the controls do not vary";
  const size = high - low;
  return h("span", { class: "number" }, data(low, among(low, size), "range-low"), " to ", data(high, among(high, size), "range-high"), h("span", { class: "half" }, ` (${people})`));
}

const rangeWords: Record<OutcomeRange["verdict"], { text: string; kind: string }> = {
  inside: { text: "within the range", kind: "" },
  above: { text: "above the range", kind: "care-text" },
  below: { text: "below the range", kind: "care-text" },
  unknown: { text: "not known", kind: "" },
};

const rangeResult = (verdict: OutcomeRange["verdict"], why?: string): HTMLElement =>
  h("span", { class: rangeWords[verdict].kind }, why ? `not comparable: ${why}` : rangeWords[verdict].text);

const labelled = ({ outcome, unit }: { outcome: string; unit: string }): string => (unit ? `${outcomeName(outcome)} [${unit}]` : outcomeName(outcome));

/** Those that the page shows: ellipses, or what stands for them. */
const shown = <T extends { outcome: string }>(all: T[]): T[] => all.filter(({ outcome }) => (all.some((one) => isFirst(one.outcome)) ? isFirst : isMain)(outcome));

function rangeTables(ranges: OutcomeRange[]): HTMLElement[] {
  const conditions = [...new Set(ranges.map(({ condition }) => condition))];
  return conditions.flatMap((condition) => {
    const all = inOutcomeOrder(shown(ranges).filter((one) => one.condition === condition), ({ outcome }) => outcome);
    const first = all[0];
    if (!first) return [];
    const name = ofCondition(condition, conditions);
    return [table(`${name ? `${name}: ` : ""}session ${first.session} beside the range of the controls (in parentheses: how many)`, ["outcome", "this participant", "range of the controls", "result"],
      all.map((one) => [labelled(one), data(one.value, among(one.value, width(one.normal) ?? one.value), "value"), rangeCell(one.normal, one.without), rangeResult(one.verdict, one.why_not_comparable)]), "changes ranges")];
  });
}

const width = ({ range95 }: NormalRange): Value => {
  const [low, high] = [range95[0] ?? null, range95[1] ?? null];
  return low === null || high === null ? null : high - low;
};

/** The last session beside the controls; nothing where there are neither stretches nor controls. */
export function controlsSection({ controls, stretches, ranges }: ParticipantReport): HTMLElement | undefined {
  if (!controls && stretches.length === 0) return undefined;
  const who = controls ? `The range is from ${counted(controls.participants, "participant", "participants")} of the group “${controls.name}”, each with the last session${controls.is_one ? "; this participant is one of the group and was left out" : ""}.` : "";
  return h("section", { id: "controls" }, heading(2, controls ? "Last session beside the controls" : "Resistance to stretches in the last session"),
    who ? h("p", { "data-name": "controls" }, who) : h("p", { "data-name": "controls" }, "No controls were named, so this page cannot show what is usual (--group)."),
    stretches.length > 0 ? stretchFigure(stretches, controls !== undefined) : "",
    ...rangeTables(ranges));
}

function sideError(one: SideDifference): HTMLElement | string {
  if (one.why_not_comparable) return "–";
  if (one.error95 === null) return "not known";
  const [low, high] = [one.error95_interval[0] ?? null, one.error95_interval[1] ?? null];
  return h("span", { class: "number" }, data(one.error95, plainly(one.error95), "error"),
    h("span", { class: "half" }, low === null || high === null ? " (recordings only)" : ` [${among(low, one.error95)}, ${among(high, one.error95)}]`));
}

const sideWords: Record<SideDifference["verdict"], string> = {
  "beyond-error": "more than measurement error",
  uncertain: "more than the error, which is uncertain",
  "within-error": "no detectable difference",
  unknown: verdictWords.unknown.text,
};

/** Left less right; nothing where no conditions name sides. */
export function sidesSection({ sides, controls }: ParticipantReport): HTMLElement | undefined {
  const pairs = new Map<string, SideDifference[]>();
  for (const one of shown(sides)) {
    const key = `${one.left_condition} and ${one.right_condition}`;
    pairs.set(key, [...(pairs.get(key) ?? []), one]);
  }
  if (pairs.size === 0) return undefined;
  const whys = new Set(shown(sides).flatMap(({ error_basis, why_unknown }) => (error_basis !== "sessions" && why_unknown ? [why_unknown] : [])));
  const tails = shown(sides).some(({ heavy_tails }) => heavy_tails);
  return h("section", { id: "sides" }, heading(2, "Left and right"),
    ...[...pairs].map(([name, all]) => table(`${name}, session ${[...new Set(all.map(({ session }) => session))].join(", ")}: left − right, with the size that 95 % of measurement errors do not exceed`,
      ["outcome", "left", "right", "left − right", "error", "result", ...(controls ? ["range of the controls", "beside it"] : [])],
      inOutcomeOrder(all, ({ outcome }) => outcome).map((one) => {
        const size = Math.max(Math.abs(one.difference ?? 0), one.error95 ?? 0);
        return [labelled(one), data(one.left, among(one.left, size)), data(one.right, among(one.right, size)), data(one.difference, signed(one.difference, size), "side-difference"), sideError(one),
          h("span", { class: one.verdict === "beyond-error" ? "care-text" : "" }, one.why_not_comparable ? `not comparable: ${one.why_not_comparable}` : sideWords[one.verdict]),
          ...(controls ? (one.why_not_comparable ? ["–", "–"] : [rangeCell(one.normal), rangeResult(one.range_verdict, one.why_no_comparable_range)]) : [])];
      }), "changes sides")),
    h("p", { class: "reading" }, h("strong", {}, "How to read this. "), "The error is from how left − right varies between sessions of other people of the study; brackets are its 95 % interval. ",
      ...[...whys].map((why) => `That is not known (${why}); “recordings only” is the error of these recordings without the variation between sessions, so nothing is claimed. `),
      tails ? "Some of these errors have heavier tails than a normal distribution, so nothing is certain. " : "",
      "Healthy people differ between sides too, by handedness and by how the arms are fixed."));
}

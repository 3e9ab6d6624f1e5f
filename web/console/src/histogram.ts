// How long ticks took, and how late they came: counts over a logarithmic time.
import type { Times } from "@mbk/shared/documents";
import { h, svg } from "@mbk/shared/dom";
import { significant } from "@mbk/shared/format";

const [low, high] = [1, 1e5]; // [µs]
const [width, height, foot] = [420, 74, 22];
const x = (us: number): number => (width * Math.log(Math.min(Math.max(us, low), high) / low)) / Math.log(high / low);
const labels: [number, string][] = [[1, "1 µs"], [10, "10"], [100, "100 µs"], [1000, "1 ms"], [10000, "10"], [100000, "100 ms"]];

export function time(us: number): string {
  return us < 1000 ? `${significant(us)} µs` : `${significant(us / 1000)} ms`;
}

export function histogram(title: string, times: Times, period: number): HTMLElement {
  const most = Math.max(1, ...times.bins.map(([, , count]) => count));
  const tall = (count: number): number => (height * Math.log1p(count)) / Math.log1p(most);
  return h(
    "figure",
    { class: "histogram" },
    h("figcaption", {}, h("strong", {}, title), ` median ${time(times.median_us)}, 99.9 % within ${time(times.p999_us)}, worst ${time(times.worst_us)}`),
    svg(
      "svg",
      { viewBox: `-18 -2 ${width + 44} ${height + foot + 2}`, role: "img", "aria-label": `${title}: histogram, both axes logarithmic` },
      ...times.bins.map(([from, to, count]) =>
        svg("rect", { x: x(from), y: height - tall(count), width: Math.max(x(to) - x(from) - 0.6, 1), height: tall(count), class: "bar" })),
      svg("line", { x1: x(period), y1: 0, x2: x(period), y2: height, class: "period" }),
      svg("line", { x1: 0, y1: height, x2: width, y2: height, class: "base" }),
      ...labels.map(([us, label]) => svg("text", { x: x(us), y: height + 17, "text-anchor": "middle" }, label)),
    ),
  );
}

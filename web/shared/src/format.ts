// Numbers as they are read: minus signs, digits that mean something, and every digit for machines beside them.
import type { Value } from "./documents";
import { h } from "./dom";

export const normal95 = 1.959963984540054;
export const undefinedText = "undefined";
const longest = 1e7; // beyond it the digits before the point say nothing

const minus = (text: string): string => text.replaceAll("-", "−");

export function fixed(value: Value | undefined, decimals: number): string {
  if (value === null || value === undefined) return undefinedText;
  if (Math.abs(value) >= longest) return significant(value);
  const text = value.toFixed(Math.min(Math.max(decimals, 0), 12));
  return minus(Number(text) === 0 ? text.replace("-", "") : text);
}

/** So many significant digits, without an exponent where that is readable. */
export function significant(value: Value | undefined, digits = 3): string {
  if (value === null || value === undefined) return undefinedText;
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  if (magnitude < -4 || magnitude > 5) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e") as [string, string];
    return `${minus(mantissa)}·10${superscript(String(Number(exponent)))}`;
  }
  return fixed(value, digits - 1 - magnitude);
}

/** Without zeros at the end: for values that were chosen, such as a rate. */
export const plain = (value: Value | undefined, digits = 6): string =>
  value === null || value === undefined ? undefinedText : minus(String(Number(value.toPrecision(digits))));

export function superscript(text: string): string {
  return [...text].map((c) => (c === "-" ? "⁻" : ("⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(c)] ?? c))).join("");
}

/** Decimals that show two significant digits of a half width. */
export function decimalsFor(half: Value): number {
  if (half === null || !(half > 0)) return 3;
  return Math.min(Math.max(1 - Math.floor(Math.log10(half)), 0), 9);
}

/** A number with all its digits in the element's value, as the JSON has it. */
export function data(value: Value | undefined, shown: string, name?: string): HTMLElement {
  return h("data", { value: value ?? "null", ...(name ? { "data-name": name } : {}) }, shown);
}

/** 34 ± 15 */
export function withHalfWidth(value: Value, standardError: Value, name: string, scale = 1): HTMLElement {
  const half = standardError === null ? null : scale * normal95 * standardError;
  const scaled = value === null ? null : scale * value;
  if (half === null) return h("span", { class: "number" }, data(scaled, significant(scaled, 4), name));
  const decimals = decimalsFor(half);
  return h(
    "span",
    { class: "number" },
    data(scaled, fixed(scaled, decimals), name),
    h("wbr"),
    h("span", { class: "half" }, " ± ", data(half, fixed(half, decimals), `${name}-half`)),
  );
}

/** "98.7 [92.5, 104.9]", each number as `shown`, to three digits unless told otherwise. */
export function valueWithInterval(value: Value, [low, high]: [Value, Value], name: string, shown: (number: Value) => string = significant): HTMLElement {
  const known = low !== null && high !== null;
  return h(
    "span",
    { class: "number" },
    data(value, shown(value), name),
    known ? h("wbr") : "",
    known ? h("span", { class: "half" }, " [", data(low, shown(low), `${name}-low`), ", ", data(high, shown(high), `${name}-high`), "]") : "",
  );
}

/** 98.7 [92.5, 104.9] */
export const withInterval = (value: Value, interval: [Value, Value], name: string, decimals: number): HTMLElement =>
  valueWithInterval(value, interval, name, (number) => fixed(number, decimals));

/** "x 77.3 %, y 88.5 %"; with one axis "77.3 %" */
export function perAxis(values: Value[], decimals: number, unit: string, name: string): HTMLElement {
  const parts: (Node | string)[] = [];
  values.forEach((value, axis) => {
    if (axis > 0) parts.push(", ");
    if (values.length > 1) parts.push(`${"xyz"[axis]} `);
    parts.push(data(value, fixed(value, decimals), `${name}${axis}`), value === null ? "" : ` ${unit}`);
  });
  return h("span", { class: "number" }, ...parts);
}

/** "a, b and c" */
export function listed(words: string[]): string {
  return words.length < 2 ? (words[0] ?? "") : `${words.slice(0, -1).join(", ")} and ${words.at(-1)}`;
}

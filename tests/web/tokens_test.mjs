// Contrast of the colours that all pages share, on light and on dark screens, as WCAG 2.2 asks at level AA.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";

const [text, graphics] = [4.5, 3]; // success criteria 1.4.3 and 1.4.11
const tokens = (name) => Object.fromEntries([...readFileSync(join(process.cwd(), "shared", "src", name), "utf8").matchAll(/(--[a-z-]+): (#[0-9a-f]+);/g)].map(([, token, colour]) => [token, colour]));
const light = tokens("tokens.css");
const dark = tokens("dark.css");

function luminance(colour) {
  const digits = colour.length === 4 ? [...colour.slice(1)].map((digit) => digit + digit) : colour.slice(1).match(/../g);
  const [r, g, b] = digits.map((two) => parseInt(two, 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
function contrast(one, other) {
  const [darker, lighter] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (lighter + 0.05) / (darker + 0.05);
}

const surfaces = ["--paper", "--wash", "--hover", "--blue-wash", "--good-wash", "--care-wash", "--bad-wash"];
const pairs = [
  ...["--ink", "--soft", "--blue", "--good", "--care", "--bad", "--violet"].flatMap((ink) => surfaces.map((surface) => [ink, surface, text])),
  ["--on-blue", "--blue", text], ["--on-bad", "--bad", text], ["--label", "--paper", text],
  ...["--first", "--second", "--third", "--axis", "--edge"].map((line) => [line, "--paper", graphics]),
];

for (const [name, colours] of [["light", light], ["dark", dark]]) {
  test(`text and lines of the shared colours can be read: ${name}`, () => {
    const low = pairs.map(([one, other, least]) => [one, other, contrast(colours[one], colours[other]), least]).filter(([, , found, least]) => !(found >= least));
    assert.deepEqual(low, []);
  });
}

test("every colour has its dark one", () => assert.deepEqual(Object.keys(dark).sort(), Object.keys(light).sort()));

test("the contrast of black on white is 21, and of a colour with itself 1", () => {
  assert.ok(Math.abs(contrast("#000", "#ffffff") - 21) < 1e-9);
  assert.equal(contrast("#0072b2", "#0072b2"), 1);
});

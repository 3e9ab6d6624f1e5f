// The report of mbk explore in a browser: its numbers are those of --json, it is quiet, offline, accessible and printable.
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { changed, close, closeBrowser, drawn, folder, makeLog, mbk, numbers, onPage, picture, simulate, violationsInBoth } from "./browser.mjs";
import { join } from "node:path";

after(closeBrowser);

function explore(name, ...args) {
  const ran = mbk("explore", ...args, "--json", "--report", `${name}.html`);
  if (ran.code !== 0) throw new Error(ran.err);
  return { json: JSON.parse(ran.out), file: join(folder, `${name}.html`) };
}

const arm = explore("arm", makeLog("arm.mat", "--protocol", "sinusoidal", "--seed", "4", "--coloured-force-noise", "0.3"), "--report-note", "Ward 3");
const joint = explore("joint", simulate("joint.mat", "ankle_reflex"), "--axes", "1");

const muscles = explore("muscles", simulate("elbow.h5", "elbow_perturbed"), "--only", "reflex", "--muscles", "biceps,triceps");

const onWholePage = (file, look) => onPage(file, async (page) => {
  await drawn(page);
  await look(page);
});

test("a reflex is said with its gain, and the bars are the shares of --json", () => onWholePage(joint.file, async (page) => {
  const { parallel_cascade: cascade } = joint.json;
  assert.equal(cascade.delayed_response, "reflex");
  assert.match(await page.textContent("#summary"), /a reflex/);
  close((await numbers(page, "#reflex"))["reflex-gain"].value, cascade.reflex.gain_along.value, "gain");
  const bars = await page.$$eval("svg.parts rect.share", (all) => all.map((bar) => Number(bar.getAttribute("width"))));
  const shares = ["intrinsic_alone", "both", "intrinsic_path", "reflex_path"].map((part) => Math.max(cascade.shares[0][part].VAF, 0));
  assert.equal(bars.length, shares.length);
  bars.forEach((bar, k) => assert.ok(Math.abs(bar / bars[1] - shares[k] / shares[1]) < 1e-3, `${bars} ${shares}`));
}));

test("the force that EMG explains has the shares, gains and coherence of --json", () => onWholePage(muscles.file, async (page) => {
  const { emg } = muscles.json.parallel_cascade;
  assert.match(await page.textContent("h1"), /Force response/);
  assert.match(await page.textContent("#summary"), emg.explains ? /EMG explains force/ : /EMG was not shown/);
  close((await numbers(page, "#reflex"))["emg-intrinsic"].value, emg.shares[0].intrinsic_and_emg.VAF, "VAF");
  const text = await page.textContent("#reflex");
  for (const { channel } of emg.muscles) assert.ok(text.includes(channel));
  for (const band of emg.coherence) assert.ok(text.includes(band.motion_and_emg[0].toFixed(2)), text);
}));

test("M, B and K and both shares of the force are those of --json", () => onWholePage(arm.file, async (page) => {
  const { impulse_response: found } = arm.json;
  const read = await numbers(page, "#impulse-response");
  found.explained.forEach((one, k) => close(read[`irf-VAF${k}`].value, one.VAF, "VAF"));
  for (const name of ["M", "B", "K"]) found.model[name].value.flat().forEach((value, k) => close(read[`irf-${name}${Math.floor(k / 2)}${k % 2}`].value, value, name));
  assert.match(await page.textContent("#impulse-response"), found.model.enough.enough ? /are sufficient/ : /are not sufficient/);
}));

test("each response has a Bode plot with its interval, and the disc of each frequency in the complex plane", () => onWholePage(arm.file, async (page) => {
  const { frequency_response: found } = arm.json;
  assert.equal(await page.locator("figure.chart-figure .chart[id^=bode-]").count(), found.responses.length);
  const figure = page.locator("figure.chart-figure", { has: page.locator("#bode-0") });
  await figure.locator("details.data-table summary").focus();
  await page.keyboard.press("Enter");
  const row = figure.locator("table.values tbody tr").first();
  await row.waitFor();
  const cells = (await row.locator("td").allTextContents()).map((text) => parseFloat(text.replaceAll("−", "-")));
  assert.ok(Math.abs(cells[0] / found.frequency_hz[0] - 1) < 1e-3, cells.join(" "));
  assert.ok(Math.abs(cells[1] / found.responses[0].magnitude[0] - 1) < 1e-3, cells.join(" "));
  const regions = await page.locator("svg.nyquist[role=img]").first().locator(".region ellipse").count();
  const { region95_radius: radius, magnitude } = found.responses[0];
  assert.equal(regions, radius.filter((one, k) => one < magnitude[k]).length, "a disc that holds 0 is not drawn");
  assert.ok(regions > 3);
}));

for (const [name, { file }] of Object.entries({ arm, joint, muscles })) {
  test(`axe finds no violation: ${name}`, () => onWholePage(file, async (page) => {
    await page.$$eval("details", (all) => all.forEach((one) => (one.open = true)));
    assert.deepEqual(await violationsInBoth(page), []);
    await picture(page, `explore-${name}`);
  }));
}

test("parts that are absent are left out, and undefined numbers are no error", async () => {
  const none = changed(arm.file, "nothing", ({ result }) => {
    for (const part of ["frequency_response", "impulse_response", "parallel_cascade"]) delete result[part];
  });
  await onWholePage(none, async (page) => assert.equal(await page.locator("figure.chart-figure").count(), 0));
  const undefinedNumbers = changed(arm.file, "undefined", ({ result }) => {
    for (const one of result.frequency_response.responses) {
      for (const [key, values] of Object.entries(one)) if (Array.isArray(values)) one[key] = values.map((value) => (Array.isArray(value) ? value.map(() => null) : null));
    }
  });
  await onWholePage(undefinedNumbers, async (page) => assert.match(await page.textContent("#frequency-response"), /There is no Nyquist plot/));
});

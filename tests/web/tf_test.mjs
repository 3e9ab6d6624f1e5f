// The report of mbk tf in a browser: its numbers are those of --json, it is quiet, offline, accessible and printable.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { after, test } from "node:test";
import { assertShown, changed, close, closeBrowser, documentOf, drawn, folder, makeLog, mbk, numbers, onPage, picture, reading, simulate, violations, violationsInBoth } from "./browser.mjs";
import { join } from "node:path";

after(closeBrowser);

const normal95 = 1.959963984540054;

function identify(name, ...args) {
  const ran = mbk("tf", ...args, "--json", "--report", `${name}.html`);
  if (ran.code !== 0) throw new Error(ran.err);
  return { json: JSON.parse(ran.out), file: join(folder, `${name}.html`) };
}

// without its reflex the joint is linear
const scenario = join(folder, "joint.toml");
writeFileSync(scenario, mbk("simulate", "--show", "ankle_reflex").out.replace(/^gain_Nms.*$/m, "gain_Nms_per_rad = 0"));
const joint = simulate("joint.mat", scenario);
const arm = makeLog("arm.mat", "--protocol", "sinusoidal", "--seed", "4", "--coloured-force-noise", "0.3");
const inverted = identify("inverted", joint, "--input=-F", "--output", "x", "--reference", "xr", "--method", "clsrivc", "--poles", "2", "--zeros", "0", "--invert", "position");
const chosen = identify("chosen", arm, "--input", "Fx", "--output", "x", "--orders", "1:3", "--delay", "0.002", "--report-note", "Ward 3");

/** A discrete model in the place of a continuous one: only what the page shows of it. */
const discrete = changed(chosen.file, "discrete", ({ result }) => {
  result.method = "oe";
  result.variable = "q^-1";
  result.numerator = [0, 0.25];
  result.denominator = [1, -1.5, 0.75];
});

const onWholePage = (file, look) => onPage(file, async (page) => {
  await drawn(page);
  await look(page);
});

test("coefficients, poles, zeros and gain are those of --json", () => reading(chosen.file, async (page) => {
  const { json } = chosen;
  const read = await numbers(page, "main");
  for (const { name, value, standard_error } of json.parameters) {
    close(read[name].value, value, name);
    close(read[`${name}-half`].value, normal95 * standard_error, `± ${name}`);
  }
  for (const kind of ["pole", "zero"]) {
    json[`${kind}s`].forEach((root, k) => {
      close(read[`${kind}${k}-frequency`].value, root.frequency_hz, kind);
      close(read[`${kind}${k}-frequency-half`].value, normal95 * root.frequency_standard_error_hz, kind);
      if (root.pair) close(read[`${kind}${k}-damping`].value, root.damping, kind);
    });
  }
  close(read.gain.value, json.gain, "gain");
  for (const [name, number] of Object.entries(read)) if (name !== "explained") assertShown(number, name);
}));

test("a delay that was found has its interval, and the input between samples is described", async () => {
  await reading(chosen.file, async (page) => {
    assert.match(await page.textContent("#summary"), /a delay of 0\.002 s\. The model/);
    assert.match(await page.textContent("#hold"), chosen.json.hold === "zero" ? /zero-order hold/ : /first-order hold/);
  });
  const found = changed(chosen.file, "found-delay", ({ result }) => Object.assign(result, { delay_found: true, delay_standard_error_s: 1e-4, hold: "zero", hold_found: true }));
  await onWholePage(found, async (page) => {
    const read = await numbers(page, "#summary");
    close(read.delay.value, 0.002, "delay");
    close(read["delay-half"].value, normal95 * 1e-4, "± delay");
    assert.match(await page.textContent("#hold"), /zero-order hold\), as its steps show/);
  });
  const none = changed(found, "no-delay", ({ result }) => Object.assign(result, { delay_s: 0 }));
  await onWholePage(none, async (page) => close((await numbers(page, "#summary")).delay.value, 0, "a delay of zero that was found has its interval"));
  const asked = changed(chosen.file, "asked-hold", ({ result }) => Object.assign(result, { delay_found: true, hold: "first", hold_found: false }));
  await onWholePage(changed(asked, "no-interval", ({ result }) => delete result.delay_standard_error_s), async (page) => {
    assert.match(await page.textContent("#summary"), /counts as known in the intervals/);
    assert.match(await page.textContent("#hold"), /first-order hold\), as asked/);
  });
});

test("the formula is the model, in s with a delay and in q", async () => {
  await reading(inverted.file, async (page) => assert.match(await page.getAttribute(".formula", "aria-label"), /^G\(s\) = \([\d.]+\) \/ \(s² \+ [\d.]+ s \+ [\d.]+\)/));
  await reading(chosen.file, async (page) => assert.match(await page.textContent(".formula"), /e−0\.002 s/));
  await reading(discrete, async (page) => assert.match(await page.getAttribute(".formula", "aria-label"), /^G\(q\) = \(0\.25 q⁻¹\) \/ \(1 − 1\.5 q⁻¹ \+ 0\.75 q⁻²\)/));
});

test("the impedance has the M, B, K of --json", () => reading(inverted.file, async (page) => {
  const read = await numbers(page, "#impedance");
  for (const name of ["M", "B", "K"]) {
    const { value, standard_error } = inverted.json.impedance[name];
    close(read[`impedance-${name}`].value, value, name);
    close(read[`impedance-${name}-half`].value, normal95 * standard_error, name);
  }
  assert.match(await page.textContent("#impedance"), /N·m·s\/rad/);
}));

test("the table of orders has every model and says which was chosen", () => reading(chosen.file, async (page) => {
  const rows = await page.$$eval("#orders tbody tr", (all) => all.map((row) => row.textContent));
  assert.equal(rows.length, chosen.json.orders.length);
  rows.forEach((row, k) => assert.equal(/chosen/.test(row), chosen.json.orders[k].chosen, row));
}));

test("the Bode plot holds the response and both ends of its interval", () => onWholePage(chosen.file, async (page) => {
  const figure = page.locator("figure.chart-figure", { has: page.locator("#bode") });
  await figure.locator("details.data-table summary").focus();
  await page.keyboard.press("Enter");
  const row = figure.locator("table.values tbody tr").first();
  await row.waitFor();
  const cells = await row.locator("td").allTextContents();
  const { frequency_response: r } = chosen.json;
  const got = cells.slice(0, 2).map((text) => parseFloat(text.replaceAll("−", "-")));
  assert.ok(Math.abs(got[0] / r.frequency_hz[0] - 1) < 1e-3, cells.join(" "));
  assert.match(await figure.locator("table.values thead").textContent(), /95 % interval, low/);
  assert.equal(await figure.locator(".legend", { hasText: "excited band" }).count(), 1);
}));

test("the Nyquist plot has one scale, its marks on the curve, and an ellipse for each frequency of the band", () => reading(chosen.file, async (page) => {
  const { frequency_response: r, excited_band_hz: [low, high] } = chosen.json;
  const drawn = await page.$eval("svg.nyquist[role=img]", (svg) => ({
    ellipses: [...svg.querySelectorAll(".region ellipse")].map((e) => [Number(e.getAttribute("rx")), Number(e.getAttribute("ry")), e.getAttribute("transform")]),
    label: svg.getAttribute("aria-label"),
  }));
  const inside = r.frequency_hz.map((f, k) => ({ f, k })).filter(({ f }) => f >= low && f <= high).map(({ k }) => k);
  assert.equal(drawn.ellipses.length, inside.length);
  const place = drawn.ellipses.map(([, , transform]) => /translate\((\S+) (\S+)\)/.exec(transform).slice(1).map(Number));
  const [first, last] = [0, Math.floor(inside.length / 2)];
  const scale = (place[last][0] - place[first][0]) / (r.real[inside[last]] - r.real[inside[first]]);
  const up = -(place[last][1] - place[first][1]) / (r.imaginary[inside[last]] - r.imaginary[inside[first]]);
  assert.ok(Math.abs(up / scale - 1) < 0.02, `${up} ${scale}`);
  drawn.ellipses.forEach(([rx], k) => assert.ok(Math.abs(rx - scale * r.region95.longer_half_axis[inside[k]]) < 0.05 + 0.02 * rx));
  assert.ok(drawn.label.length > 40);
}));

for (const [name, file] of Object.entries({ inverted: inverted.file, chosen: chosen.file, discrete })) {
  test(`axe finds no violation: ${name}`, () => onWholePage(file, async (page) => {
    await page.$$eval("details", (all) => all.forEach((one) => (one.open = true)));
    assert.deepEqual(await violationsInBoth(page), []);
  }));
}

test("undefined numbers are said to be undefined, and nothing to draw is no error", () => {
  const file = changed(inverted.file, "undefined", (document) => {
    const none = (value) => (Array.isArray(value) ? value.map(none) : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, none(v)])) : typeof value === "number" ? null : value);
    const { result } = document;
    for (const key of ["parameters", "poles", "gain", "frequency_response", "impedance", "fit", "excited_band_hz", "residuals"]) result[key] = none(result[key]);
    document.simulation = { held_out: false, time_s: [], measured: [], simulated: [] };
    result.usable = false;
  });
  return onWholePage(file, async (page) => {
    assert.match(await page.textContent(".verdict"), /Not usable/);
    assert.doesNotMatch(await page.textContent("main"), /NaN|null|Infinity|\[object/);
    assert.deepEqual(await violations(page), []);
  });
});

test("what stands in a recording or an option stays text, and the same options give the same bytes", async () => {
  const hostile = "</script><img src=x onerror=\"document.title='owned'\">";
  const args = [joint, "--input=-F", "--output", "x", "--poles", "2", "--zeros", "0", "--report-note", hostile];
  const one = identify("hostile", ...args);
  await onWholePage(one.file, async (page) => {
    assert.equal(await page.textContent(".note"), hostile);
    assert.notEqual(await page.title(), "owned");
  });
  const before = documentOf(one.file);
  assert.equal(mbk("tf", ...args, "--report", "hostile.html", "--overwrite").code, 0);
  const again = documentOf(one.file);
  assert.deepEqual({ ...again, command: "" }, { ...before, command: "" });
});

test("pictures of each kind, and A4 pages on which nothing is too wide", async () => {
  for (const [name, file] of Object.entries({ "tf-inverted": inverted.file, "tf-orders": chosen.file, "tf-discrete": discrete })) {
    await onWholePage(file, async (page) => {
      const pages = (await picture(page, name)).toString("latin1").match(/\/Type \/Page\b/g).length;
      assert.ok(pages >= 3 && pages <= 10, `${name}: ${pages} pages`);
      await page.emulateMedia({ media: "print" });
      await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
      const widths = await page.$$eval(".chart svg, svg.nyquist[role=img]", (all) => all.map((one) => one.getBoundingClientRect().width));
      assert.ok(Math.max(...widths) <= 794 - 2 * 60, widths.join(" "));
    });
  }
});

// Passivity, energy, methods and uncertainty in the report: the page says what the JSON says, and leaves out what is absent.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, test } from "node:test";
import { assertShown, changed, close, closeBrowser, documentOf, drawn, makeLog, measure, numbers, onPage, reading, simulate, violations, violationsInBoth } from "./browser.mjs";

after(closeBrowser);

const normal95 = 1.959963984540054;
const pairs = (n) => Array.from({ length: n * n }, (_, k) => [Math.floor(k / n), k % n]);

const rigid = simulate("rigid.mat", "rigid_sinusoidal_6N", "--seed", "1");
const pushed = simulate("pushed.mat", "rigid_underdamped_2N", "--seed", "1");
const joint = makeLog("joint.mat", "--protocol", "sinusoidal", "--one-axis");

const undecided = measure("undecided", rigid, "--bootstrap", "60");
const active = measure("active", pushed);
const oneAxis = measure("one-axis", joint, "--bootstrap", "60");
const several = measure("several", rigid, pushed);
const all = { undecided, active, oneAxis };

/** Value and both ends, as withInterval writes them. */
function assertInterval(read, name, value, [low, high]) {
  close(read[name].value, value, name);
  if (low === null || high === null) return;
  close(read[`${name}-low`].value, low, `${name} low`);
  close(read[`${name}-high`].value, high, `${name} high`);
}

const assertAllShown = (read) => Object.entries(read).forEach(([name, number]) => assertShown(number, name));

for (const [name, { json, file }] of Object.entries(all)) {
  test(`both statements are a word, a sign and the sentence of the JSON: ${name}`, () => reading(file, async (page) => {
    const { passivity } = json;
    const signs = { passive: "✓", active: "✕", undecided: "?", none: "–" };
    for (const what of ["trial", "prediction"]) {
      const card = page.locator(`#trial-1-passivity .verdict[data-statement=${what}]`);
      const { verdict, statement } = passivity[what];
      assert.equal(await card.getAttribute("data-verdict"), verdict);
      assert.equal(await card.locator("strong").textContent(), verdict);
      assert.equal(await card.locator(".sign").textContent(), signs[verdict]);
      const said = await card.locator(`[data-name=${what}-statement]`).textContent();
      assert.equal(said.toLowerCase(), `${statement}.`.toLowerCase());
    }
    const text = await page.textContent("#trial-1-passivity");
    assert.match(text, /Neither statement guarantees that a robot coupled to this person is stable\./);
    assert.doesNotMatch(await page.textContent("main"), /reasonable doubt|made unstable by|always stable/);
    const badges = await page.$$eval("#trial-1-passivity .ways tbody tr", (rows) => rows.map((row) => [...row.querySelectorAll("[data-verdict]")].map((b) => b.dataset.verdict)));
    assert.deepEqual(badges, passivity.models.map((m) => [m.symmetric, m.antisymmetric, m.published_rule]));
    const read = await numbers(page, "#trial-1-passivity");
    for (const model of passivity.models) {
      assertInterval(read, `${model.method}-min-index`, model.min_index, model.min_index_interval95);
      model.VAF.forEach((value, axis) => close(read[`${model.method}-vaf${axis}`].value, value, "VAF"));
    }
    const lines = passivity.trial.lines ?? [];
    lines.forEach((line, k) => assertInterval(read, `line${k}`, line.absorbed_J, line.interval95));
    assert.equal(await page.locator("#trial-1-passivity .lines tbody tr").count(), lines.length);
    assertAllShown(read);
  }));

  test(`each condition stands with value, bounds and outcome: ${name}`, () => reading(file, async (page) => {
    const read = await numbers(page, "#trial-1-conditions");
    const outcomes = await page.$$eval("#trial-1-conditions .conditions .outcome", (cells) => cells.map((cell) => cell.textContent));
    const word = { passive: "✓ met", active: "✕ not met", undecided: "? undecided" };
    const { models } = json.passivity;
    assert.deepEqual(outcomes, models.flatMap((model) => model.conditions.map((c) => word[c.verdict])));
    for (const { method, conditions, eop } of models) {
      conditions.forEach((c, k) => {
        close(read[`${method}-condition${k}`].value, c.value, c.name);
        close(read[`${method}-condition${k}-lower`].value, c.lower, c.name);
        close(read[`${method}-condition${k}-upper`].value, c.upper, c.name);
      });
      if (!eop) continue;
      assertInterval(read, `${method}-eop`, eop.corrected, eop.interval95);
      assertInterval(read, `${method}-eop-published`, eop.published_formula, eop.published_formula_interval95);
    }
    assertAllShown(read);
  }));

  test(`the energy account and what is drawn of it are those of the JSON: ${name}`, () => onPage(file, async (page) => {
    const { energy } = documentOf(file).trials[0];
    const read = await numbers(page, "#trial-1-energy");
    energy.forEach(({ account }, k) => {
      assertInterval(read, `energy${k}-absorbed`, account.absorbed_J, account.interval95);
      const { at_end: end, at_end_interval95: [endLow, endHigh], largest: worst, largest_interval95: [worstLow, worstHigh] } = account.shortage;
      assertInterval(read, `energy${k}-excess-end`, -end, [-endHigh, -endLow]);
      assertInterval(read, `energy${k}-excess-worst`, -worst, [-worstHigh, -worstLow]);
    });
    assertAllShown(read);
    const [{ parts }] = energy;
    const figure = page.locator("figure.chart-figure", { has: page.locator("#trial-1-parts") });
    await figure.locator("details.data-table summary").click();
    await figure.locator("tbody tr").first().waitFor();
    const rows = await figure.locator("tbody tr").evaluateAll((trs) => trs.map((tr) => [...tr.querySelectorAll("td")].map((td) => Number(td.textContent.replaceAll("−", "-").replace(/·10.*/, "")))));
    assert.equal(rows.length, parts.length);
    const fourDigits = (got, want) => assert.ok(Math.abs(got - want) <= 1e-4 * Math.abs(want) || Math.abs(want) < 1e-4, `${got} ${want}`);
    const scale = json.units.x0 === "m" ? 1000 : 1;
    rows.forEach((row, k) => {
      assert.equal(row[0], k + 1);
      fourDigits(row[1], parts[k].absorbed_J);
      fourDigits(row.at(-1), scale * parts[k].largest_displacement);
    });
  }));

  test(`both methods and the instruments stand beside each other: ${name}`, () => reading(file, async (page) => {
    const read = await numbers(page, "#trial-1-methods");
    const [other] = json.alternatives;
    const usable = Object.fromEntries([json, other].map((one) => [one.method, one.usable]));
    for (const { method, model, standard_error } of [json, other]) {
      for (const symbol of ["M", "B", "K"]) {
        for (const [j, i] of pairs(json.axes)) {
          if (!usable[method]) { // its numbers stand in the JSON only
            assert.equal(read[`${method}-${symbol}${j}${i}`], undefined);
            continue;
          }
          close(read[`${method}-${symbol}${j}${i}`].value, model[symbol][j][i], symbol);
          close(read[`${method}-${symbol}${j}${i}-half`].value, normal95 * standard_error[symbol][j][i], symbol);
        }
      }
    }
    const { instrument } = [json, other].find((one) => one.instrument);
    const holds = instrument.strong && usable.iv;
    if (holds) close(read["iv-less-ls"].value, json.disagreement.iv_less_ls, "disagreement");
    else assert.equal(read["iv-less-ls"], undefined);
    instrument.first_stage_F.forEach((F, k) => close(read[`first-stage-F${k}`].value, F, "F"));
    assert.equal(instrument.first_stage_F.length, 3 * json.axes);
    instrument.coherent_residual_fraction.forEach((share, axis) => close(read[`answered${axis}`].value, 100 * share, "answered"));
    const text = await page.textContent("#trial-1-methods");
    assert.match(text, instrument.strong ? /The instruments are strong/ : /The instruments are weak/);
    assert.match(text, !holds ? /so they cannot be compared with least squares/
      : json.disagreement.significant ? /differ significantly.*voluntary or reflex activity/s
      : /do not differ significantly/);
    assertAllShown(read);
  }));

  test(`a page with all of it has no violation: ${name}`, () => onPage(file, async (page) => {
    await page.$$eval("details", (details) => details.forEach((one) => (one.open = true)));
    await drawn(page);
    assert.deepEqual(await violationsInBoth(page), []);
  }));
}

test("the cases are what they are taken for", () => {
  assert.deepEqual([undecided, active, oneAxis].map(({ json }) => json.passivity.trial.verdict), ["passive", "active", "passive"]);
  assert.deepEqual([undecided, active, oneAxis].map(({ json }) => json.passivity.prediction.verdict), ["undecided", "none", "passive"]);
  assert.equal(undecided.json.disagreement.significant, true);
  assert.ok(undecided.json.passivity.trial.lines.length > 5);
});

test("bootstrap intervals stand beside those of the delta method, angles in degrees", () => reading(undecided.file, async (page) => {
  const { quantities } = undecided.json.bootstrap;
  const read = await numbers(page, "#trial-1-methods .bootstrap");
  let angles = 0;
  quantities.forEach((q, k) => {
    const isAngle = q.unit === "rad";
    angles += Number(isAngle);
    const scale = (value) => (isAngle && value !== null ? (value * 180) / Math.PI : value);
    close(read[`bootstrap${k}`].value, scale(q.value), q.name);
    if (q.interval95.includes(null)) return;
    close(read[`bootstrap${k}-low`].value, scale(q.interval95[0]), q.name);
    close(read[`bootstrap${k}-high`].value, scale(q.interval95[1]), q.name);
    close(read[`delta${k}-low`].value, scale(q.delta_interval95[0]), q.name);
  });
  assert.equal(angles, 3);
  assertAllShown(read);
}));

test("one axis has the impedance in the complex plane: the real part b, the imaginary part m ω − k/ω", () => onPage(oneAxis.file, async (page) => {
  const [first] = oneAxis.json.passivity.models;
  const { model } = [oneAxis.json, ...oneAxis.json.alternatives].find((one) => one.method === first.method);
  const figure = page.locator("figure.chart-figure", { has: page.locator("#trial-1-nyquist") });
  const [download] = await Promise.all([page.waitForEvent("download"), figure.getByRole("button", { name: /^Save CSV/ }).click()]);
  const rows = readFileSync(await download.path(), "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
  assert.equal(rows.length, first.index.frequency_hz.length);
  first.index.frequency_hz.forEach((f, i) => {
    const omega = 2 * Math.PI * f;
    close(rows[i][0], model.B[0][0], "real");
    close(rows[i][1], model.M[0][0] * omega - model.K[0][0] / omega, "imaginary");
  });
  assert.equal(await page.locator(".force-field, .ellipse-drawing").count(), 0);
}));

test("two axes have force fields: whole K is the sum of its parts, arrows have one scale and point along −K x", () => reading(undecided.file, async (page) => {
  assert.equal(await page.locator("#trial-1-nyquist").count(), 0);
  const { K } = undecided.json.model;
  const read = await numbers(page, "#trial-1-force-field");
  [["x", 0], ["y", 1]].forEach(([axis, column]) => {
    ["fx", "fy"].forEach((component, row) => {
      const of = (part) => read[`${part}-${axis}-${component}`].value;
      close(of("whole"), -0.01 * K[row][column], "whole");
      close(of("symmetric"), -0.01 * (K[row][column] + K[column][row]) / 2, "symmetric");
      assert.ok(Math.abs(of("symmetric") + of("antisymmetric") - of("whole")) <= 1e-12 * read["largest-force"].value);
    });
  });
  const fields = await page.$$eval(".force-field", (drawings) => drawings.map((svg) => ({
    label: svg.getAttribute("aria-label"),
    arrows: [...svg.querySelectorAll(".force line")].map((line) => ["x1", "y1", "x2", "y2"].map((key) => Number(line.getAttribute(key)))),
  })));
  assert.equal(fields.length, 3);
  const longest = Math.max(...fields.flatMap(({ arrows }) => arrows.map(([x1, y1, x2, y2]) => Math.hypot(x2 - x1, y2 - y1))));
  const perNewton = longest / read["largest-force"].value;
  const half = Math.max(...fields[0].arrows.map(([x1]) => x1));
  for (const { label, arrows } of fields) assert.ok(label.length > 60 && arrows.length === 24, label);
  for (const [x1, y1, x2, y2] of fields[0].arrows) {
    const [x, y] = [(0.01 * x1) / half, (-0.01 * y1) / half];
    const pixel = 0.02; // coordinates have two decimals
    assert.ok(Math.abs(x2 - x1 + perNewton * (K[0][0] * x + K[0][1] * y)) < pixel, "along x");
    assert.ok(Math.abs(y2 - y1 - perNewton * (K[1][0] * x + K[1][1] * y)) < pixel, "along y");
  }
}));

test("the band around an ellipse holds it, is named, and is as wide as its variance says in the long direction", async () => {
  const s = 0.02;
  const file = changed(undecided.file, "known-band", ({ result }) => {
    result.model.K = [[400, 0], [0, 100]];
    Object.assign(result.ellipses.stiffness, { eigenvalues: [100, 400], orientation_deg: 0 });
    const { parameters } = result.covariance;
    result.covariance.matrix = parameters.map((a) => parameters.map((b) => (a === b && a === "k_xx" ? (s * 400) ** 2 : 0)));
  });
  await onPage(file, async (page) => {
    assert.match(await page.textContent("#trial-1-ellipses .legend"), /95 %/);
    assert.equal(await page.locator("#trial-1-ellipses .ellipse-drawing .ellipse-band").count(), 1, "the others have no variance");
    const { path, rx } = await page.$eval("#trial-1-ellipses .panel:last-child .ellipse-drawing", (svg) => ({ path: svg.querySelector(".ellipse-band").getAttribute("d"), rx: Number(svg.querySelector(".ellipse").getAttribute("rx")) }));
    const [high, low] = path.split("Z").map((ring) => Number(/M ([\d.]+)/.exec(ring)?.[1]));
    const width = (high - low) / (2 * normal95 * s * rx);
    const chance = 4 * Math.sqrt(2 * 0.025 * 0.975 / 1000) / (2 * normal95 * 0.0584); // 4 standard errors of two quantiles; 0.0584 is the density there
    assert.ok(Math.abs(width - 1) < chance && low < rx && rx < high, `${low} ${rx} ${high}`);
  });
});

test("several recordings are in one chart of energy, and the overview names each verdict", () => onPage(several.file, async (page) => {
  const figure = page.locator("#overview figure.chart-figure");
  assert.equal(await figure.locator(".legend line").count(), 2);
  const badges = await page.$$eval("#overview [data-verdict]", (all) => all.map((badge) => badge.dataset.verdict));
  assert.deepEqual(badges.sort(), several.json.results.flatMap(({ passivity }) => [passivity.trial.verdict, passivity.prediction.verdict]).sort());
}));

test("what a document does not hold is left out", async () => {
  const without = changed(active.file, "without", (document) => {
    for (const key of ["passivity", "bootstrap", "disagreement", "covariance", "instrument", "consistent_fit"]) delete document.result[key];
    document.result.alternatives = [];
    delete document.trials[0].energy;
  });
  await onPage(without, async (page) => {
    for (const part of ["passivity", "conditions", "energy", "methods"]) assert.equal(await page.locator(`#trial-1-${part}`).count(), 0, part);
    assert.equal(await page.locator(".ellipse-band").count(), 0);
    assert.equal(await page.locator("#trial-1-model").count(), 1);
  });
  const none = (value) => (Array.isArray(value) ? value.map(none) : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, none(v)])) : typeof value === "number" ? null : value);
  for (const [name, { file }] of Object.entries(all)) {
    const empty = changed(file, `${name}-undefined`, (document) => {
      const { result } = document;
      for (const model of result.passivity.models) {
        for (const key of ["VAF", "min_index", "min_index_interval95", "circular_hz", "conditions", "index", "eop"]) if (model[key] !== undefined) model[key] = none(model[key]);
      }
      for (const key of ["model", "standard_error", "covariance", "alternatives", "disagreement"]) if (result[key]) result[key] = none(result[key]);
      if (result.bootstrap) result.bootstrap.quantities = none(result.bootstrap.quantities);
      const account = (one) => ({ ...none(one), blocks: one.blocks });
      result.passivity.energy = account(result.passivity.energy);
      const { trial } = result.passivity;
      for (const key of ["absorbed_J", "interval95"]) trial[key] = none(trial[key]);
      for (const energy of document.trials[0].energy) {
        energy.account = account(energy.account);
        for (const key of ["absorbed_J", "curl"]) if (energy[key]) energy[key] = none(energy[key]);
        for (const part of energy.parts) Object.assign(part, none(part), { from_s: part.from_s, to_s: part.to_s });
      }
    });
    await onPage(empty, async (page) => {
      await drawn(page);
      assert.doesNotMatch(await page.textContent("main"), /NaN(?! throughout)|null|Infinity|\[object/);
      assert.deepEqual(await violations(page), []);
    });
  }
});

// The HTML report in a browser: its numbers are those of --json, it is quiet, offline, accessible and printable.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { after, test } from "node:test";
import { join } from "node:path";
import { assertShown, changed, clipped, close, closeBrowser, documentOf, drawn, eventually, folder, makeLog, mbk, measure, numbers, onPage, open, picture, printedFrame, reading, simulate, violations, violationsInBoth, violationsInDark } from "./browser.mjs";
import { withDiagnostics } from "./diagnostics.mjs";

after(closeBrowser);

const normal95 = 1.959963984540054;
const axisPairs = (n) => Array.from({ length: n * n }, (_, k) => [Math.floor(k / n), k % n]);

const person = makeLog("person.mat", "--protocol", "sinusoidal", "--seed", "4", "--coloured-force-noise", "0.3");
const joint = makeLog("joint.mat", "--protocol", "sinusoidal", "--one-axis");
const pulses = makeLog("pulses.mat", "--protocol", "underdamped", "--seed", "2");
const relaxed = simulate("relaxed.mat", "relaxed_sinusoidal");

const withPlots = (report, name) =>
  documentOf(report.file).trials.every((trial) => trial.diagnostics) ? report.file : changed(report.file, name, withDiagnostics);

const one = measure("one", person);
const onePage = withPlots(one, "one-plots");
const oneAxis = measure("joint", joint);
const unusable = measure("unusable", person, "--handle-mass", "5");
const several = measure("several", person, pulses, relaxed);

function assertModel(read, result) {
  const n = result.axes;
  for (const symbol of ["M", "B", "K"]) {
    for (const [j, i] of axisPairs(n)) {
      close(read[`${symbol}${j}${i}`].value, result.model[symbol][j][i], symbol);
      close(read[`${symbol}${j}${i}-half`].value, normal95 * result.standard_error[symbol][j][i], `± ${symbol}`);
    }
  }
  const scale = result.units.x0 === "m" ? 1000 : 1;
  for (let j = 0; j < n; ++j) {
    close(read[`x0${j}`].value, scale * result.model.x0[j], "x0");
    for (const name of ["VAF", "VAF_in_sample", "RMSE"]) close(read[`${name}${j}`].value, result.fit[name][j], name);
  }
  for (const [name, number] of Object.entries(read)) assertShown(number, name);
}

test("the model, its intervals and the fit are those of --json", () => reading(one.file, async (page) => {
  assertModel(await numbers(page, "#trial-1-model"), one.json);
}));

test("the ellipses and their intervals are those of --json", () => reading(one.file, async (page) => {
  const read = await numbers(page, "#trial-1-ellipses");
  for (const [name, ellipse] of Object.entries(one.json.ellipses)) {
    for (const [key, field] of [["area", "area"], ["shape", "shape"], ["orientation", "orientation_deg"]]) {
      close(read[`${name}-${key}`].value, ellipse[field], `${name} ${key}`);
      close(read[`${name}-${key}-low`].value, ellipse.interval95[field][0], `${name} ${key}`);
      close(read[`${name}-${key}-high`].value, ellipse.interval95[field][1], `${name} ${key}`);
    }
    close(read[`${name}-small`].value, ellipse.eigenvalues[0], name);
    close(read[`${name}-large`].value, ellipse.eigenvalues[1], name);
  }
  for (const [name, finding] of Object.entries(one.json.antisymmetry)) close(read[`${name}-zmean`].value, finding.zmean_percent, name);
}));

test("an ellipse is drawn to scale: its axes and circle are in the ratio of the numbers", () => reading(one.file, async (page) => {
  const drawn = await page.$$eval("#trial-1-ellipses .ellipse-drawing", (drawings) => drawings.map((svg) => ({
    rx: Number(svg.querySelector(".ellipse").getAttribute("rx")),
    ry: Number(svg.querySelector(".ellipse").getAttribute("ry")),
    turn: svg.querySelector(".ellipse").getAttribute("transform"),
    circle: Number(svg.querySelector(".reference").getAttribute("r")),
    value: parseFloat(svg.querySelector(".reference-value").textContent),
  })));
  const pixel = 0.02; // coordinates have two decimals
  ["inertia", "damping", "stiffness"].forEach((name, k) => {
    const [small, large] = one.json.ellipses[name].eigenvalues;
    const { rx, ry, turn, circle, value } = drawn[k];
    assert.ok(Math.abs(ry - (rx * small) / large) < pixel, name);
    assert.ok(Math.abs(circle - (rx * value) / large) < pixel, name);
    assert.ok(Math.abs(parseFloat(/-?[\d.]+/.exec(turn)[0]) + one.json.ellipses[name].orientation_deg) < 1e-3, name);
  });
}));

test("the arm of a simulated participant lies under the ellipses, its links in the ratio of their lengths", async () => {
  const report = measure("relaxed", relaxed);
  const { page, close: done } = await open(report.file);
  const points = await page.$eval("#trial-1-ellipses .posture.arm .links", (line) =>
    line.getAttribute("points").split(" ").map((point) => point.split(",").map(Number)));
  const length = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
  assert.equal(points.length, 3);
  assert.ok(Math.abs(length(points[0], points[1]) / length(points[1], points[2]) - 0.31 / 0.34) < 0.005);
  assert.deepEqual(points[2].map(Math.abs), [0, 0]);
  assert.ok(points[0][1] > 100, "the shoulder is nearer to the person than the hand");
  assert.match(await page.textContent("header"), /Simulated/);
  await done();
});

test("the page is quiet, asks no network for anything and holds its licences", () => reading(onePage, async (page) => {
  const licences = await page.$eval(".licences", (element) => element.textContent);
  for (const words of ["Apache License", "Copyright 2017-2026 The Apache Software Foundation", "Baidu Inc.", "Microsoft Corporation", "Mike Bostock"]) {
    assert.ok(licences.includes(words), words);
  }
}));

for (const [what, file, prepare] of [
  ["one recording with every data table open", onePage, (page) => page.$$eval("details", (all) => all.forEach((d) => (d.open = true)))],
  ["one axis", withPlots(oneAxis, "joint-plots"), undefined],
  ["a result that is not usable", withPlots(unusable, "unusable-plots"), undefined],
  ["several recordings, all open", withPlots(several, "several-plots"), (page) => page.$$eval("details.trial", (all) => all.forEach((d) => (d.open = true)))],
]) {
  test(`axe finds no violation: ${what}`, () => (prepare ? onPage : reading)(file, async (page) => {
    await prepare?.(page);
    await drawn(page);
    assert.deepEqual(await violations(page), []);
  }));
}

test("the keyboard reaches the content first, zooms a chart and shows all again", async () => {
  const { page, close: done } = await open(onePage);
  await page.keyboard.press("Tab");
  await eventually(async () => assert.equal(await page.evaluate(() => document.activeElement.className), "skip"));
  await page.keyboard.press("Enter");
  await eventually(async () => assert.equal(await page.evaluate(() => document.activeElement.id), "content"));
  await page.keyboard.press("Tab");
  await eventually(async () => assert.ok(await page.evaluate(() => document.querySelector("main").contains(document.activeElement)), "after the skip link the contents are skipped"));
  const figure = page.locator("figure.chart-figure", { has: page.locator("#trial-1-prediction") });
  const ticks = () => figure.locator(".chart svg text").allTextContents();
  await figure.scrollIntoViewIfNeeded();
  await figure.locator(".chart svg").waitFor();
  const whole = await ticks();
  await figure.getByRole("button", { name: /^Zoom in/ }).focus();
  await page.keyboard.press("Enter");
  await eventually(async () => assert.equal(await figure.locator(".zoom").textContent(), "25–75 %"));
  await eventually(async () => assert.notDeepEqual(await ticks(), whole));
  const zoomed = await ticks();
  await page.evaluate(() => ["beforeprint", "afterprint"].forEach((when) => dispatchEvent(new Event(when))));
  assert.deepEqual(await ticks(), zoomed, "what was printed is shown as before");
  for (let k = 0; k < 4; ++k) await page.keyboard.press("Tab");
  await eventually(async () => assert.match(await page.evaluate(() => document.activeElement.ariaLabel ?? document.activeElement.getAttribute("aria-label")), /^Show all/));
  await page.keyboard.press("Enter");
  await eventually(async () => assert.deepEqual(await ticks(), whole));
  await done();
});

test("a data table opens by keyboard and has the numbers of the chart", async () => {
  const { page, close: done } = await open(onePage);
  const figure = page.locator("figure.chart-figure", { has: page.locator("#trial-1-prediction") });
  await figure.locator("details.data-table summary").focus();
  await page.keyboard.press("Enter");
  const rows = figure.locator("details.data-table table.values tbody tr");
  await rows.first().waitFor();
  const { prediction } = documentOf(onePage).trials[0].diagnostics;
  const cells = (await rows.first().locator("td").allTextContents()).map((text) => Number(text.replaceAll("−", "-")));
  const want = [prediction.time_s[0], prediction.measured[0][0], prediction.predicted[0][0]];
  want.forEach((value, k) => assert.ok(Math.abs(cells[k] - value) <= 1e-4 * Math.abs(value), `${cells} ${want}`));
  await done();
});

test("a CSV file holds every value of its chart", async () => {
  const { page, close: done } = await open(onePage);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: /^Save CSV: Measured and predicted/ }).click()]);
  const lines = readFileSync(await download.path(), "utf8").trim().split("\n");
  const { prediction } = documentOf(onePage).trials[0].diagnostics;
  assert.match(lines[0], /^"time \[s\]","Force along x, measured \[N\]"/);
  assert.equal(lines.length - 1, prediction.time_s.filter((t, i) => t !== null || prediction.measured[0][i] !== null).length);
  assert.equal(Number(lines[1].split(",")[1]), prediction.measured[0][0]);
  await done();
});

test("each chart has a description, one sentence on how to read it, and lines that differ without colour", () => reading(onePage, async (page) => {
  const figures = await page.$$eval("figure.chart-figure", (all) => all.map((figure) => ({
    description: figure.querySelector("[role=img]").getAttribute("aria-label"),
    caption: figure.querySelector("figcaption").textContent,
    dashes: [...figure.querySelectorAll(".legend line")].map((line) => `${line.getAttribute("stroke-dasharray")} ${line.getAttribute("stroke-width") > 1.7}`),
  })));
  assert.ok(figures.length >= 7, String(figures.length));
  for (const { description, caption, dashes } of figures) {
    assert.ok(description.length > 40, description);
    assert.match(caption, /^How to read this\. \S/);
    if (dashes.length === 2) assert.equal(new Set(dashes).size, 2, caption);
  }
}));

test("one axis has no ellipses and the units of what moves", () => reading(oneAxis.file, async (page) => {
  assertModel(await numbers(page, "#trial-1-model"), oneAxis.json);
  assert.equal(await page.locator(".ellipse-drawing").count(), 0);
  const text = await page.textContent("#trial-1-model");
  for (const unit of Object.values(oneAxis.json.units)) assert.ok(text.includes(unit === "m" ? "mm" : unit), unit);
}));

test("a hand that left the handle is the first thing the report says", () => {
  const message = "from 31 s on the force varies by at most 5 % of its usual level: the hand probably left the handle";
  const file = changed(unusable.file, "lost", (report) => {
    report.result.warnings = [{ code: "contact-lost", message, try: "measure the part before it: --to 30" }];
  });
  return reading(file, async (page) => {
    assert.match(await page.textContent(".verdict"), /Not usable\. From 31 s on the force varies by at most 5 % .*left the handle/);
    assert.doesNotMatch(await page.textContent(".verdict"), /✓/);
  });
});

test("a result that is not usable says so first, with every warning in plain and in exact words", () => reading(unusable.file, async (page) => {
  assert.equal(unusable.code, 4);
  assert.match(await page.textContent(".verdict"), /Not usable\. Do not report these numbers/);
  const read = await page.$$eval(".warning", (all) => all.map((item) => ({
    code: item.dataset.code,
    message: item.querySelector("[data-name=message]").textContent,
    try: item.querySelector("[data-name=try]").textContent,
    title: item.querySelector("strong").textContent,
  })));
  assert.deepEqual(read.map(({ title, ...warning }) => warning), unusable.json.warnings.map(({ was, ...warning }) => warning));
  for (const { title, code } of read) assert.notEqual(title, code);
  assert.equal(await page.locator(".ellipse-drawing").count(), 0, "no number of it is shown");
}));

test("every warning that mbk knows has plain words", async () => {
  const header = readFileSync(new URL("../../mbk/model/trial/warning.h", import.meta.url), "utf8").split("former_word_table")[0];
  const codes = [...header.matchAll(/\{\w+, "([\w-]+)"\}/g)].map((match) => match[1]);
  assert.ok(codes.length >= 16, String(codes.length));
  const file = changed(one.file, "all-warnings", (document) => {
    document.result.warnings = codes.map((code) => ({ code, message: "m", try: "t" }));
  });
  const { page, close: done } = await open(file);
  const titles = await page.$$eval(".warning", (all) => all.map((item) => [item.dataset.code, item.querySelector("strong").textContent]));
  assert.equal(titles.length, codes.length);
  for (const [code, title] of titles) assert.notEqual(title, code);
  await done();
});

test("several recordings stand side by side at one scale, and a link opens each", async () => {
  const { page, close: done } = await open(withPlots(several, "several-plots"));
  const results = several.json.results;
  const rows = await page.$$eval("table.overview:first-of-type tbody tr", (all) => all.map((row) => ({
    link: row.querySelector("a")?.getAttribute("href"),
    name: row.querySelector("th").textContent,
    values: Object.fromEntries([...row.querySelectorAll("data")].map((d) => [d.dataset.name, Number(d.value)])),
  })));
  const models = rows.filter((row) => row.link);
  assert.equal(models.length, 3);
  for (const { link, values } of models) {
    const result = results[Number(link.slice("#trial-".length)) - 1];
    for (const symbol of ["M", "B", "K"]) for (const [j, i] of axisPairs(2)) close(values[`${symbol}${j}${i}`], result.model[symbol][j][i], symbol);
    result.fit.VAF.forEach((vaf, axis) => close(values[`VAF${axis}`], vaf, "VAF"));
  }
  assert.equal(rows.find((row) => row.name.startsWith("mean")), undefined, "they are of different conditions");
  assert.equal(several.json.summary, undefined);
  assert.ok((await page.textContent("main")).includes(several.json.no_summary), several.json.no_summary);

  const scales = await page.$$eval(".comparison:nth-of-type(3) .ellipse-drawing", (all) => all.map((svg) => ({
    rx: Number(svg.querySelector(".ellipse").getAttribute("rx")),
    circle: svg.querySelector(".reference").getAttribute("r"),
  })));
  assert.equal(new Set(scales.map((scale) => scale.circle)).size, 1);
  const largest = models.map(({ link }) => results[Number(link.slice(7)) - 1].ellipses.stiffness.eigenvalues[1]);
  scales.forEach(({ rx }, k) => assert.ok(Math.abs(rx / scales[0].rx - largest[k] / largest[0]) < 1e-3));

  assert.equal(await page.$eval("#trial-2", (details) => details.open), false);
  await page.click('table.overview a[href="#trial-2"]');
  await page.waitForFunction(() => document.querySelector("#trial-2").open);
  assertModel(await numbers(page, "#trial-2-model"), results[1]);
  await page.locator("#trial-2 .chart").first().scrollIntoViewIfNeeded();
  await page.locator("#trial-2 .chart svg").first().waitFor();
  await done();
});

test("on paper everything is open, every chart is drawn and none is wider than the page", async () => {
  const { page, said, close: done } = await open(withPlots(several, "several-plots"));
  await page.emulateMedia({ media: "print" });
  const a4 = 794 - 2 * 60; // between the margins [px]
  const state = await page.evaluate(() => {
    dispatchEvent(new Event("beforeprint"));
    // The printer takes what is there now: what is drawn with the next frame comes too late.
    const outside = (text) => {
      const [inner, outer] = [text.getBoundingClientRect(), text.ownerSVGElement.parentElement.parentElement.getBoundingClientRect()];
      return inner.right > outer.right + 1 || inner.bottom > outer.bottom + 2;
    };
    return {
      closed: document.querySelectorAll("details[data-print]:not([open])").length,
      widths: [...document.querySelectorAll(".chart svg")].map((svg) => svg.getBoundingClientRect().width),
      charts: document.querySelectorAll(".chart").length,
      outside: [...document.querySelectorAll(".chart svg text")].filter(outside).map((text) => text.textContent),
    };
  });
  assert.deepEqual(state.outside, []);
  assert.equal(state.closed, 0);
  assert.equal(state.widths.length, state.charts);
  assert.ok(state.charts >= 21 && Math.max(...state.widths) <= a4, JSON.stringify(state.widths));
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  assert.equal(await page.locator("details.trial[open]").count(), 0, "closed again");
  assert.deepEqual(said, []);
  await done();
});

test("nothing is cut off from 900 to 1920 px, and every chart is there without scrolling to it", async () => {
  for (const file of [onePage, withPlots(several, "several-plots"), withPlots(oneAxis, "joint-plots")]) {
    await onPage(file, async (page) => {
      await eventually(async () => assert.equal(await page.locator(".chart > div > svg").count(), await page.locator(".chart").count()));
      await page.$$eval("details.trial, details.metadata", (all) => all.forEach((one) => (one.open = true)));
      for (const width of [900, 1280, 1920]) {
        await page.setViewportSize({ width, height: 900 });
        await eventually(async () => assert.deepEqual(await clipped(page), [], `${width} px`));
      }
    });
  }
});

const savedBy = async (page, button) => {
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  return { name: download.suggestedFilename(), text: readFileSync(await download.path(), "utf8") };
};

test("a drawing is saved as on paper, whatever the screen looks like, and printed alone", async () => {
  const saved = [];
  for (const colorScheme of ["light", "dark"]) {
    await onPage(onePage, async (page) => {
      for (const [name, words] of [["Ellipses", ["Inertia M", "N/m"]], ["Measured and predicted", ["predicted by the model", "Force along y [N]", "time [s]"]]]) {
        const { name: file, text } = await savedBy(page, page.getByRole("button", { name: new RegExp(`^Save SVG: ${name}`) }));
        assert.match(file, /^trial-1-\w+\.svg$/);
        for (const word of words) assert.ok(text.includes(word), `${word} in ${file}`);
        assert.doesNotMatch(text, /var\(|class=|color\(/, "it needs no style sheet");
        const read = await page.evaluate((svg) => new DOMParser().parseFromString(svg, "image/svg+xml").documentElement.nodeName, text);
        assert.equal(read, "svg");
        saved.push(text);
      }
      await page.getByRole("button", { name: /^Print, save PDF: Ellipses/ }).click();
      assert.equal(await (await printedFrame(page)).locator("svg .none, svg svg").count(), 4, "three ellipses and the legend");
    }, { colorScheme });
  }
  assert.deepEqual(saved.slice(0, 2), saved.slice(2));
});

test("numbers of the ellipses are saved as they are in --json", () => onPage(one.file, async (page) => {
  const { text } = await savedBy(page, page.getByRole("button", { name: "Save CSV: Ellipses" }));
  const [, small, large] = /"K","N\/m",([^,]*),([^,]*),/.exec(text);
  assert.deepEqual([Number(small), Number(large)], one.json.ellipses.stiffness.eigenvalues);
}));

test("a table is copied for a spreadsheet", () => onPage(one.file, async (page) => {
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.getByRole("button", { name: /^Copy table: Inertia, damping, stiffness and equilibrium/ }).click();
  const lines = await eventually(async () => {
    const text = await page.evaluate(() => navigator.clipboard.readText());
    assert.match(text, /^\txx\txy\tyx\tyy\tunit\n/);
    return text.split("\n");
  });
  const shown = await numbers(page, "#trial-1-model");
  assert.equal(lines[3].split("\t")[1], `${shown.K00.shown} ± ${shown["K00-half"].shown}`.replaceAll("−", "-"));
}));

test("the cards are of the model on which the prediction of passivity rests", async () => {
  const eigenvalues = ([[a, b], [c, d]]) => (a + d) / 2 + Math.hypot((a - d) / 2, (b + c) / 2);
  const { method, alternatives: [other] } = one.json;
  assert.ok(other.usable && method !== other.method);
  for (const first of [method, other.method]) {
    const file = changed(one.file, `cards-${first}`, ({ result }) => result.passivity.models.sort((a, b) => Number(b.method === first) - Number(a.method === first)));
    await onPage(file, async (page) => {
      const cards = await numbers(page, "#trial-1-summary .cards");
      const { model } = first === method ? one.json : other;
      for (const symbol of ["M", "B", "K"]) close(cards[`card-${symbol}-large`].value, eigenvalues(model[symbol]), symbol);
      assert.equal(await page.getAttribute("#trial-1-summary .model-of", "data-method"), first);
      assert.equal(await page.locator("#trial-1-summary [data-other]").count(), 1);
    });
  }
});

test("values from the literature stand beside K, B and M with their source, and only of hands in a plane", async () => {
  await reading(one.file, async (page) => {
    const table = page.locator("#trial-1-model .literature");
    // √(A R/π) of Dyck (2013), table 3.3: P6 and P5
    const [low, high] = [[4892.9, 6.5], [17693.1, 5.2]].map(([area, shape]) => Math.sqrt((area * shape) / Math.PI).toFixed(0));
    assert.ok((await table.locator("tr", { hasText: "stiffness K, maximum" }).textContent()).includes(`${low} to ${high}`));
    assert.match(await table.textContent(), /University of Alberta, 2013, table 3\.3\. Conditions: arm relaxed;/);
    assert.equal(await page.locator(".card .beside").count(), 3);
  });
  await reading(oneAxis.file, async (page) => assert.equal(await page.locator(".literature, .beside").count(), 0));
});

test("a logarithmic axis has ticks at 1, 2 and 5, and others where one looks closer", () => onPage(one.file, async (page) => {
  const figure = page.locator("figure.chart-figure", { has: page.locator("#trial-1-index") });
  const ticks = async () => (await figure.locator(".chart svg text").allTextContents()).map(Number);
  const [from, to] = one.json.passivity.models[0].band_hz;
  const within = [0.1, 0.2, 0.5, 1, 2, 5].filter((f) => f > from * 1.1 && f < to / 1.1);
  assert.ok(within.length > 0);
  const shown = await ticks();
  for (const f of within) assert.ok(shown.includes(f), `${f} in ${shown}`);
  for (let k = 0; k < 3; ++k) await figure.getByRole("button", { name: /^Zoom in/ }).click();
  await eventually(async () => assert.notDeepEqual(await ticks(), shown));
  assert.ok((await ticks()).filter((f) => f > from && f < to).length >= 2, `${await ticks()}`);
}));

test("recordings are called by participant, condition and file, in the file's own case", async () => {
  const apart = changed(several.file, "apart", ({ result, trials }) => {
    result.results.forEach((one, k) => (one.inputs[0].file = `/data/${["a", "b", "b"][k]}/${["lOG.mat", "lOG.mat", "Other.mat"][k]}`));
    trials.forEach((trial, k) => (trial.recordings[0].metadata = k < 2 ? { participant: "p7", condition: "relaxed" } : {}));
  });
  await onPage(apart, async (page) => {
    const names = await page.$$eval("details.trial > summary h3", (all) => all.map((one) => one.textContent));
    assert.deepEqual(names.sort(), ["Other.mat", "p7, relaxed (a/lOG.mat)", "p7, relaxed (b/lOG.mat)"]);
    const transforms = await page.$$eval("h1, h3", (all) => all.map((one) => getComputedStyle(one, "::first-letter").textTransform));
    assert.deepEqual(new Set(transforms), new Set(["none"]));
  });
});

test("in the dark axe finds nothing wrong either", async () => {
  for (const file of [onePage, unusable.file]) await reading(file, async (page) => assert.deepEqual(await violationsInDark(page), []));
});

test("a comparison has the widths of --json, the results by the names of their files, and what was left out", async () => {
  for (const [name, { json }] of [["Relaxed", measure("compared1", relaxed)], ["rigid", one]]) writeFileSync(join(folder, `${name}.json`), JSON.stringify(json));
  mkdirSync(join(folder, "results"));
  for (const name of ["Relaxed", "rigid"]) copyFileSync(join(folder, `${name}.json`), join(folder, "results", `${name}.json`));
  writeFileSync(join(folder, "results", "notes.json"), "{}");
  const ran = mbk("compare", "results", "--json", "--report", "compared.html");
  assert.equal(ran.code, 0, ran.err);
  await onPage(join(folder, "compared.html"), async (page) => {
    const { width } = JSON.parse(ran.out);
    const read = await numbers(page, "#comparison");
    for (const name of ["inertia", "damping", "stiffness"]) {
      close(read[`width-${name}`].value, width[name].distance, name);
      close(read[`least-${name}`].value, width[name].second_to_first[0].ratio, name);
      close(read[`most-${name}`].value, width[name].second_to_first.at(-1).ratio, name);
    }
    assert.deepEqual(await page.$$eval("table.overview:first-of-type tbody a", (all) => all.map((one) => one.textContent)), ["Relaxed.json", "rigid.json"]);
    assert.match(await page.textContent("[data-name=failed]"), /Omitted: .*notes\.json/);
    assert.deepEqual(await violationsInBoth(page), []);
    for (const width of [900, 1920]) {
      await page.setViewportSize({ width, height: 900 });
      await eventually(async () => assert.deepEqual(await clipped(page), []));
    }
  });
});

test("trials of one condition have a mean", async () => {
  const alike = measure("alike", person, makeLog("person5.mat", "--protocol", "sinusoidal", "--seed", "5", "--coloured-force-noise", "0.3"));
  const { page, close: done } = await open(alike.file);
  const mean = page.locator("table.overview:first-of-type tbody tr", { hasText: /^mean/ }).locator('data[data-name="mean-K00"]');
  close(Number(await mean.getAttribute("value")), alike.json.summary.model.K[0][0], "mean");
  await done();
});

test("undefined numbers are said to be undefined", async () => {
  const file = changed(onePage, "undefined", (document) => {
    const { result } = document;
    const none = (value) => (Array.isArray(value) ? value.map(none) : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, none(v)])) : typeof value === "number" ? null : value);
    for (const key of ["model", "standard_error", "fit", "ellipses", "antisymmetry", "excitation"]) result[key] = none(result[key]);
    result.excitation.rank = 3;
    document.trials[0].diagnostics = none(document.trials[0].diagnostics);
  });
  await onPage(file, async (page) => {
    await drawn(page);
    const read = await numbers(page, "#trial-1-model");
    assert.equal(read.K00.shown, "undefined");
    assert.doesNotMatch(await page.textContent("main"), /NaN(?! throughout)|null|Infinity|\[object/);
    assert.deepEqual(await violations(page), []);
  });
});

test("a report without diagnostics, and a pooled one, are whole", async () => {
  const file = changed(one.file, "bare", (document) => delete document.trials[0].diagnostics);
  const { page, said, close: done } = await open(file);
  assert.match(await page.textContent("main"), /no plots/);
  assert.deepEqual(said, []);
  await done();
  const pooled = measure("pooled", "--pool", "--handle-mass", "0.194", person, relaxed);
  const second = await open(pooled.file);
  assertModel(await numbers(second.page, "#trial-1-model"), pooled.json);
  assert.equal(await second.page.locator("#trial-1-provenance table.files tbody tr").count(), 2);
  assert.deepEqual(second.said, []);
  await second.close();
});

test("what stands in a recording or an option stays text", async () => {
  const hostile = "</script><!--<script><img src=x onerror=\"document.title='owned'\"> & 'quoted'";
  const report = measure("hostile", person, "--report-note", hostile);
  const { page, said, outside, close: done } = await open(report.file);
  assert.equal(await page.textContent(".note"), hostile);
  assert.ok((await page.textContent(".command")).includes("--report-note '</script>"));
  assert.notEqual(await page.title(), "owned");
  assert.deepEqual(said, []);
  assert.deepEqual(outside(), []);
  await done();
});

test("the page runs what stands in it and nothing that came into it later, and reaches no network", async () => {
  const { page, outside, close: done } = await open(one.file);
  const found = await page.evaluate(async () => {
    const refused = new Promise((resolve) => document.addEventListener("securitypolicyviolation", ({ effectiveDirective }) => resolve(effectiveDirective), { once: true }));
    const script = document.createElement("script");
    script.textContent = "window.ran = true";
    document.body.append(script);
    const reached = await fetch("http://127.0.0.1:9/").then(() => "reached", () => "refused");
    return { directive: await refused, ran: window.ran === true, reached };
  });
  assert.match(found.directive, /^script-src/);
  assert.deepEqual([found.ran, found.reached], [false, "refused"]);
  assert.deepEqual(outside(), []);
  await done();
});

test("the same inputs and options give the same bytes", () => {
  const first = readFileSync(one.file);
  const again = mbk("measure", person, "--json", "--report", "one.html", "--overwrite");
  assert.equal(again.code, 0);
  const strip = (bytes) => bytes.toString().replace(" --overwrite", "");
  assert.equal(strip(readFileSync(`${folder}/one.html`)), strip(first));
});

test("pictures of each kind of report, to be looked at", async () => {
  for (const [name, file] of [["one", onePage], ["relaxed", withPlots(measure("relaxed2", relaxed), "relaxed-plots")], ["one-axis", withPlots(oneAxis, "joint-plots")], ["unusable", withPlots(unusable, "unusable-plots")], ["several", withPlots(several, "several-plots")]]) {
    await onPage(file, async (page) => {
      const pdf = await picture(page, name);
      const pages = pdf.toString("latin1").match(/\/Type \/Page\b/g).length;
      assert.ok(pages >= 4 && pages <= (name === "several" ? 45 : 15), `${name}: ${pages} pages`);
    });
  }
});

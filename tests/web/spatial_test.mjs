// The report of a result with three axes, on documents of round numbers: drawings to scale in the frame of the result.
import assert from "node:assert/strict";
import { after, test } from "node:test";
import { clipped, close, closeBrowser, drawn, eventually, numbers, onPage, picture, reading, reportOf, violations, violationsInBoth } from "./browser.mjs";
import { dot, frame, product, rotationAbout, spatialReport, spatialResult, times, transposed } from "./spatial.mjs";

after(closeBrowser);

const matrices = { inertia: "M", damping: "B", stiffness: "K" };
const planes = { xy: [0, 1], xz: [0, 2], yz: [1, 2] };

/** A rotation that is not near the frame: the axis is random, the angle 40° to 140°. */
function anyRotation() {
  const at = () => 2 * Math.random() - 1;
  return rotationAbout([at(), at(), at()], ((40 + 100 * Math.random()) * Math.PI) / 180);
}
const R = anyRotation();

const one = spatialResult();
const turned = spatialResult(R);
const onePage = reportOf(spatialReport(one), "space");
const turnedPage = reportOf(spatialReport(turned), "turned");
const open = spatialResult(frame, { stiffness: { values: [640, 260, -30] } });
open.result.ellipsoids.damping.principal.slice(1).forEach((axis) => (axis.half_angle95_deg = 90));
const openPage = reportOf(spatialReport(open), "open");
const second = spatialResult(R);
second.result.inputs[0].file = "zenith.csv";
const severalPage = reportOf(spatialReport(one, second), "several-space");

/** Of each matrix and plane: half axes and angle of the outline, and how many pixels its unit has. */
const outlines = (page) => page.$$eval("#trial-1-ellipsoids .ellipsoid-drawings", (all) => all.map((drawings) => {
  const value = parseFloat(/[\d.]+/.exec(drawings.querySelector(".panel-note").textContent)[0]);
  return Object.fromEntries([...drawings.querySelectorAll(".projection")].map((svg) => {
    const [ellipse, circle] = [svg.querySelector(".ellipse"), svg.querySelector(".reference")];
    return [svg.dataset.plane, {
      rx: Number(ellipse.getAttribute("rx")), ry: Number(ellipse.getAttribute("ry")), angle: (-parseFloat(/-?[\d.]+/.exec(ellipse.getAttribute("transform"))[0]) * Math.PI) / 180,
      perUnit: Number(circle.getAttribute("r")) / value, names: [...svg.querySelectorAll(".axis-name")].map((text) => text.textContent),
    }];
  }));
}));

/** Every outline reaches as far in each direction n as any S u does: |S n|, with S and n in the frame before the rotation. */
function assertOutlines(read, rotation) {
  Object.keys(matrices).forEach((name, k) => {
    const S = one.result.ellipsoids[name].symmetric_part;
    for (const [plane, [across, up]] of Object.entries(planes)) {
      const { rx, ry, angle, perUnit, names } = read[k][plane];
      assert.deepEqual(names, [..."xyz"].filter((_, axis) => axis === across || axis === up));
      for (let degrees = 0; degrees < 180; degrees += 15) {
        const at = (degrees * Math.PI) / 180;
        const n = frame[across].map((value, axis) => Math.cos(at) * value + Math.sin(at) * frame[up][axis]);
        const want = perUnit * Math.hypot(...times(S, times(transposed(rotation), n)));
        const got = Math.hypot(rx * Math.cos(at - angle), ry * Math.sin(at - angle));
        const rounding = 0.03; // coordinates have two decimals, and so has the circle that gives the scale
        assert.ok(Math.abs(got - want) < rounding, `${name}, ${plane}, ${degrees}°: ${got} is not ${want}`);
      }
    }
  });
}

test("the fixture rotates: Z' = R Z Rᵀ", () => {
  for (const symbol of Object.values(matrices)) {
    const want = product(product(R, one.result.model[symbol]), transposed(R));
    turned.result.model[symbol].forEach((row, j) => row.forEach((value, i) => assert.ok(Math.abs(value - want[j][i]) < 1e-9 * 640)));
  }
});

test("the outlines are the projections of the ellipsoids, and turn with the frame", async () => {
  await reading(onePage, async (page) => assertOutlines(await outlines(page), frame));
  await reading(turnedPage, async (page) => {
    const read = await outlines(page);
    assertOutlines(read, R);
    assert.throws(() => assertOutlines(read, frame), "a drawing that stays as it was is found");
  });
});

const points = (path) => [...path.matchAll(/(-?[\d.]+) (-?[\d.]+)/g)].map(([, x, y]) => [Number(x), Number(y)]);

/** How far a point is inside of a convex polygon around the origin, at least. */
function inside([x, y], polygon) {
  return Math.min(...polygon.map(([x1, y1], k) => {
    const [x2, y2] = polygon[(k + 1) % polygon.length];
    const length = Math.hypot(x2 - x1, y2 - y1);
    return length < 1e-6 ? Infinity : (Math.sign(x1 * y2 - x2 * y1) * ((x2 - x1) * (y - y1) - (y2 - y1) * (x - x1))) / length;
  }));
}

const views = (page) => page.$$eval("#trial-1-ellipsoids .perspective", (all) => all.map((svg) => ({
  outline: svg.querySelector(".ellipse").getAttribute("d"), visible: svg.querySelector(".section:not(.hidden)").getAttribute("d"),
  hidden: svg.querySelector(".section.hidden").getAttribute("d"), names: [...svg.querySelectorAll(".axis-name")].map((text) => text.textContent).join(""),
})));

test("in perspective a sphere is a circle, every curve lies within its outline, and a rotation is seen", async () => {
  const sphere = spatialResult(frame, { stiffness: { values: [300, 300, 300] } });
  await onPage(reportOf(spatialReport(sphere), "sphere"), async (page) => {
    const lengths = points((await views(page))[2].outline).map(([x, y]) => Math.hypot(x, y));
    assert.ok(lengths.length > 60 && Math.max(...lengths) - Math.min(...lengths) < 0.02, `${Math.min(...lengths)} to ${Math.max(...lengths)}`);
  });
  const [before, after_] = await Promise.all([onePage, turnedPage].map(async (file) => {
    let read;
    await reading(file, async (page) => (read = await views(page)));
    return read;
  }));
  [...before, ...after_].forEach(({ outline, visible, hidden, names }) => {
    assert.equal(names, "xyz");
    assert.ok(visible.length > 100 && hidden.length > 100, "some of it is hidden");
    const polygon = points(outline).slice(0, -1);
    for (const point of [...points(visible), ...points(hidden)]) assert.ok(inside(point, polygon) > -0.3, `${point}`); // the sagitta of a side
  });
  before.forEach(({ outline }, k) => assert.notEqual(outline, after_[k].outline));
});

test("a matrix that is not positive beyond its interval has no ellipsoid, and says so", () => reading(openPage, async (page) => {
  for (const place of ["#trial-1-summary .cards", "#trial-1-ellipsoids figure"]) {
    assert.equal(await page.locator(`${place} .projection`).count(), 6, "of the two others");
    assert.equal(await page.locator(`${place} .perspective`).count(), 2);
    assert.match(await page.textContent(`${place} .no-ellipsoid`), /not positive beyond its interval: no ellipsoid/);
  }
  const read = await numbers(page, "#trial-1-ellipsoids");
  assert.equal(read["stiffness-2"].value, -30, "the value itself is told");
  assert.equal(read["stiffness-volume"], undefined);
}));

test("each direction has its cone, and any direction where that is a half space", () => reading(openPage, async (page) => {
  const rows = await page.$$eval("#trial-1-ellipsoids table.principal tbody tr", (all) => all.map((row) => row.lastElementChild.textContent));
  const want = Object.keys(matrices).flatMap((name) => open.result.ellipsoids[name].principal);
  assert.equal(rows.length, 9);
  rows.forEach((text, k) => {
    const { direction, half_angle95_deg: half } = want[k];
    if (half === 90) return assert.equal(text, "any direction");
    const shown = text.replaceAll("−", "-").match(/-?\d+(\.\d+)?/g).map(Number);
    [...direction, half].forEach((value, i) => assert.ok(Math.abs(shown[i] - value) <= (i < 3 ? 0.0051 : 0.51), `${text}: ${value}`));
    return assert.match(text, /, within \d+°$/);
  });
  assert.equal(rows.filter((text) => text === "any direction").length, 2);
}));

test("cards and tables have the numbers of the document", () => reading(turnedPage, async (page) => {
  const { ellipsoids, model, fit, antisymmetry_vectors: vectors } = turned.result;
  const [cards, table, ofModel] = [await numbers(page, "#trial-1-summary .cards"), await numbers(page, "#trial-1-ellipsoids"), await numbers(page, "#trial-1-model")];
  for (const [name, symbol] of Object.entries(matrices)) {
    ellipsoids[name].principal.forEach(({ value, value95 }, k) => {
      for (const [read, key] of [[cards, `card-${symbol}-${k}`], [table, `${name}-${k}`]]) {
        close(read[key].value, value, key);
        close(read[`${key}-low`].value, value95[0], key);
        close(read[`${key}-high`].value, value95[1], key);
      }
    });
    close(cards[`card-${symbol}-volume`].value, ellipsoids[name].volume, "volume");
    close(table[`${name}-shape`].value, ellipsoids[name].shape, "shape");
    model[symbol].forEach((row, j) => row.forEach((value, i) => close(ofModel[`${symbol}${j}${i}`].value, value, symbol)));
  }
  fit.VAF.forEach((value, axis) => close(ofModel[`VAF${axis}`].value, value, "VAF"));
  model.x0.forEach((value, axis) => close(ofModel[`x0${axis}`].value, 1000 * value, "x0"));
  vectors.stiffness.vector.forEach((value, k) => close(table[`stiffness-vector${k}`].value, value, "vector"));
  close(table["stiffness-vector-size"].value, vectors.stiffness.size, "size");
}));

test("the card of the other method has the eigenvalues of its symmetric part, without intervals and drawings", () => {
  const other = spatialResult(R);
  other.result.passivity.models[0].method = "iv";
  return onPage(reportOf(spatialReport(other), "other"), async (page) => {
    const cards = await numbers(page, "#trial-1-summary .cards");
    other.result.ellipsoids.stiffness.principal.forEach(({ value }, k) => assert.ok(Math.abs(cards[`card-K-${k}`].value - 1.02 * value) < 1e-9 * value));
    assert.equal(cards["card-K-0-low"], undefined);
    const shown = (await page.locator("#trial-1-summary .card").first().locator(".towards").first().textContent()).replaceAll("−", "-").match(/-?\d\.\d+/g).map(Number);
    assert.ok(Math.abs(Math.abs(dot(shown, other.result.ellipsoids.stiffness.principal[0].direction)) - 1) < 0.02, `${shown}`);
    assert.equal(await page.locator("#trial-1-summary .cards svg").count(), 0);
  });
});

test("every axis is named: charts, tables and the sentence on the fit", () => reading(onePage, async (page) => {
  await eventually(async () => {
    const names = await page.$$eval(".chart text", (all) => all.map((text) => text.textContent));
    for (const axis of "xyz") assert.ok(names.some((text) => text.startsWith(`Force along ${axis}`)), axis);
  });
  assert.match(await page.textContent("#trial-1-summary"), /of the force along x, 96 % of the force along y and 93 % of the force along z/);
  assert.deepEqual((await page.$$eval("#trial-1-methods .methods tbody th", (all) => all.map((cell) => cell.textContent))).filter((name) => name.includes("z")),
    ["M", "B", "K"].flatMap((symbol) => ["xz", "yz", "zx", "zy", "zz"].map((pair) => `${symbol} ${pair}`)));
  const text = await page.textContent("main");
  assert.doesNotMatch(text, /NaN|null|Infinity|\[object|undefined|counter-clockwise|ellipse(?!s? join)/);
  assert.equal(await page.locator(".force-field, #trial-1-ellipses, .literature").count(), 0);
}));

test("several recordings stand side by side at one scale", () => reading(severalPage, async (page) => {
  assert.equal(await page.locator("#overview .perspective").count(), 6);
  const read = await page.$$eval("#overview table.overview tbody tr:first-child .matrix", (all) => all.map((matrix) => [...matrix.querySelectorAll("data")].map((one) => Number(one.value))));
  Object.values(matrices).forEach((symbol, k) => assert.deepEqual(read[k], one.result.model[symbol].flat()));
  assert.match(await page.textContent("#overview"), /Each matrix is shown as xx, xy, xz above yx, yy, yz above zx, zy, zz\./);
}));

for (const [name, file] of [["one", onePage], ["not closed", openPage], ["several", severalPage]]) {
  test(`nothing is cut off from 900 to 1920 px, and axe finds no violation: ${name}`, () => onPage(file, async (page) => {
    await drawn(page);
    await page.$$eval("details.trial", (all) => all.forEach((details) => (details.open = true)));
    for (const width of [900, 1280, 1920]) {
      await page.setViewportSize({ width, height: 900 });
      await eventually(async () => assert.deepEqual(await clipped(page), [], `${width} px`));
    }
    assert.deepEqual(await violationsInBoth(page), []);
  }));
}

test("undefined numbers are said to be undefined", async () => {
  const none = (value) => (Array.isArray(value) ? value.map(none) : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, none(v)])) : typeof value === "number" ? null : value);
  const empty = spatialResult();
  for (const key of ["model", "standard_error", "ellipsoids", "antisymmetry_vectors"]) empty.result[key] = none(empty.result[key]);
  await onPage(reportOf(spatialReport(empty), "empty-space"), async (page) => {
    await drawn(page);
    assert.doesNotMatch(await page.textContent("main"), /NaN|null|Infinity|\[object/);
    assert.equal(await page.locator(".projection, .perspective").count(), 0);
    assert.deepEqual(await violations(page), []);
  });
});

test("on a screen of 1280 × 800 the verdict and all drawings of K, B and M are seen at once", () => onPage(onePage, async (page) => {
  const bottom = await page.$$eval("#trial-1-summary .verdict, #trial-1-summary .cards svg", (all) => all.map((one) => one.getBoundingClientRect().bottom));
  assert.equal(bottom.length, 13);
  assert.ok(Math.max(...bottom) <= 800, `${Math.max(...bottom)}`);
}, { viewport: { width: 1280, height: 800 } }));

test("pictures, to be looked at", () => onPage(onePage, (page) => picture(page, "space")));

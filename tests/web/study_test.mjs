// The pages of mbk study report in a browser: what they say is what the document holds, a change is claimed only where its
// minimal detectable change is known and exceeded, and they are quiet, offline, accessible and printable.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { changed, closeBrowser, documentOf, drawn, folder, mbk, onPage, picture, reading, violationsInBoth } from "./browser.mjs";

after(closeBrowser);

const hostile = "<img src=x onerror=\"document.title='owned'\"> & Größe";

function run(...args) {
  const ran = mbk(...args.map(String));
  if (ran.code !== 0) throw new Error(`${args.join(" ")}: ${ran.err}`);
  return ran.out;
}

const base = run("simulate", "--show", "relaxed_sinusoidal").replace("duration_s = 62.1", "duration_s = 22.1");
const arm = (name, factor) => writeFileSync(join(folder, name), base.replace(/\[participant\]\n(?:(?!\n\[)[^])*\n/,
  `[participant]\nkind = "linear"\nmass_kg = [[1.1, -0.2], [-0.2, 0.9]]\ndamping_Ns_per_m = [[9, -3], [-3, 14]]\nstiffness_N_per_m = [[${90 * factor}, ${-35 * factor}], [${-45 * factor}, ${240 * factor}]]\n`));

/** A study of so many people in two sessions; the third came back with an arm twice as stiff. */
function study(name, people) {
  run("study", "init", name, "--title", hostile);
  for (let p = 1; p <= people; ++p) {
    for (const session of [1, 2]) {
      arm("arm.toml", (1 + 0.1 * p) * (p === 3 && session === 2 ? 2 : 1));
      run("simulate", "arm.toml", "--seed", 10 * p + session, "--quiet", "--out", "trial.h5", "--overwrite");
      run("study", "add", "trial.h5", "--participant", p, "--session", session, "--condition", "relaxed", "--study", name, "--quiet");
    }
  }
  arm("arm.toml", 1);
  run("simulate", "arm.toml", "--quiet", "--out", "trial.h5", "--overwrite");
  run("study", "add", "trial.h5", "--participant", 1, "--session", 2, "--condition", "relaxed", "--study", name, "--quiet");
  run("study", "measure", "--study", name, "--quiet");
  run("study", "exclude", 2 * people + 1, "--why", hostile, "--study", name);
}

function page(name, file, ...args) {
  run("study", "report", "--study", name, "--out", `${file}.html`, ...args);
  return join(folder, `${file}.html`);
}

study("six", 6);
study("two", 3);
const whole = page("six", "study", "--compare", "session", 1, 2);
const stiffer = page("six", "stiffer", "--participant", 3);
const same = page("six", "same", "--participant", 2);
const few = page("two", "few");
const fewStiffer = page("two", "few-stiffer", "--participant", 3);
run("study", "init", "nothing");
const nothing = page("nothing", "nothing");

const claims = /more than measurement error/;

test("a change beyond the minimal detectable change is said once, in words, and another is not", async () => {
  await reading(stiffer, async (tab) => {
    const said = await tab.textContent(".said");
    assert.match(said, /In session 2 the largest stiffness is [\d\u202f]+\u00a0% higher than in session 1: more than measurement error explains\./);
    const { courses } = documentOf(stiffer);
    const { changes } = courses.find(({ outcome }) => outcome === "stiffness_lambda_max").participants[0];
    assert.equal(changes[0].verdict, "beyond-error");
    assert.ok(changes[0].difference > changes[0].mdc95_interval[1]);
    assert.equal(Number(await tab.getAttribute('.statement data[data-name="difference"]', "value")), changes[0].difference);
    assert.match(await tab.textContent("#limits"), /good or bad/);
  });
  await reading(same, async (tab) => {
    assert.match(await tab.textContent(".said"), /no detectable change in the largest stiffness\./);
    assert.match(await tab.textContent(".statement"), /does not prove that nothing changed/);
    assert.doesNotMatch(await tab.textContent("#change"), claims);
  });
});

test("where too few people came again nothing is claimed, however large the difference", async () => {
  await reading(fewStiffer, async (tab) => {
    assert.match(await tab.textContent(".said"), /higher than in session 1\. Whether that is more than measurement error is not known\./);
    assert.match(await tab.textContent(".statement"), /only 3 people have two sessions or more, and 5 are needed/);
    assert.doesNotMatch(await tab.textContent("#change"), /: more than measurement error/);
    assert.doesNotMatch((await tab.textContent("main")).replace(/Whether that is more than measurement error is not known/g, ""), claims);
    assert.equal(await tab.locator("#change .band, #change .beyond-error, #change .uncertain").count(), 0);
  });
  await reading(few, async (tab) => {
    assert.equal(await tab.locator("#sessions .band, #sessions .beyond-error").count(), 0);
    assert.match(await tab.textContent('#sessions [data-name="mdc-unknown"]'), /not known: only 3 people/);
    assert.match(await tab.textContent("#summary"), /no reliability stated, too few people: 3/);
    assert.doesNotMatch(await tab.textContent("main"), claims);
  });
});

test("no change of one outcome hides no other that changed", () => {
  const file = changed(same, "others", ({ courses }) => {
    for (const { outcome, participants } of courses) {
      if (["damping_lambda_max", "M_xx"].includes(outcome)) participants[0].changes[0].verdict = "beyond-error";
      else participants[0].changes[0].verdict = "within-error";
    }
  });
  return onPage(file, async (tab) => {
    assert.match(await tab.textContent(".said"), /no detectable change in the largest stiffness\./);
    assert.match(await tab.textContent(".others"), /^2 other outcomes of \d+ changed by more than measurement error explains: largest damping \(.+\), inertia xx \(.+\)\.$/);
    assert.match(await tab.textContent("#outcomes"), /inertia xx/);
  });
});

test("where errors have heavy tails the page says that its interval does not hold", () => {
  const file = changed(same, "tails", ({ courses }) => {
    for (const { participants } of courses) for (const one of participants[0].changes) one.heavy_tails = true;
  });
  return onPage(file, async (tab) => assert.match(await tab.textContent(".statement"), /heavier tails than a normal distribution.* not valid/));
});

test("an uncertain minimal detectable change makes no sure claim", () => {
  const file = changed(stiffer, "uncertain", ({ courses }) => {
    for (const { participants } of courses) for (const { changes } of participants) for (const one of changes) one.verdict = "uncertain";
  });
  return onPage(file, async (tab) => {
    assert.match(await tab.textContent(".said"), /It is not certain that this is more than measurement error\./);
    assert.doesNotMatch(await tab.textContent("#change .said"), /explains/);
  });
});

test("the page of the study shows every participant, and what does not count with its reason as text", () => reading(whole, async (tab) => {
  assert.equal(await tab.textContent("h1"), hostile);
  assert.notEqual(await tab.title(), "owned");
  assert.equal(await tab.locator("#participants svg.forest rect.value").count(), 6);
  assert.equal(await tab.locator("#sessions svg.course.small").count(), 6);
  assert.equal(await tab.locator('#sessions [data-verdict="beyond-error"]').getAttribute("data-participant"), "3");
  const rows = await tab.$$eval("#left-out tbody tr", (all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
  assert.deepEqual(rows, [["13", "1", "2", "relaxed", "2", "excluded", hostile]]);
  const { summary } = documentOf(whole);
  const stiffness = summary.reliability.find(({ outcome }) => outcome === "stiffness_lambda_max");
  const icc = stiffness.between_sessions.icc.find(({ form, averaged }) => form === "agreement" && averaged === 1);
  assert.equal(Number(await tab.getAttribute('#reliability tbody tr data[data-name="icc"]', "value")), icc.value);
  assert.equal(Number(await tab.getAttribute('#reliability tbody tr data[data-name="mdc"]', "value")), stiffness.between_sessions.error[0].mdc95);
}));

test("differences have the p that was corrected for all tests, and an effect size", () => reading(whole, async (tab) => {
  const { comparison } = documentOf(whole).summary;
  const stiffness = comparison.outcomes.find(({ outcome }) => outcome === "stiffness_lambda_max");
  const row = await tab.$eval("#comparison tbody tr", (one) => [...one.children].map((cell) => cell.textContent));
  assert.equal(row[1], `${stiffness.first_participants}\u00a0paired`);
  assert.deepEqual(row.slice(3, 6).map(Number), [stiffness.p, stiffness.p_holm, stiffness.permutation.p].map((value) => Number(value.toFixed(3))));
  assert.equal(row[6], "no detectable difference");
  assert.match(await tab.textContent("#comparison caption"), new RegExp(`corrected for ${comparison.tests} tests`));
  assert.ok((await tab.locator("#comparison svg.forest rect.value").count()) > 8);
}));

test("another outcome can be chosen by keyboard", () => onPage(whole, async (tab) => {
  const select = tab.locator("#sessions select");
  await select.selectOption("K_xx");
  assert.match(await tab.textContent("#sessions .chosen"), /stiffness xx \[N\/m\]/);
  assert.equal(await tab.locator("#sessions svg.course.small").count(), 6);
}));

test("the data can be saved, and a spreadsheet takes none of it for a formula", () => onPage(whole, async (tab) => {
  const saved = async (name) => {
    const [file] = await Promise.all([tab.waitForEvent("download"), tab.getByRole("button", { name }).click()]);
    return readFileSync(await file.path(), "utf8");
  };
  const csv = (await saved("Save results (CSV)")).trim().split("\n");
  const { outcomes, results } = documentOf(whole);
  assert.equal(csv.length - 1, results.reduce((sum, { values }) => sum + values.filter((value) => value !== null).length, 0));
  const row = csv.find((line) => line.startsWith("2,1,relaxed,1,") && line.includes(",K_xx,")).split(",");
  const column = outcomes.findIndex(({ name }) => name === "K_xx");
  assert.equal(Number(row[6]), results.find(({ recording }) => recording === Number(row[4])).values[column]);
  assert.deepEqual(JSON.parse(await saved("Save everything (JSON)")), documentOf(whole));
  assert.match(await saved("Save sessions and changes (CSV)"), /beyond-error/);
}));

test("the page of a participant holds nothing of others", () => {
  const json = documentOf(same);
  assert.deepEqual(new Set(json.recordings.map(({ participant }) => participant)), new Set([2]));
  assert.equal(json.results.length, 2);
  for (const { participants } of json.courses) assert.deepEqual(participants.map(({ participant }) => participant), [2]);
});

test("the last session is drawn over the range of the controls, and sides are compared", () => {
  const normal = (controls, range95) => ({ controls, not_comparable: 0, mean: range95[0] === null ? null : (range95[0] + range95[1]) / 2, range95 });
  const curve = (speed, controls, high) => ({ speed, torque: [1, 2, 3], controls, above: high === null ? null : 2 / 3, below: high === null ? null : 0,
    mean: [high, high, high].map((one) => one && one / 2), low95: [high && 0, high && 0, high && 0], high95: [high, high, null] });
  const file = changed(same, "controls", (json) => {
    json.controls = { name: hostile, participants: 6, is_one: false };
    json.stretches = [{ condition: "left", session: 2, results: 1, direction: 1, position_unit: "°", torque_unit: "N·m", position: [90, 110, 130], speeds: [curve(10, 6, 1.5), curve(180, 4, null)] }];
    json.ranges = ["slope", "catch"].map((name) => ({ condition: "left", outcome: `stretch_increasing_${name}`, unit: "N·m·s/rad", session: 2, results: 1, value: 0.25, without: name === "catch" ? 3 : 0,
      normal: name === "catch" ? normal(3, [null, null]) : normal(6, [0.1, 0.2]), verdict: name === "catch" ? "unknown" : "above" }));
    json.ranges.push({ ...json.ranges[1], outcome: "stretch_increasing_torque", without: 0, normal: { ...normal(2, [null, null]), not_comparable: 4 }, why_not_comparable: "4 of 6 controls were stretched to another speed" });
    json.sides = [{ left_condition: "left", right_condition: "right", outcome: "stretch_increasing_slope", unit: "N·m·s/rad", session: 2, left: 0.25, right: 0.1, difference: 0.15, error95: 0.02,
      error95_interval: [null, null], error_basis: "recordings", why_unknown: "only 2 people have two sessions", heavy_tails: false, verdict: "unknown", normal: normal(6, [-0.01, 0.02]), range_verdict: "above" }];
  });
  return onPage(file, async (tab) => {
    assert.match(await tab.textContent('#controls [data-name="controls"]'), /6 participants of the group/);
    assert.equal(await tab.locator("#controls svg.curve-panel").count(), 2);
    assert.equal(await tab.locator("#controls svg.curve-panel .band").count(), 1);
    const notes = await tab.$$eval("#controls .panel-note", (all) => all.map((one) => one.textContent));
    assert.match(notes[0], /Above the range at 67\u00a0% of the positions \(6 controls\)/);
    assert.match(notes[1], /No range: 4 controls; 5 are needed/);
    const rows = await tab.$$eval("#controls table tbody tr", (all) => all.map((row) => row.lastElementChild.textContent));
    assert.deepEqual(rows, ["above the range", "not comparable: 4 of 6 controls were stretched to another speed", "not known"]);
    assert.match(await tab.textContent("#controls table"), /3 of 6 controls; 5 are needed/);
    assert.equal(Number(await tab.getAttribute('#sides data[data-name="side-difference"]', "value")), 0.15);
    assert.match(await tab.textContent("#sides"), /only 2 people have two sessions/);
    assert.doesNotMatch(await tab.textContent("#sides"), claims);
    assert.match(await tab.textContent("#limits"), /not a disorder/);
    assert.match(await tab.textContent("#limits"), /not a diagnosis/);
    assert.ok(await tab.evaluate(() => document.querySelector("#controls").compareDocumentPosition(document.querySelector("#change")) & 4));
    assert.deepEqual(await violationsInBoth(tab), []);
    assert.doesNotMatch(await tab.textContent("main"), /NaN|Infinity|\[object|undefined/);
  });
});

test("a study without recordings says so", () => reading(nothing, async (tab) => {
  assert.match(await tab.textContent("#summary"), /no recordings yet/);
  assert.doesNotMatch(await tab.textContent("main"), /NaN|null|undefined|Infinity|\[object/);
}));

const files = { whole, stiffer, same, few, "few-stiffer": fewStiffer, nothing };
for (const [name, file] of Object.entries(files)) {
  test(`axe finds no violation, nothing is undefined or too wide: ${name}`, () => onPage(file, async (tab) => {
    await drawn(tab);
    await tab.$$eval("details", (all) => all.forEach((one) => (one.open = true)));
    assert.deepEqual(await violationsInBoth(tab), []);
    assert.doesNotMatch(await tab.textContent("main"), /NaN|Infinity|\[object|undefined/);
    for (const width of [1280, 900, 390]) {
      await tab.setViewportSize({ width, height: 900 });
      assert.ok((await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0, `${width} px`);
    }
  }));
}

test("pictures, and A4 pages: that of a participant is short", async () => {
  for (const [name, most] of [["whole", 9], ["stiffer", 3], ["few", 8]]) {
    await onPage(files[name], async (tab) => {
      const pages = (await picture(tab, `study-${name}`)).toString("latin1").match(/\/Type \/Page\b/g).length;
      assert.ok(pages <= most, `${name}: ${pages} pages`);
      await tab.emulateMedia({ media: "print" });
      await tab.setViewportSize({ width: 673, height: 900 });
      const wide = await tab.$$eval("main svg, main table", (all) => all.filter((one) => one.getBoundingClientRect().right > 674).map((one) => one.getAttribute("class")));
      assert.deepEqual(wide, [], name);
    });
  }
});

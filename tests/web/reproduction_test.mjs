// The page of mbk reproduce in a browser: its numbers are those of reproduction.json, and a reader finds the way by keyboard.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, test } from "node:test";
import { pathToFileURL } from "node:url";
import { assertShown, changed, close, closeBrowser, documentOf, drawn, eventually, folder, mbk, numbers, onPage, open, picture, reading, screenshot, violations, violationsInBoth } from "./browser.mjs";

after(closeBrowser);

const made = mbk("reproduce", ...["table-3.6", "table-3.3", "table-5.3"].flatMap((id) => ["--only", id]), "--out", "made", "--json", "--quiet");
if (made.code !== 0) throw new Error(made.err);
const real = { file: join(folder, "made", "index.html"), json: JSON.parse(made.out) };

/** A drawing with a script in it, as none of mbk is. */
const drawing = (name, colour) => `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 420" width="760" height="420" onload="parent.document.title='owned'" font-family="Helvetica, Arial, sans-serif">
<script>parent.document.title = "owned"</script><title>${name}</title><rect width="100%" height="100%" fill="#fff"/>
<text x="24" y="26" font-size="16" font-weight="bold">${name}</text><rect x="78" y="44" width="660" height="300" fill="none" stroke="#444"/>
<path d="M78 300 C 200 60 300 60 408 200 S 640 330 738 100" fill="none" stroke="${colour}" stroke-width="2"/></svg>`;

const chart = (title, series) => ({
  title,
  x: { label: "time", unit: "s", logarithmic: false },
  y: { label: "force", unit: "N", logarithmic: false },
  equal_scale: false, identity: false,
  horizontal: [{ value: 2, name: "threshold" }], vertical: [],
  notes: ["One note of the chart."],
  series: series.map((name, k) => ({ name, drawn: "line", x: [0, 0.5, 1], y: [k, -1.25 - k, 2], intervals: k === 0 ? [] : [[0, 2], [-3, -2], [1, 3]] })),
});

const cell = (ours, rest = {}) => ({ printed: null, printed_value: null, rounding: 0, ours, difference: null, spread: null, range: null, agreement: "not compared", ...rest });
const beside = (ours, printed, rest = {}) => cell(ours, { printed, printed_value: Number(printed), rounding: 0.05, difference: ours - Number(printed), ...rest });
const exhibit = (id, kind, chapter, title, provenance, rest = {}) =>
  ({ id, kind, chapter, title, provenance, text: [`A paragraph on ${title.toLowerCase()}.`], commands: [`mbk reproduce --only ${id} --out folder`], related: [], tables: [], charts: [], ...rest });

const wideNames = ["m_xx", "m_xy", "m_yx", "m_yy", "b_xx", "b_xy", "b_yx", "b_yy", "k_xx", "k_xy", "k_yx", "k_yy", "x0", "y0", "VAF x", "VAF y", "passive"];
const widest = {
  id: "4.1", title: "Impedance with a task", provenance: "simulated", what_rows_are: "participant", spread_is: "standard error over 4 trials", erratum: null,
  columns: wideNames.map((name, k) => ({ name, unit: k < 4 ? "kg" : k < 8 ? "N·s/m" : k < 12 ? "N/m" : k < 14 ? "mm" : k < 16 ? "%" : "", decimals: k < 8 ? 2 : 1 })),
  rows: [1, 2, 3, 4, 5, 6].map((person) => ({
    name: `P${person}`,
    cells: wideNames.map((_, k) => (k === 16 ? cell("4 of 4", { printed: "passive" }) : cell((k + 1) * person * (k < 8 ? 1.2345 : -61.789), { spread: 0.01234 * (k + 1) * person, ...(k % 5 === 0 ? { printed: "12.3", printed_value: 12.3, difference: (k + 1) * person - 12.3 } : {}) }))),
  })),
};
const differing = {
  id: "A.1", title: "With everything that a cell can be", provenance: "recomputed", what_rows_are: "", spread_is: "", erratum: "erratum-99",
  columns: [{ name: "ours", unit: "N", decimals: 3 }, { name: "λ, \"quoted\"", unit: "", decimals: 1 }],
  rows: [
    { name: "agrees", cells: [beside(5.6923, "5.7", { agreement: "within rounding", range: [5.62, 5.76] }), cell("only words, and a comma")] },
    { name: "differs", cells: [beside(-4.5, "-2.90", { agreement: "differs" }), cell(null, { printed: "—" })] },
    { name: "erratum", cells: [beside(3e9, "1", { agreement: "erratum" }), beside(1e-9, "0", { agreement: "within rounding" })] },
    { name: "nothing", cells: [cell(null), cell(0, { spread: 0.0004 })] },
  ],
};

/** A document that holds every kind of thing besides what mbk made. */
const every = changed(real.file, "every", (page) => {
  const { exhibits, agreement } = page.reproduction;
  exhibits.push(
    exhibit("figure-4.3", "figure", 4, "Force after a pulse", "simulated", { charts: ["First", "Second", "Third"].map((name) => chart(`${name} pulse`, ["measured", "predicted"])), related: ["table-4.1", "table-9.9"] }),
    exhibit("figure-3.1", "figure", 3, "The handle and the robot", "simulated", { charts: [chart("Only one", ["measured"])] }),
    exhibit("figure-3.2", "figure", 3, "A photograph of the rig", "not recoverable", { text: ["It is a photograph; nothing stands in for it."], commands: [] }),
    exhibit("table-4.1", "table", 4, "Impedance of the arm with a task", "simulated", { tables: [widest] }),
    exhibit("table-a.1", "table", 0, "Parameters of the robot", "recomputed", { tables: [differing] }),
    exhibit("erratum-1", "erratum", 3, "Half of the largest eigenvalue stands for the smallest", "recomputed", { related: ["table-3.6"] }),
    exhibit("question-2", "question", 0, "Is the arm passive while it acts?", "simulated"),
    exhibit("future-work-4", "future work", 6, "Three dimensions", "simulated"),
  );
  agreement.differs += 1;
  agreement.erratum += 1;
  agreement["within rounding"] += 2;
  agreement["not compared"] += widest.rows.flatMap(({ cells }) => cells).filter(({ printed }) => printed !== null).length + 1;
  page.drawings["figure-4.3"] = ["#0072b2", "#d55e00", "#009e73"].map((colour, k) => drawing(`${["First", "Second", "Third"][k]} pulse`, colour));
  page.drawings["figure-3.1"] = [drawing("Only one", "#0072b2")];
});

const openAll = (page) => page.$$eval("details", (all) => all.forEach((one) => (one.open = true)));
const shownArticles = (page) => page.$$eval("article", (all) => all.filter((one) => !one.hidden).map(({ id }) => id));
const pressed = async (page, ...keys) => {
  for (const key of keys) await page.keyboard.press(key);
};
const focusedId = (page) => page.evaluate(() => document.activeElement?.id);

for (const [name, file] of Object.entries({ "what mbk made": real.file, "every kind of thing": every })) {
  test(`each cell is that of the document, every digit of it, rounded as print is: ${name}`, () => reading(file, async (page) => {
    const { exhibits } = documentOf(file).reproduction;
    let compared = 0;
    for (const { id, tables } of exhibits) {
      const read = await numbers(page, `[id="${id}"]`);
      for (const [k, table] of tables.entries()) {
        for (const [r, row] of table.rows.entries()) {
          for (const [c, cell] of row.cells.entries()) {
            const at = `${id}-table-${k + 1}-r${r + 1}c${c + 1}`;
            const same = (suffix, value) => {
              const number = read[at + suffix];
              if (typeof value !== "number") return assert.equal(number, undefined, at + suffix);
              close(number.value, value, at + suffix);
              assertShown(number, at + suffix);
              compared += 1;
            };
            same("", cell.ours);
            same("-spread", cell.spread);
            same("-printed", cell.printed_value);
            same("-difference", cell.difference);
            same("-low", cell.range?.[0]);
            same("-high", cell.range?.[1]);
            const decimals = /^-?\d+(?:\.(\d+))?$/.exec(cell.printed ?? "");
            const expected = decimals ? (decimals[1] ?? "").length : table.columns[c].decimals;
            if (typeof cell.ours === "number" && Math.abs(cell.ours) < 1e7) assert.equal((/\.(\d+)$/.exec(read[at].shown)?.[1] ?? "").length, expected, `${at}: ${read[at].shown} beside ${cell.printed}`);
            if (cell.printed_value !== null) assert.equal(read[`${at}-printed`].shown.replaceAll("−", "-"), cell.printed);
          }
        }
      }
    }
    assert.ok(compared > 300, `${compared} numbers`);
  }));

  test(`the tally counts the cells, and each is marked: ${name}`, () => reading(file, async (page) => {
    const { exhibits, agreement } = documentOf(file).reproduction;
    const cells = exhibits.flatMap(({ tables }) => tables.flatMap(({ rows }) => rows.flatMap((row) => row.cells)));
    const read = await numbers(page, "#tally");
    for (const [word, sign] of [["within rounding", "✓"], ["round trip", "↺"], ["erratum", "!"], ["differs", "≠"]]) {
      const count = cells.filter((cell) => cell.agreement === word).length;
      assert.equal(agreement[word], count, word);
      assert.equal(read[`tally-${word.replace(" ", "-")}`].value, count, word);
      const marks = await page.$$eval(`article td .mark.${word.replace(" ", "-")} [aria-hidden]`, (all) => all.map((one) => one.textContent));
      assert.deepEqual(marks, Array(count).fill(sign));
    }
    // Every printed cell is counted once: what is compared with nothing has its own count.
    const printed = cells.filter((cell) => cell.printed !== null);
    assert.equal(read["tally-not-compared"].value, printed.filter((cell) => cell.agreement === "not compared").length);
    assert.equal(Object.values(read).reduce((sum, { value }) => sum + value, 0), printed.length);
    assert.match(await page.textContent("#tally"), new RegExp(`Of ${printed.length} printed numbers`));
    assert.equal(await page.textContent(".source"), documentOf(file).reproduction.source);
  }));

  test(`axe finds no violation with everything open: ${name}`, () => onPage(file, async (page) => {
    await openAll(page);
    await page.getByLabel("Show differences in all tables").check();
    assert.deepEqual(await violationsInBoth(page), []);
  }));
}

test("chapters and kinds follow each other, by number", () => reading(every, async (page) => {
  const groups = await page.$$eval("section.group", (all) => all.map((one) => [one.id, [...one.querySelectorAll("article")].map(({ id }) => id)]));
  assert.deepEqual(groups, [
    ["chapter-3", ["table-3.3", "table-3.6", "figure-3.1", "figure-3.2"]],
    ["chapter-4", ["table-4.1", "figure-4.3"]],
    ["chapter-5", ["table-5.3"]],
    ["appendices", ["table-a.1"]],
    ["errata", ["erratum-1"]],
    ["questions", ["question-2"]],
    ["future-work", ["future-work-4"]],
  ]);
  const names = await page.$$eval("nav a:not(.group)", (all) => all.map((link) => [link.hash.slice(1), link.querySelector("strong").textContent]));
  assert.deepEqual(names.map(([id]) => id), groups.flatMap(([, ids]) => ids));
  assert.deepEqual(names.filter(([id]) => /a\.1|future|erratum/.test(id)).map(([, name]) => name), ["Table A.1", "Erratum 1", "Future work 4"]);
  const chips = await page.$$eval("article > .exhibit-name .chip", (all) => all.map((one) => one.dataset.provenance));
  assert.deepEqual(new Set(chips), new Set(["recomputed", "simulated", "not recoverable"]));
}));

test("a filter by words and by provenance, with the keyboard alone", () => onPage(every, async (page) => {
  const all = await shownArticles(page);
  await page.focus("#filter-text");
  await page.keyboard.type("pulse FORCE");
  assert.deepEqual(await shownArticles(page), ["figure-4.3"]);
  assert.match(await page.textContent(".shown-count"), new RegExp(`^1 of ${all.length} `));
  assert.deepEqual(await page.$$eval("nav a:not(.group)", (links) => links.filter((link) => link.offsetParent).map((link) => link.hash)), ["#figure-4.3"]);
  assert.equal(await page.locator("section.group:visible").count(), 1);
  await page.keyboard.type(" no such thing");
  assert.deepEqual(await shownArticles(page), []);
  assert.ok(await page.locator("#nothing").isVisible());
  for (const name of ["recomputed", "simulated"]) {
    await page.getByRole("checkbox", { name: name, exact: true }).focus();
    await pressed(page, "Space");
  }
  await page.focus("#filter-text");
  await pressed(page, "Control+a", "Delete");
  await eventually(async () => assert.deepEqual(await shownArticles(page), ["figure-3.2"]));
  await page.getByRole("button", { name: "Show all" }).focus();
  await pressed(page, "Enter");
  await eventually(async () => assert.deepEqual(await shownArticles(page), all));
  await eventually(async () => assert.equal(await focusedId(page), "filter-text"));
  // A table of another provenance than its exhibit is found by both.
  await page.getByRole("checkbox", { name: "recomputed", exact: true }).uncheck();
  assert.ok((await shownArticles(page)).includes("table-3.3"));
  assert.ok(!(await shownArticles(page)).includes("table-3.6"));
}));

test("the tally leads to where the numbers are", () => onPage(every, async (page) => {
  await page.locator("#tally li.erratum button").click();
  await eventually(async () => assert.deepEqual(await shownArticles(page), ["table-3.6", "table-a.1"]));
  await eventually(async () => assert.equal(await focusedId(page), "table-3.6"));
  await page.locator("#tally li.differs button").click();
  await eventually(async () => assert.deepEqual(await shownArticles(page), ["table-a.1"]));
}));

test("an address leads to an exhibit, and past a filter", async () => {
  const { page, said, close: done } = await open(every);
  const at = (id) => page.$eval(`[id="${id}"]`, (one) => one.getBoundingClientRect().top);
  await page.goto("about:blank");
  await page.goto(`${pathToFileURL(every).href}#table-5.3`);
  await page.waitForSelector("main");
  assert.equal(await focusedId(page), "table-5.3");
  assert.ok(Math.abs(await at("table-5.3")) < 60, `${await at("table-5.3")}`);
  await page.waitForSelector('nav a[href="#table-5.3"][aria-current]');
  await page.fill("#filter-text", "pulse");
  await page.evaluate(() => (location.hash = "slip-1")); // the name that errata had before
  await page.waitForFunction(() => document.activeElement?.id === "erratum-1");
  assert.equal(await page.inputValue("#filter-text"), "");
  await page.locator('nav a[href="#figure-4.3"]').focus();
  await pressed(page, "Enter");
  await page.waitForFunction(() => document.activeElement?.id === "figure-4.3");
  assert.deepEqual(said, []);
  await done();
});

test("links lead somewhere: to exhibits of this page, and to files that are there", () => reading(real.file, async (page) => {
  const hrefs = await page.$$eval("main a[href]", (all) => all.map((link) => link.getAttribute("href")));
  const ids = new Set(await page.$$eval("[id]", (all) => all.map(({ id }) => id)));
  const files = hrefs.filter((href) => !href.startsWith("#"));
  for (const href of hrefs.filter((one) => one.startsWith("#"))) assert.ok(ids.has(href.slice(1)), href);
  for (const href of files) assert.ok(existsSync(join(dirname(real.file), href)), href);
  assert.equal(files.length, 2 * real.json.exhibits.reduce((sum, { tables }) => sum + tables.length, 0) + 1);
  // What is not on the page is named and not linked.
  assert.match(await page.textContent('[id="table-3.6"] .see-also'), /Erratum 1/);
  assert.equal(await page.locator('a[href="#erratum-1"]').count(), 0);
}));

test("an erratum is linked from its cells, and lists the tables that it explains", () => onPage(every, async (page) => {
  const errata = page.locator('[id="table-3.6"] td.erratum a');
  assert.equal(await errata.count(), 8);
  await page.locator('[id="table-3.6"] td.erratum').first().focus();
  await pressed(page, "Enter");
  await page.waitForFunction(() => document.activeElement?.id === "erratum-1");
  assert.deepEqual(await page.$$eval('[id="erratum-1"] .related a', (all) => all.map((link) => link.hash)), ["#table-3.6"]);
}));

test("a cell says everything when it is chosen, and the arrow keys lead from cell to cell", () => onPage(every, async (page) => {
  const block = '[id="table-3.6-table-1"]';
  const [table] = real.json.exhibits.find(({ id }) => id === "table-3.6").tables;
  assert.equal(await page.locator(`${block} td[tabindex="0"]`).count(), 1);
  await page.locator(`${block} td[tabindex="0"]`).focus();
  await pressed(page, "ArrowDown", "ArrowRight", "ArrowRight", "ArrowUp", "ArrowLeft", "ArrowDown", "ArrowDown");
  const said = await page.textContent(`${block} .cell-facts`);
  const cell = table.rows[2].cells[0];
  for (const part of [table.rows[2].name, table.columns[0].name, String(cell.ours), `printed ${cell.printed}`, String(cell.difference), String(cell.range[0]), cell.agreement]) {
    assert.ok(said.includes(part.replaceAll("-", "−")) || said.includes(part), `${part} in: ${said}`);
  }
  assert.equal(await page.getAttribute(`${block} td[tabindex="0"]`, "title"), said);
  await pressed(page, "End");
  await eventually(async () => assert.match(await page.textContent(`${block} .cell-facts`), new RegExp(`${table.columns.at(-1).name}.*erratum 1`)));
  await eventually(async () => assert.equal(await page.locator(`${block} td[tabindex="0"]`).count(), 1));
}));

test("differences are shown where they are asked for, in one table or in all", () => onPage(every, async (page) => {
  const shown = () => page.locator("td .difference:visible").count();
  const all = await page.locator("td .difference").count();
  assert.equal(await shown(), 0);
  const one = page.locator('[id="table-3.6"]').getByRole("button", { name: "Show differences" });
  await one.focus();
  await pressed(page, "Enter");
  await eventually(async () => assert.equal(await one.getAttribute("aria-pressed"), "true"));
  await eventually(async () => assert.equal(await shown(), await page.locator('[id="table-3.6"] td .difference').count()));
  const every = page.getByLabel("Show differences in all tables");
  await every.focus();
  await pressed(page, "Space");
  await eventually(async () => assert.equal(await shown(), all));
  await pressed(page, "Space");
  await eventually(async () => assert.equal(await shown(), 0));
  await eventually(async () => assert.equal(await one.getAttribute("aria-pressed"), "false"));
}));

test("the CSV that the page saves is the file beside it", () => onPage(real.file, async (page) => {
  const parsed = (text) => text.trim().split("\n").map((line) => [...line.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g)].map(([, value]) => value));
  for (const name of ["table-3.6", "table-3.3-1", "table-3.3-2", "table-5.3-1", "table-5.3-2"]) {
    const block = page.locator(`[id="${name.replace(/-(\d)$/, "-table-$1")}${/-\d$/.test(name) ? "" : "-table-1"}"]`);
    const [download] = await Promise.all([page.waitForEvent("download"), block.getByRole("button", { name: /^Save CSV/ }).click()]);
    assert.equal(download.suggestedFilename(), `${name}.csv`);
    const [saved, file] = [readFileSync(await download.path(), "utf8"), readFileSync(join(folder, "made", "tables", `${name}.csv`), "utf8")].map(parsed);
    assert.equal(saved.length, file.length);
    file.forEach((row, r) => row.forEach((value, k) => {
      if (r === 0 || value === "" || Number.isNaN(Number(value))) return assert.equal(saved[r][k], value);
      const digits = 1e-9; // the JSON has twelve digits, and a difference loses some
      assert.ok(Math.abs(Number(saved[r][k]) - Number(value)) <= digits * (1 + Math.abs(Number(value))), `${name} ${r} ${k}: ${saved[r][k]} is not ${value}`);
    }));
  }
}));

test("a chart opens larger with Enter, the arrow keys go on, Escape leads back", () => onPage(every, async (page) => {
  const pictures = page.locator('[id="figure-4.3"] .picture');
  assert.equal(await pictures.count(), 3);
  await pictures.nth(1).focus();
  await pressed(page, "Enter");
  const dialog = page.locator("dialog");
  const alt = () => dialog.locator("img").getAttribute("alt");
  await eventually(async () => assert.equal(await page.locator("dialog[open]").count(), 1));
  await eventually(async () => assert.match(await alt(), /^Second pulse\. force \[N\] over time \[s\]\. Series: measured \(3 points, −1.25 to 2 over 0 to 1\); predicted .* Lines: threshold at 2\. One note/));
  await pressed(page, "ArrowRight");
  await eventually(async () => assert.match(await alt(), /^Third pulse/));
  await pressed(page, "ArrowRight");
  await eventually(async () => assert.match(await alt(), /^First pulse/));
  await dialog.locator("summary").click();
  await eventually(async () => assert.deepEqual(await dialog.locator("tbody tr").nth(4).locator("td").allTextContents(), ["predicted", "0.50000", "−2.2500", "−3.0000", "−2.0000"]));
  assert.deepEqual(await violations(page), []);
  const [download] = await Promise.all([page.waitForEvent("download"), dialog.getByRole("button", { name: /^Save CSV/ }).click()]);
  assert.equal(download.suggestedFilename(), "figure-4.3-1.csv");
  assert.match(readFileSync(await download.path(), "utf8"), /^"series","time \[s\]","force \[N\]","low","high"\n"measured",0,0,,\n/);
  await pressed(page, "Escape");
  await eventually(async () => assert.equal(await page.locator("dialog").count(), 0));
  await eventually(async () => assert.ok(await pictures.nth(1).evaluate((one) => one === document.activeElement), "the focus is back"));
}));

test("drawings are pictures: nothing in them reaches the page, each loads, and each keeps its place", () => reading(every, async (page) => {
  const images = await page.$$eval("article img", (all) => all.map((one) => ({ src: one.src.slice(0, 19), loaded: one.complete && one.naturalWidth > 0, ratio: one.clientWidth / one.clientHeight })));
  assert.equal(images.length, 4);
  for (const { src, loaded, ratio } of images) {
    assert.equal(src, "data:image/svg+xml;");
    assert.ok(loaded && Math.abs(ratio - 760 / 420) < 0.02, `${ratio}`);
  }
  assert.notEqual(await page.title(), "owned");
}));

test("a command is copied as it stands", () => onPage(real.file, async (page) => {
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  const [command] = real.json.exhibits.find(({ id }) => id === "table-3.6").commands;
  await page.locator('[id="table-3.6"] .commands summary').click();
  const button = page.locator('[id="table-3.6"] .command-line button').first();
  await button.focus();
  await pressed(page, "Enter");
  await page.waitForFunction(() => document.activeElement.textContent === "Copied");
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), command);
}));

test("on a narrow screen nothing is wider than it, and the contents open and close", () => onPage(every, async (page) => {
  await openAll(page);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await page.locator('nav a[href="#table-4.1"]').click();
  await page.waitForFunction(() => document.activeElement?.id === "table-4.1");
  assert.equal(await page.locator(".sidebar[open]").count(), 0);
  const [row, box] = await page.$eval('[id="table-4.1"] .table-scroll', (room) => {
    room.scrollLeft = 400;
    return [room.querySelector("tbody th").getBoundingClientRect().left, room.getBoundingClientRect().left];
  });
  assert.ok(Math.abs(row - box) < 1, "the first column stays");
  await page.locator(".sidebar summary").focus();
  await pressed(page, "Enter", "Tab", "Escape");
  await eventually(async () => assert.equal(await page.locator(".sidebar[open]").count(), 0));
  await page.locator('[id="table-4.1"] td').nth(1).tap();
  assert.match(await page.textContent('[id="table-4.1"] .cell-facts'), /^P1, m_xy: ours 2\.469/);
  assert.deepEqual(await violations(page), []);
}, { viewport: { width: 390, height: 844 }, hasTouch: true }));

test("nothing to show, and nothing known, is no error", async () => {
  const none = (value) => (Array.isArray(value) ? value.map(none) : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, none(v)])) : typeof value === "number" ? null : value);
  const empty = changed(real.file, "empty", (page) => Object.assign(page.reproduction, { exhibits: [], agreement: { "not compared": 0, "within rounding": 0, "round trip": 0, erratum: 0, slip: 0, differs: 0 } }));
  const bare = changed(every, "bare", (page) => {
    for (const one of page.reproduction.exhibits) Object.assign(one, { text: [], commands: [], related: [], tables: [], charts: [] });
  });
  const unknown = changed(every, "unknown", (page) => {
    page.drawings = {};
    for (const one of page.reproduction.exhibits) {
      for (const table of one.tables) table.rows = none(table.rows);
      one.charts = one.charts.map((chart, k) => ({ ...none(chart), ...(k === 0 ? { series: [] } : {}) }));
      for (const { series } of one.charts) for (const line of series) line.intervals = line.intervals.map(() => [null, null]);
      one.tables.push({ ...differing, title: "", rows: [] }, { ...differing, columns: [] });
    }
  });
  for (const file of [empty, bare, unknown]) {
    await onPage(file, async (page) => {
      await openAll(page);
      await drawn(page);
      assert.doesNotMatch(await page.textContent("main"), /NaN|null|Infinity|undefined|\[object/);
      assert.deepEqual(await violations(page), []);
    });
  }
  await onPage(changed(real.file, "other", (page) => (page.reproduction.schema = "mbk.reproduction/9")), async (page) => {
    assert.match(await page.textContent("main"), /cannot be shown.*mbk\.reproduction\/9/s);
  });
});

test("what stands in the document stays text", () => {
  const hostile = "</script><img src=x onerror=\"document.title='owned'\">";
  const file = changed(every, "hostile", (page) => {
    const [first] = page.reproduction.exhibits;
    first.title = hostile;
    first.text = [hostile];
    first.tables[0].rows[0].name = hostile;
    first.tables[0].rows[0].cells[0].ours = hostile;
    page.reproduction.source = hostile;
  });
  return onPage(file, async (page) => {
    assert.equal(await page.textContent(".source"), hostile);
    assert.equal(await page.locator("article h3").first().textContent(), hostile);
    assert.notEqual(await page.title(), "owned");
  });
});

test("an index is a subscript where it is one, and stays text", () => {
  const file = changed(every, "indices", (page) => (page.reproduction.exhibits[0].text = ["k_xx, λ_max and 2·b_s of relaxed_sinusoidal, a_b_c"]));
  return onPage(file, async (page) => {
    assert.deepEqual(await page.$$eval("article .text:has(sub) .symbol", (all) => all.slice(0, 3).map((one) => [one.textContent, one.querySelector("sub").textContent])), [["kxx", "xx"], ["λmax", "max"], ["bs", "s"]]);
    assert.match(await page.textContent("main"), /relaxed_sinusoidal, a_b_c/);
    assert.equal(await page.locator('[id="table-4.1"] thead sub').count(), 12);
  });
});

test("pictures to be looked at, and A4 pages on which nothing is too wide", async () => {
  for (const [name, file, fewest, most] of [["reproduction", real.file, 2, 7], ["reproduction-every-kind", every, 5, 12]]) {
    await onPage(file, async (page) => {
      const pages = (await picture(page, name)).toString("latin1").match(/\/Type \/Page\b/g).length;
      assert.ok(pages >= fewest && pages <= most, `${name}: ${pages} pages`);
      await page.emulateMedia({ media: "print" });
      const a4 = Math.floor(((210 - 2 * 14) / 25.4) * 96);
      await page.setViewportSize({ width: a4, height: 1000 });
      const widest = await page.$$eval("article *", (all) => Math.max(...all.map((one) => one.getBoundingClientRect().right)));
      assert.ok(widest <= a4 + 1, `${widest} of ${a4}`);
      assert.equal(await page.locator(".sidebar:visible, main button:not(.picture):visible").count(), 0);
    });
  }
  await onPage(every, async (page) => {
    await drawn(page);
    await screenshot(page, "reproduction-390", { fullPage: true });
  }, { viewport: { width: 390, height: 844 } });
  await onPage(every, async (page) => {
    await page.locator('[id="figure-4.3"] .picture').first().click();
    await screenshot(page, "reproduction-enlarged");
  });
  await onPage(real.file, async (page) => {
    await page.locator('[id="table-3.6"] td').nth(3).focus();
    await page.evaluate(() => (location.hash = "table-3.6"));
    await page.waitForFunction(() => document.activeElement?.id === "table-3.6");
    await page.waitForSelector('nav a[href="#table-3.6"][aria-current]');
    await screenshot(page, "reproduction-guide");
  }, { viewport: { width: 1280, height: 1060 }, deviceScaleFactor: 1.5 });
});

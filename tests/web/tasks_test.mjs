// What people sit down to do in a browser, done by whoever knows nothing but the address that mbk prints, or the file
// that it wrote: only names that can be read on the page are used, no place in it, and the steps (pages opened, buttons,
// links, fields and keys, help texts and commands at the terminal) are counted. tests/end_to_end/tasks_test.py does the
// other tasks.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, endPrograms, eventually, folder, makeLog, mbk, open, printedFrame, runWithConsole, startDouble } from "./browser.mjs";

after(() => {
  endPrograms(); // of tests that failed
  return closeBrowser();
});

/** The number of steps of each task. */
const steps = {
  "run two trials": 3,
  "exclude a trial with a reason": 4,
  "mark a window that shall not count": 6,
  "watch, and take control": 3,
  "stop the robot": 3,
  "repeat a poor trial": 2,
  "speak to the participant in German": 3,
  "export a figure for a paper": 4,
  "copy a table into a spreadsheet": 2,
  "compare two results on a page": 3,
};
const patience = { timeout: 60_000 };

const experiment = join(folder, "tasks.toml");
const trial = (name) => `
[[trial]]
name = "${name}"
[trial.control]
kind = "position"
[trial.perturbation]
kind = "multisine"
duration_s = 8
moving_in_s = 1
`;
writeFileSync(experiment, `[session]\nsoft_start_s = 0.5\nshortest_move_s = 0.5\nsettle_s = 0.2\n[participant]\nkind = "arm"\nnumber = 1\n${trial("first")}${trial("second")}`);

/** Someone who has never been here: a browser, a terminal, and what they have done so far. */
class Newcomer {
  steps = 0;
  help = "";

  /** An address that was printed, or a file; in a window of its own, or in one that is there. */
  async open(address, window) {
    ++this.steps;
    if (window) {
      this.page = window.page;
      await this.page.goto(address);
      return;
    }
    this.visited = await open(address);
    this.page = this.visited.page;
    await this.page.context().grantPermissions(["clipboard-read", "clipboard-write"]).catch(() => {}); // a file has none
  }
  /** What has these words in its name and can be seen. */
  named(role, name) {
    return this.page.getByRole(role, { name }).filter({ visible: true }).first();
  }
  async press(name, role = "button") {
    const found = this.named(role, name);
    await found.waitFor(patience);
    ++this.steps;
    await found.click(patience);
  }
  async key(name) {
    ++this.steps;
    await this.page.keyboard.press(name);
  }
  async write(label, text) {
    const field = this.page.getByLabel(label, { exact: true }).filter({ visible: true });
    await field.waitFor(patience);
    ++this.steps;
    await field.fill(text);
  }
  /** Reads; no step. */
  reads(words) {
    return this.page.getByText(words).filter({ visible: true }).first().waitFor(patience);
  }
  /** A help text. */
  readHelp(...command) {
    ++this.steps;
    this.help = mbk(...command, "--help").out;
  }
  /** A command line, of which each option has been read. */
  types(...words) {
    for (const word of words.filter((one) => one.startsWith("--"))) assert.match(this.help, new RegExp(`${word}\\b`), `nobody has read ${word}`);
    ++this.steps;
    return words;
  }
  async leave() {
    await this.visited?.close();
    this.visited = undefined;
  }
}

/** A task, done in exactly as many steps as the table says. */
function task(name, work) {
  test(name, async () => {
    const newcomer = new Newcomer();
    try {
      await work(newcomer);
    } finally {
      await newcomer.leave();
    }
    console.log(`${String(newcomer.steps).padStart(3)} steps  ${name}`);
    assert.equal(newcomer.steps, steps[name]);
  });
}

const run = (name, ...args) => runWithConsole(experiment, name, "--wait", ...args);

let session, window; // one for several tasks, which begin at its address each, in the window that has control
const metadata = (name) => JSON.parse(mbk("info", "--json", name).out).metadata;

task("run two trials", async (person) => {
  session = await run("day", "--speed", "10");
  await person.open(session.operator);
  await person.press("Start: first");
  await person.press("Start the next: second");
  await person.reads(/2 second/);
  await person.named("button", "Finish").waitFor(patience);
  window = person.visited;
  person.visited = undefined;
});

task("exclude a trial with a reason", async (person) => {
  await person.open(session.operator, window);
  await person.press("1 first");
  await person.write("Reason", "coughed");
  await person.press("Exclude the trial");
  await person.reads("Excluded: coughed");
  await eventually(() => assert.equal(metadata("day_first.h5").excluded, "coughed"));
});

task("mark a window that shall not count", async (person) => {
  await person.open(session.operator, window);
  await person.press("2 second");
  await person.write("from s", "4");
  await person.write("to s", "5.5");
  await person.write("Reason", "spoke");
  await person.press("Exclude the window");
  await person.reads("4 to 5.5 s excluded: spoke");
  await eventually(() => assert.equal(metadata("day_second.h5").excluded_windows, "4-5.5 s: spoke"));
});

task("watch, and take control", async (person) => {
  const other = new Newcomer(); // whoever controls
  await other.open(session.operator, window);
  await other.reads("This page has control.");
  await person.open(session.operator);
  await person.reads(/This page is for viewing only: another page has control/);
  await person.press("Take control");
  await other.reads(/another page has control/);
  await person.reads("This page has control.");
  await person.press("Finish");
  await person.reads(/session is over/i);
  await window.close();
  await person.leave();
  assert.equal(await session.code, 0);

  // what was marked on the page is what is left out: on the clock of the perturbation, which begins later
  const said = mbk("measure", "day_second.h5").out.replaceAll(/\s+/g, " ");
  const begin = Number(/only the perturbation is analysed: ([\d.]+) s/.exec(said)[1]);
  const [from, to] = /omitted: ([\d.]+) s to ([\d.]+) s, excluded: spoke/.exec(said).slice(1).map(Number);
  assert.ok(Math.abs(from - (4 - begin)) < 1e-3 && Math.abs(to - (5.5 - begin)) < 1e-3, said);
});

task("stop the robot", async (person) => {
  const stopped = await run("stopped", "--speed", "1", "--trial", "first");
  await person.open(stopped.operator);
  await person.press("Start: first");
  await person.reads(/space bar/);
  await person.reads(/Running/);
  await person.key("Space");
  await person.reads(/the operator stopped it/);
  await person.named("button", "End the session").click();
  await person.leave();
  assert.equal(await stopped.code, 5);
});

task("repeat a poor trial", async (person) => {
  const double = startDouble();
  const [, address] = await double.until(/console: +(http\S+)/);
  double.tell("judge poor 40 91 the model explains 40 % of the force in x");
  double.tell("ask after");
  await person.open(address);
  await person.reads("The model explains 40 % of the force in x.");
  await person.press("Repeat this trial");
  await double.until(/decided repeat/);
  double.tell("quit");
  await person.leave();
  assert.equal(await double.code, 0);
});

task("speak to the participant in German", async (person) => {
  person.readHelp("run");
  const german = await run("german", ...person.types("--texts", "de"), "--trial", "first");
  await person.open(german.participant);
  await person.reads("Bitte warten.");
  german.child.kill("SIGINT");
  await german.code;
});

let report, compared;
before(() => {
  const results = ["one", "two"].map((name, k) => {
    makeLog(`${name}.mat`, "--protocol", "sinusoidal", "--seed", String(k + 1));
    const { code, err } = mbk("measure", `${name}.mat`, "--json", "--out", `${name}.json`, ...(k === 0 ? ["--report", "one.html"] : []));
    assert.equal(code, 0, err);
    return `${name}.json`;
  });
  report = join(folder, "one.html");
  compared = results;
});

/** What is saved by a button. */
async function saved(person, name) {
  const [download] = await Promise.all([person.page.waitForEvent("download"), person.press(name)]);
  return { file: download.suggestedFilename(), text: readFileSync(await download.path(), "utf8") };
}

task("export a figure for a paper", async (person) => {
  await person.open(report);
  const drawing = await saved(person, "Save SVG: Ellipses");
  assert.match(drawing.file, /\.svg$/);
  assert.match(drawing.text, /^<svg[^]*Inertia M/);
  const numbers = await saved(person, "Save CSV: Ellipses");
  assert.match(numbers.text, /"K","N\/m",/);
  await person.press("Print, save PDF: Ellipses");
  assert.notEqual(await printedFrame(person.page), person.page.mainFrame());
});

task("copy a table into a spreadsheet", async (person) => {
  await person.open(report);
  await person.press("Copy table: Inertia, damping, stiffness and equilibrium");
  await person.reads("Copied");
  assert.match(await person.page.evaluate(() => navigator.clipboard.readText()), /^\txx\txy\tyx\tyy\tunit\n/);
});

task("compare two results on a page", async (person) => {
  person.readHelp("compare");
  const { code, err } = mbk("compare", ...compared, ...person.types("--report", "compared.html"));
  assert.equal(code, 0, err);
  await person.open(join(folder, "compared.html"));
  for (const words of ["one.json", "two.json", /stiffness/i]) await person.reads(words);
});

test("what cannot be seen cannot be used", async () => {
  const person = new Newcomer();
  await person.open(report);
  assert.equal(await person.named("button", "No such button").count(), 0);
  assert.throws(() => person.types("--report"), /nobody has read/);
  await person.leave();
  assert.ok(!existsSync(join(folder, "day_third.h5")));
});

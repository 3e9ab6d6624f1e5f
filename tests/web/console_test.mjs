// The console of mbk run in a browser: a run from its first click to its reports, stops, lost connections, strangers.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { closeBrowser, drawn, endPrograms, eventually, folder, makeLog, mbk, measure, onPage, open, runWithConsole, screenshot, startDouble, violations, violationsInBoth } from "./browser.mjs";

after(() => {
  endPrograms(); // of tests that failed
  return closeBrowser();
});

const experiment = join(folder, "short.toml");
writeFileSync(experiment, `
[person]
number = 7
[session]
soft_start_s = 0.5
shortest_move_s = 0.5
settle_s = 0.2
[participant]
kind = "arm"
number = 1
[[trial]]
name = "relaxed"
[trial.recording]
condition = "relaxed, sinusoidal position perturbation"
[trial.control]
kind = "position"
[trial.perturbation]
kind = "multisine"
duration_s = 14
moving_in_s = 2
[[trial]]
name = "rigid"
[trial.recording]
condition = "rigid grasp, sinusoidal force perturbation"
[trial.control]
kind = "force"
[trial.perturbation]
kind = "multisine"
peak_N = 4
duration_s = 14
moving_in_s = 2
[trial.participant.correction]
position_gain = 1.4
[trial.participant.cocontraction]
slope = 0.6
`);

const run = (name, ...args) => runWithConsole(experiment, name, ...args);

/** The page at an address, at a size of its own; nothing of it may ask anyone but the console. */
async function visit(address, options = {}) {
  const visited = await open(address, { viewport: { width: 1920, height: 1080 }, ...options });
  const { page } = visited;
  const banner = (...words) => page.waitForFunction((texts) => texts.some((text) => document.querySelector(".banner-title")?.textContent?.includes(text)), words, { timeout: 60_000 });
  const perturbing = async () => {
    await banner("Running");
    await page.waitForFunction(() => /perturbing/i.test(document.querySelector(".phase")?.textContent ?? ""), undefined, { timeout: 60_000 });
  };
  const rests = () => banner("motors are off", "No torque is commanded"); // what the robot reports, or else what is known
  const foreign = () => visited.outside().filter((url) => !url.startsWith(new URL(address).origin));
  return Object.assign(visited, { banner, perturbing, rests, foreign, click: (name) => page.getByRole("button", { name }).click({ timeout: 60_000 }) });
}

const mostTicks = 250; // from the trip to its message, on a machine that has a hundred other things to do; 5 where it has not
const ended = async ({ close }, running) => {
  await close();
  return running.code;
};

test("a whole run is clicked through, from the first trial to the reports", async () => {
  const running = await run("whole", "--wait", "--speed", "4");
  const operator = await visit(running.operator);
  const { page, click, banner, perturbing, rests } = operator;
  await rests();
  await page.getByText("This page has control.").waitFor();
  assert.deepEqual(await violationsInBoth(page), []);
  await screenshot(page, "console-ready");

  await page.getByRole("button", { name: "Start: relaxed" }).focus();
  await page.keyboard.press("Enter");
  await banner("Running");
  const words = (text) => page.waitForFunction((expected) => document.querySelector(".robot")?.textContent === expected, text, { timeout: 60_000 });
  await words("The motors are commanded on."); // and nothing of how they were before
  await page.getByLabel("Note for the recording").fill("talked to the nurse");
  await click("Add the note");
  await page.waitForSelector(".cells", { timeout: 60_000 });
  await page.waitForFunction(() => document.querySelector(".tightening")?.textContent.includes("narrowed by"), undefined, { timeout: 60_000 });
  assert.deepEqual(await violationsInBoth(page), []);
  await screenshot(page, "console-running");

  await page.getByRole("button", { name: "Start the next: rigid" }).waitFor({ timeout: 60_000 });
  assert.match(await page.textContent(".robot"), /reports its motors off, confirmed after the stop/);
  await page.locator(".estimate h2", { hasText: /whole perturbation, 14 s/ }).waitFor({ timeout: 60_000 });
  assert.match(await page.textContent(".verdict"), /Completed and good.*The model explains [\d.]+ % in x, [\d.]+ % in y/);
  assert.match(await page.getByRole("button", { name: "Start the next: rigid" }).getAttribute("class"), /main/);
  await page.getByRole("button", { name: "1 relaxed" }).click();
  await page.locator(".course canvas").scrollIntoViewIfNeeded();
  const course = await page.locator(".course canvas").boundingBox();
  await page.mouse.move(course.x + 0.25 * course.width, course.y + 9);
  await page.mouse.down();
  await page.mouse.move(course.x + 0.5 * course.width, course.y + 9);
  await page.mouse.up();
  const [from, to] = await Promise.all(["from", "to"].map((name) => page.inputValue(`.exclusion [name=${name}]`)));
  assert.ok(from > 2 && Math.abs(to / from - 2) < 0.05, `dragged from a quarter to a half: ${from} to ${to} s`);
  await page.locator(".exclusion [name=from]").fill("3.5");
  await page.locator(".exclusion [name=to]").fill("5");
  await page.getByLabel("Reason").fill("a b"); // the space bar writes
  await click("Exclude the window");
  await page.getByText("3.5 to 5 s excluded: a b").waitFor();
  await page.getByLabel("Reason").fill("coughed");
  assert.deepEqual(await violationsInBoth(page), []);
  await screenshot(page, "console-excluding");
  await click("Exclude the trial");
  await page.getByText("Excluded: coughed", { exact: true }).waitFor();
  await click("Start the next: rigid");
  await perturbing();
  await screenshot(page, "console-force");
  await click("End this trial early");
  await click("Repeat this trial");
  await banner("Running");
  await page.getByRole("button", { name: "Finish" }).waitFor({ timeout: 60_000 });
  await page.getByLabel("Note for the recording").fill("better");
  await click("Add the note");
  await click("Finish");
  await banner("session is over");
  const [report] = await Promise.all([page.context().waitForEvent("page"), page.getByRole("link", { name: "Open the report of relaxed" }).click()]);
  await report.waitForSelector("main section");
  assert.match(await report.textContent("main"), /stiffness/i);
  await page.getByText("Timing of the loop").click();
  await page.locator(".histogram").first().waitFor();
  assert.equal(await page.locator(".attempt").count(), 3); // relaxed, rigid, rigid again
  await screenshot(page, "console-over", { fullPage: true });
  await page.emulateMedia({ colorScheme: "dark" });
  await screenshot(page, "console-over-dark", { fullPage: true });
  assert.deepEqual(await violationsInBoth(page), []);
  assert.deepEqual(operator.said, []);
  assert.deepEqual(operator.foreign(), []);
  assert.equal(await ended(operator, running), 0);

  const of = (name) => JSON.parse(mbk("info", "--json", name).out).metadata;
  assert.equal(of("whole_relaxed.h5").notes, "talked to the nurse");
  assert.equal(of("whole_relaxed.h5").excluded, "coughed");
  assert.equal(of("whole_relaxed.h5").excluded_windows, "3.5-5 s: a b");
  assert.equal(of("whole_rigid.h5").ended, "ended early by the operator");
  assert.equal(of("whole_rigid_2.h5").notes, "better");
});

/** Keeps the time of the newest sample that came, by the trial's clock [s]; and of the first message that says a trip, how far
 * the loop's clock and the samples here had come, and what the page says in the first animation frame after it. */
function watchArrivals() {
  globalThis.WebSocket = class extends WebSocket {
    constructor(...args) {
      super(...args);
      this.addEventListener("message", ({ data }) => {
        if (data instanceof ArrayBuffer) {
          const view = new DataView(data);
          const last = 32 + 4 * view.getUint16(6, true) * (view.getUint32(8, true) - 1);
          globalThis.newestSample = view.getFloat64(16, true) + view.getFloat32(last, true);
          return;
        }
        const message = JSON.parse(data);
        if (message.type !== "state" || !message.safety.tripped || !globalThis.stopSeen?.pressed || globalThis.stopSeen.said) return;
        const seen = Object.assign(globalThis.stopSeen, { said: message.safety.sentence, loop: message.time_s, samples: globalThis.newestSample, after: performance.now() - globalThis.stopSeen.pressedAt });
        requestAnimationFrame(() => {
          seen.shown = document.querySelector(".banner").textContent;
        });
      });
    }
  };
}

/** Presses, and waits until the page says the reason; what came in which order is asserted, how long it took is told. */
async function pressAndMeasure(page, press) {
  await page.evaluate(() => {
    const seen = (globalThis.stopSeen = { frames: 0, done: false, pressed: 0 });
    const begin = () => {
      seen.pressed ||= globalThis.newestSample;
      seen.pressedAt ||= performance.now();
    };
    document.querySelector(".stop").addEventListener("pointerdown", begin, { capture: true });
    addEventListener("keydown", begin, { capture: true });
    const count = () => {
      if (seen.pressed) ++seen.frames;
      const reason = /operator stopped it, at ([\d.]+) s/.exec(document.querySelector(".banner-words").textContent);
      if (reason) Object.assign(seen, { done: true, tripped: Number(reason[1]) });
      else requestAnimationFrame(count);
    };
    requestAnimationFrame(count);
  });
  await press();
  await page.waitForFunction(() => globalThis.stopSeen.done && globalThis.stopSeen.shown, undefined, { timeout: 20_000 });
  const { frames, tripped, pressed, said, loop, samples, shown, after } = await page.evaluate(() => globalThis.stopSeen);
  const milliseconds = (seconds) => Math.round(1000 * seconds);
  assert.ok(shown.includes("Stopped") && shown.includes(said), `in the first frame after the trip's message the page says: ${shown}`);
  assert.ok(samples <= tripped + 1e-9, `samples up to ${samples} s came before the message of the trip at ${tripped} s`);
  assert.ok(milliseconds(loop - tripped) <= mostTicks, `the trip at ${tripped} s was said when the loop was at ${loop} s`);
  return `tripped ${milliseconds(tripped - pressed)} ms behind the newest sample that was there, said ${milliseconds(loop - tripped)} ticks later, here ${after.toFixed(0)} ms after the press, displayed in frame ${frames}`;
}

test("the stop button and the space bar trip the gate; a reset takes two steps", async () => {
  const running = await run("stopped", "--wait", "--speed", "1", "--trial", "relaxed");
  const operator = await visit(running.operator, { script: watchArrivals });
  const { page, click, perturbing } = operator;
  await click("Start: relaxed");
  await perturbing();
  const byButton = await pressAndMeasure(page, () => page.locator(".stop").click());
  await page.getByRole("button", { name: "Reset …" }).waitFor();
  assert.match(await page.textContent(".banner"), /Stopped.*the operator stopped it/);
  await page.locator(".verdict.stopped").waitFor();
  assert.match(await page.textContent(".stop"), /STOPPEDin effect until reset/); // none is pending
  assert.deepEqual(await violationsInBoth(page), []);
  await screenshot(page, "console-stopped");
  await click("Reset …");
  await click("Confirm: cause cleared, participant OK; reset");
  await page.locator("button.main", { hasText: "Repeat this trial" }).waitFor();
  assert.match(await page.textContent(".stop"), /STOPspace bar/);
  await click("Repeat this trial");
  await perturbing();
  await page.getByRole("button", { name: "End this trial early" }).focus();  // the space bar does not press it
  const bySpace = await pressAndMeasure(page, () => page.keyboard.press("Space"));
  console.log(`after the press: by the button ${byButton}; by the space bar ${bySpace}`);
  await click("End the session");
  assert.equal(await ended(operator, running), 5);
  for (const name of ["stopped.h5", "stopped_2.h5"]) {
    const { ended: how, ended_detail: why } = JSON.parse(mbk("info", "--json", name).out).metadata;
    assert.equal(how, "safety stop");
    assert.match(why, /operator/);
  }
});

test("the space bar writes while a note is written, and stops again after Esc", async () => {
  const running = await run("spaces", "--wait", "--speed", "1", "--trial", "relaxed");
  const operator = await visit(running.operator);
  const { page, click, banner } = operator;
  await click("Start: relaxed");
  await banner("Running");
  await page.getByLabel("Note for the recording").focus();
  await page.keyboard.type("a b");
  assert.equal(await page.inputValue("#note"), "a b");
  assert.match(await page.textContent(".banner-title"), /Running/);
  await page.keyboard.press("Escape");
  await page.keyboard.press("Space");
  await banner("Stopp");
  await click("End the session");
  assert.equal(await ended(operator, running), 5);
});

test("a lost connection is shown, and the page does not reconnect to a session that has ended", async () => {
  const running = await run("lost", "--wait", "--trial", "relaxed");
  const operator = await visit(running.operator);
  const { page, banner, rests } = operator;
  await rests();
  running.child.kill("SIGKILL");
  await banner("Connection lost");
  assert.match(await page.textContent(".banner-words"), /cannot stop the robot/);
  assert.ok(await page.locator(".stop").isDisabled());
  assert.deepEqual(await violations(page), []);
  await screenshot(page, "console-lost");
  await operator.close();
});

test("a connection that was cut comes back by itself", async () => {
  const running = await run("back", "--wait", "--trial", "relaxed");
  const operator = await visit(running.operator);
  const { page, banner, rests } = operator;
  await rests();
  running.child.kill("SIGSTOP");
  await banner("Connection lost");
  running.child.kill("SIGCONT");
  await rests();
  await page.getByRole("button", { name: "End the session without a trial" }).click();
  assert.equal(await ended(operator, running), 0);
  assert.ok(!existsSync(join(folder, "back.h5")));
});

test("a wrong token and a foreign page get nothing, and that is logged", async () => {
  const running = await run("strangers", "--wait", "--trial", "relaxed");
  const { origin, host } = new URL(running.operator);
  const stranger = await open(`${origin}/?token=0123`);
  assert.match(await stranger.page.textContent("main"), /not right/);
  await running.until(/refused: a wrong token/);
  await stranger.close();
  const foreign = join(folder, "foreign.html"); // a page that its own policy holds back from nothing
  writeFileSync(foreign, "<!doctype html><title>foreign</title><main>foreign</main>");
  const own = await open(foreign);
  const opened = await own.page.evaluate((url) => new Promise((resolve) => {
    const socket = new WebSocket(url);
    socket.onopen = () => resolve(true);
    socket.onerror = () => resolve(false);
  }), `ws://${host}/stream?${new URL(running.operator).search.slice(1)}`);
  assert.equal(opened, false);
  await running.until(/refused: the origin/);
  await own.close();
  running.child.kill("SIGKILL");
});

test("who only watches sees everything, and can do nothing but stop", async () => {
  const running = await run("watched", "--wait", "--speed", "1", "--trial", "relaxed");
  const operator = await visit(running.operator);
  const watching = await visit(running.viewing);
  await operator.click("Start: relaxed");
  await watching.banner("Running");
  assert.equal(await watching.page.locator(".actions button").count(), 0);
  assert.match(await watching.page.textContent(".control"), /This page is for viewing only: another page has control\. STOP and the space bar also work here/);
  assert.ok(!(await watching.page.getByRole("button", { name: "Take control" }).isVisible()));
  assert.match(await watching.page.textContent(".stop"), /STOPspace bar, also on this page/);
  assert.match(await operator.page.textContent(".control"), /This page has control\. 1 other page is open/);
  const rates = await Promise.all([operator, watching].map(async ({ page }) => (await page.waitForFunction(() => document.documentElement.dataset.framesPerSecond, undefined, { timeout: 60_000 })).jsonValue()));
  console.log(`frames drawn per second by two pages: ${rates.join(", ")}`);
  assert.deepEqual(await violationsInBoth(watching.page), []);
  await screenshot(watching.page, "console-watching");
  await watching.page.keyboard.press("Space");
  await operator.banner("Stopped");
  await watching.banner("Stopped");
  await watching.close();
  await operator.click("End the session");
  assert.equal(await ended(operator, running), 5);
});

test("another page of the operator takes control, and the one that controls keeps it when it is loaded again", async () => {
  const running = await run("control", "--wait", "--trial", "relaxed");
  const first = await visit(running.operator);
  const second = await visit(running.operator);
  const begin = (of) => of.page.getByRole("button", { name: "Start: relaxed" });
  const says = (of, words) => of.page.locator(".control", { hasText: words }).waitFor({ timeout: 60_000 });
  await says(first, "This page has control.");
  await begin(first).waitFor();
  await says(second, "another page has control.");
  assert.equal(await begin(second).count(), 0);
  await first.page.reload();
  await says(first, "This page has control.");
  await says(second, "another page has control.");
  await screenshot(second.page, "console-second");
  await second.click("Take control");
  await says(second, "This page has control.");
  await begin(second).waitFor();
  await says(first, "another page has control.");
  await first.page.getByRole("button", { name: "Take control" }).waitFor();
  assert.equal(await begin(first).count(), 0);
  await second.click("End the session without a trial");
  await first.close();
  assert.equal(await ended(second, running), 0);
});

test("a trial that was completed but is poor says why, and suggests to repeat it", async () => {
  const { operator, has, tell, until, code } = await robotReports();
  const { page, click } = operator;
  tell("judge poor 40 91 the model explains 40 % of the force in x");
  tell("ask after");
  await has(".verdict", "Completed, but poor");
  await has(".verdict", "The model explains 40 % of the force in x.");
  await page.locator(".actions button.main", { hasText: "Repeat this trial" }).waitFor();
  assert.doesNotMatch(await page.getByRole("button", { name: "Finish" }).getAttribute("class"), /main/);
  await has(".attempt", "40 % explained");
  assert.deepEqual(await violationsInBoth(page), []);
  await screenshot(page, "console-poor");
  await click("Repeat this trial");
  await until(/decided repeat/);
  tell("quit");
  assert.equal(await ended(operator, { code }), 0);
});

/** How the lines of the page's plots go: of each stroke its colour, its width and where it is on the whole. */
function watchStrokes() {
  const { beginPath, lineTo, stroke } = CanvasRenderingContext2D.prototype;
  globalThis.strokes = [];
  Object.assign(CanvasRenderingContext2D.prototype, {
    beginPath() {
      this.heights = [];
      beginPath.call(this);
    },
    lineTo(x, y) {
      this.heights?.push(y);
      lineTo.call(this, x, y);
    },
    stroke() {
      const { heights = [] } = this;
      if (this.canvas === document.querySelector(".trace canvas")) globalThis.strokes.push({ colour: this.strokeStyle, width: this.lineWidth, height: heights.length > 0 ? heights.reduce((sum, y) => sum + y, 0) / heights.length : NaN });
      stroke.call(this);
    },
  });
}

/** Counts what is drawn on the participant's page. */
function watchPictures() {
  const { fill } = CanvasRenderingContext2D.prototype;
  globalThis.pictures = 0;
  CanvasRenderingContext2D.prototype.fill = function (...args) {
    ++globalThis.pictures;
    return fill.apply(this, args);
  };
}

/** Pearson's correlation. */
function correlation(pairs) {
  const mean = (k) => pairs.reduce((sum, pair) => sum + pair[k], 0) / pairs.length;
  const [x, y] = [mean(0), mean(1)];
  const moment = (i, j) => pairs.reduce((sum, pair) => sum + (pair[i] - [x, y][i]) * (pair[j] - [x, y][j]), 0);
  return moment(0, 1) / Math.sqrt(moment(0, 0) * moment(1, 1));
}

test("in a force trial the command is drawn with the sign of the hand's force, in other lines", async () => {
  const running = await run("signs", "--wait", "--speed", "2", "--trial", "rigid");
  const operator = await visit(running.operator, { script: watchStrokes });
  await operator.click("Start: rigid");
  await operator.perturbing();
  const pairs = await eventually(async () => {
    // in each picture command x, command y, x, y; dashes leave every other piece of a command out
    const found = await operator.page.evaluate(() => {
      const all = globalThis.strokes.slice(-4 * 600);
      return all.flatMap((one, k) => (one.width > 4 && one.height === one.height && all[k + 2]?.width < 4 && all[k + 2].colour === one.colour && all[k + 2].height === all[k + 2].height ? [[one.height, all[k + 2].height]] : []));
    });
    assert.ok(found.length > 150, String(found.length));
    return found;
  });
  const same = correlation(pairs.slice(-150));
  assert.ok(same > 0.5, `correlation ${same} of force and command as they are drawn`);
  assert.match(await operator.page.textContent(".trace"), /Force of the hand on the robot \[N\].*−command x.*Time \[s\]/);
  await screenshot(operator.page, "console-signs");
  await operator.click("End this trial early");
  await operator.click("Finish");
  assert.equal(await ended(operator, running), 0);
});

test("the participant reads what to do in the words of the study, and sees handle and target as the operator likes", async () => {
  const texts = join(folder, "study.toml");
  writeFileSync(texts, `${readFileSync(join(import.meta.dirname, "..", "..", "examples", "texts", "de.toml"), "utf8")}\n[trial.rigid]\nhold = "Gegenhalten!"\n`);
  const running = await run("participant", "--wait", "--speed", "1", "--trial", "rigid", "--texts", texts);
  const operator = await visit(running.operator);
  const participant = await visit(running.participant);
  const mirrored = await visit(`${running.participant}#mirrored&turned=90&magnified=1.5`);
  const { page } = participant;
  const says = (words) => page.locator(".instruction", { hasText: words }).waitFor({ timeout: 60_000 });
  await says("Bitte warten.");
  assert.equal(await page.getAttribute("html", "lang"), "de");
  await operator.click("Start: rigid");
  await says("Der Roboter bewegt Ihre Hand.");
  const place = (of) => of.page.waitForFunction(() => document.querySelector("canvas").dataset.handle).then((handle) => handle.jsonValue());
  const before = await place(participant);
  await says("Gegenhalten!");
  await page.waitForFunction((first) => document.querySelector("canvas").dataset.handle !== first, before, { timeout: 60_000 });
  assert.deepEqual(await violations(page), []);
  await screenshot(page, "participant");
  await screenshot(mirrored.page, "participant-mirrored");
  await page.getByText("View").click();
  await page.getByLabel("mirrored, left and right").check();
  await page.getByLabel("turned by").selectOption("180");
  assert.match(page.url(), /#mirrored&turned=180/);
  assert.deepEqual(await violations(page), []);
  assert.deepEqual([...participant.said, ...mirrored.said], []);
  assert.deepEqual(participant.foreign(), []);
  await operator.page.locator(".stop").click();
  await says("Der Roboter hat angehalten.");
  await operator.click("End the session");
  await participant.close();
  await mirrored.close();
  assert.equal(await ended(operator, running), 5);
});

test("in a relaxed trial the participant's picture is steady, and the trial ends with a word of thanks", async () => {
  const running = await run("steady", "--wait", "--speed", "8", "--trial", "relaxed");
  const operator = await visit(running.operator);
  const participant = await visit(running.participant, { script: watchPictures });
  const { page } = participant;
  await operator.click("Start: relaxed");
  const pictures = await page.waitForFunction(() => {
    const instruction = document.querySelector('.instruction[data-text="relax"]');
    if (!instruction || !document.querySelector('canvas[data-steady="true"]:not([data-handle])')) return 0;
    // At the end the ring changes with the next frame, before anybody could ask.
    new MutationObserver(() => {
      if (instruction.dataset.text !== "relax") globalThis.picturesUntilTheEnd ??= globalThis.pictures;
    }).observe(instruction, { attributes: true });
    return globalThis.pictures;
  }, undefined, { timeout: 60_000 }).then((value) => value.jsonValue());
  await screenshot(page, "participant-steady");
  await page.waitForFunction(() => document.querySelector('.instruction:not([data-text="relax"])'), undefined, { timeout: 60_000 });
  assert.equal(await page.evaluate(() => globalThis.picturesUntilTheEnd), pictures, "nothing was drawn anew while nothing changed");
  await page.locator(".instruction", { hasText: "Thank you. That went well." }).waitFor({ timeout: 60_000 });
  await operator.click("Finish");
  await participant.close();
  assert.equal(await ended(operator, running), 0);
});

test("texts that are not whole are refused before anything moves, with what is missing", () => {
  writeFileSync(join(folder, "half.toml"), 'language = "fr"\nwait = "Un moment."\n');
  const { code, err } = mbk("run", experiment, "--out", "half.h5", "--console", "--texts", "half.toml");
  assert.equal(code, 3);
  assert.match(err, /half\.toml.*old/);
  assert.ok(!existsSync(join(folder, "half.h5")));
});

test("without --wait it goes on by itself, and stays while a page is open", { timeout: 60_000 }, async () => {
  const running = await run("alone", "--fast", "--trial", "relaxed");
  assert.equal(await running.code, 0);
  assert.ok(existsSync(join(folder, "alone.h5")));
});

/** The console with a robot that reports what the test says: its page, and a word for it. */
async function robotReports() {
  const double = startDouble();
  const [, address] = await double.until(/console: +(http\S+)/);
  const operator = await visit(address);
  const off = { motors: "off", confirmed_off: null, stop_button: false, link: true, fault: 0, sentence: "" };
  const say = (robot) => double.tell(`robot ${JSON.stringify({ ...off, ...robot })}`);
  return Object.assign(double, { operator, say, has: (selector, words) => operator.page.waitForFunction(([where, text]) => document.querySelector(where)?.textContent?.includes(text), [selector, words], { timeout: 60_000 }) });
}

test("motors that are not confirmed off are an alarm that cannot be missed, until they are", async () => {
  const { operator, say, has, tell, code } = await robotReports();
  const { page, rests, banner } = operator;
  const alarm = page.locator(".alarm");
  await has(".robot", "has not reported whether its motors are on");
  assert.equal(await alarm.textContent(), "");
  say({ motors: "on" });
  await banner("The motors are on");
  say({ motors: "off" });
  await has(".robot", "reports its motors off");
  await rests();
  say({ motors: "on", confirmed_off: false, fault: 17, sentence: "200 ms after the stop the robot still reports 3.1 N·m" });
  await has(".alarm", "MOTORS NOT CONFIRMED OFF — cut the motors' power with the hardware stop button");
  await has(".alarm", "200 ms after the stop the robot still reports 3.1 N·m");
  await has(".robot", "its fault code is 17");
  assert.match(await page.getByRole("alert").textContent(), /MOTORS NOT CONFIRMED OFF/); // not hidden from reading aids
  assert.match(await page.title(), /^MOTORS NOT CONFIRMED OFF/);
  const [box, width] = [await alarm.boundingBox(), await page.evaluate(() => document.documentElement.clientWidth)];
  assert.ok(box.width > 0.95 * width && box.height > 100 && box.y >= 0 && box.y < 40, JSON.stringify([box, width]));
  assert.deepEqual(await violations(page), []);
  await screenshot(page, "console-alarm");
  await page.setViewportSize({ width: 700, height: 900 });
  await page.mouse.wheel(0, 3000);
  await page.waitForFunction(() => scrollY > 0);
  assert.ok(await alarm.isVisible() && (await alarm.boundingBox()).y >= 0, "it does not scroll away");
  await screenshot(page, "console-alarm-narrow");
  await page.setViewportSize({ width: 1920, height: 1080 });
  say({ confirmed_off: true });
  await has(".robot", "reports its motors off, confirmed after the stop");
  assert.equal(await alarm.textContent(), "");
  assert.deepEqual(operator.said, []);
  tell("quit");
  assert.equal(await ended(operator, { code }), 0);
});

test("the alarm stays when the connection is lost", async () => {
  const { operator, say, has, child } = await robotReports();
  say({ motors: "on", confirmed_off: false });
  await has(".alarm", "MOTORS NOT CONFIRMED OFF");
  child.kill("SIGKILL");
  await operator.banner("Connection lost");
  await has(".alarm", "MOTORS NOT CONFIRMED OFF");
  await operator.close();
});

test("a stop button that is pressed is shown while nothing runs, and the reset says that it waits for it", async () => {
  const { operator, say, has, tell, until, code } = await robotReports();
  const { page, banner, rests, click } = operator;
  say({ stop_button: true });
  await banner("Stop button pressed");
  await has(".robot", "its stop button is pressed");
  tell("ask reset");
  await has(".waits", "Reset is not possible while the robot's stop button is pressed");
  const reset = page.getByRole("button", { name: "Reset …" });
  assert.ok(await reset.isDisabled());
  assert.deepEqual(await violations(page), []);
  await screenshot(page, "console-button-pressed");
  say({ stop_button: true, link: false });
  await has(".robot", "The robot sends no states");
  say({ stop_button: false });
  await rests();
  await click("Reset …");
  await click("Confirm: cause cleared, participant OK; reset");
  await until(/decided reset/);
  tell("quit");
  assert.equal(await ended(operator, { code }), 0);
});

test("a script or a style that came into the page later is not run", async () => {
  const { operator, tell, code } = await robotReports();
  const { page, said } = operator;
  const after = await page.evaluate(async () => {
    const script = document.createElement("script");
    script.textContent = "globalThis.injected = true";
    const style = document.createElement("style");
    style.textContent = ".stop { display: none; }";
    const room = document.createElement("div");
    room.innerHTML = '<p style="position: fixed">x</p><img src="data:," onerror="globalThis.injected = true">';
    const failed = new Promise((resolve) => room.querySelector("img").addEventListener("error", resolve)); // after its own handler
    document.body.append(script, style, room);
    await failed;
    return [globalThis.injected, getComputedStyle(document.querySelector(".stop")).display, getComputedStyle(room.firstChild).position];
  });
  assert.notEqual(after[0], true);
  assert.notEqual(after[1], "none");
  assert.notEqual(after[2], "fixed");
  await eventually(async () => assert.ok(said.every((line) => /Content Security Policy/.test(line)) && said.length >= 4, said.join("\n")));
  tell("quit");
  assert.equal(await ended(operator, { code }), 0);
});

test("a report that the console serves is drawn under the policy of its own scripts and styles", async () => {
  const { file } = measure("served", makeLog("served.mat", "--protocol", "sinusoidal"));
  const { operator, tell, has, code } = await robotReports();
  tell(`report ${file}`);
  await has(".trials", "Open the report");
  await onPage(await operator.page.getByRole("link", { name: "Open the report" }).evaluate((link) => link.href), async (page) => {
    await drawn(page);
    await page.locator("[_echarts_instance_] svg, [_echarts_instance_] canvas").first().waitFor(); // drawn by its script
    await screenshot(page, "console-report");
  });
  tell("quit");
  assert.equal(await ended(operator, { code }), 0);
});

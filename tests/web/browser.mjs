// What the tests of reports and console share: the programs, a browser without a network, and reading numbers off a page.
//
// Run in the build folder of the pages, where the packages are: cd build/release/web, then
//   MBK=$PWD/../bin/mbk MAKE_LOG=$PWD/../bin/make_log node ../../../tests/web/report_test.mjs
import assert from "node:assert/strict";
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const skipped = 77;
const exact = 1e-12; // relative
const packages = createRequire(join(process.cwd(), "package.json"));
const skip = (why) => {
  console.log(`skipped: ${why}`);
  process.exit(skipped);
};

// The shell draws the same pages without a browser around them, in half of the time.
const found = [process.env.CHROMIUM, "/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const executablePath = found.find((path) => path && existsSync(path)) ?? skip("no Chromium; its Debian package is chromium-headless-shell");
const library = (name) => {
  try {
    return packages(name);
  } catch {
    return skip(`npm's ${name} is not installed in ${process.cwd()}`);
  }
};
const { chromium } = library("playwright-core");
const axeSource = readFileSync((library("axe-core"), packages.resolve("axe-core/axe.min.js")), "utf8");

export const folder = mkdtempSync(join(tmpdir(), "mbk-web-"));
const children = new Set();
export const endPrograms = () => {
  for (const child of children) child.kill("SIGKILL");
};
process.on("exit", () => {
  endPrograms();
  rmSync(folder, { recursive: true, force: true });
});
const pictures = join(process.cwd(), "screenshots");
mkdirSync(pictures, { recursive: true });

/** Where MBK_SCREENSHOTS is set, a picture of the page to be looked at, in build/release/web/screenshots. */
export async function screenshot(page, name, options = {}) {
  if (process.env.MBK_SCREENSHOTS) await page.screenshot({ path: join(pictures, `${name}.png`), ...options });
}

const program = (name) => process.env[name] ?? skip(`the environment does not name ${name}`);

/** mbk with these arguments: exit code and both outputs. */
export function mbk(...args) {
  const { status, stdout, stderr } = spawnSync(program("MBK"), args, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 28 });
  return { code: status, out: stdout, err: stderr };
}

/** A recording of an arm with known impedance. */
export function makeLog(name, ...args) {
  execFileSync(program("MAKE_LOG"), [...args, "--out", join(folder, name)]);
  return name;
}

/** A recording of a simulated participant. */
export function simulate(name, ...args) {
  const { code, err } = mbk("simulate", ...args, "--out", name, "--quiet");
  if (code !== 0) throw new Error(err);
  return name;
}

/** The report of `mbk measure`, and what --json says of the same. */
export function measure(name, ...args) {
  const ran = mbk("measure", ...args, "--json", "--report", `${name}.html`);
  if (ran.code !== 0 && ran.code !== 4) throw new Error(ran.err);
  return { code: ran.code, json: JSON.parse(ran.out), file: join(folder, `${name}.html`) };
}

const holder = /(<script type="application\/json" id="report-data">)([^]*?)(<\/script>)/;
export const documentOf = (file) => JSON.parse(holder.exec(readFileSync(file, "utf8"))[2]);

/** A report with that document, as mbk would write it. */
export function reportOf(document, name) {
  const page = readFileSync(join(process.cwd(), "report", "dist", "index.html"), "utf8");
  const path = join(folder, `${name}.html`);
  writeFileSync(path, page.replace(holder, (_, open, _place, close) => open + JSON.stringify(document).replaceAll("<", "\\u003c") + close));
  return path;
}

/** The report again with its document changed. */
export function changed(file, name, change) {
  const html = readFileSync(file, "utf8");
  const document = documentOf(file);
  change(document);
  const path = join(folder, `${name}.html`);
  const text = JSON.stringify(document).replaceAll("<", "\\u003c");
  writeFileSync(path, html.replace(holder, (_, open, _old, close) => open + text + close));
  return path;
}

const browser = await chromium.launch({
  executablePath,
  args: [
    ...(process.getuid?.() === 0 ? ["--no-sandbox"] : []),
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});
export const closeBrowser = () => browser.close();

/** A program that goes on beside the test: what it has said, a promise of its exit code, ways to wait for a word of it and to tell it a line. */
function started(path, args) {
  const child = spawn(path, args, { cwd: folder, stdio: ["pipe", "pipe", "pipe"] });
  const running = { said: "", child, code: new Promise((resolve) => child.on("close", resolve)) };
  for (const stream of [child.stdout, child.stderr]) stream.setEncoding("utf8").on("data", (text) => { running.said += text; });
  children.add(child);
  running.until = async (pattern) => {
    for (let k = 0; k < 600; ++k) {
      const found = pattern.exec(running.said);
      if (found) return found;
      if (child.exitCode !== null) break;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`${path} did not say ${pattern}: ${running.said}`);
  };
  running.tell = (line) => child.stdin.write(`${line}\n`);
  return running;
}

/** Waits until the page is as `check` asserts: a test waits for a state, never for a time. */
export async function eventually(check) {
  for (const until = Date.now() + 20_000; ;) {
    try {
      return await check();
    } catch (error) {
      if (Date.now() > until) throw error;
    }
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/** mbk. */
export function start(...args) {
  const running = started(program("MBK"), args);
  running.child.stdin.end();
  return running;
}

/** A run with its console, writing to NAME….h5; addresses as it printed them. */
export async function runWithConsole(experiment, name, ...args) {
  const running = start("run", experiment, "--out", `${name}.h5`, "--console", "--quiet", ...args);
  const address = (label) => running.until(new RegExp(`${label}: +(http://127\\.0\\.0\\.1:\\d+/\\S*)`)).then(([, url]) => url);
  return Object.assign(running, { operator: await address("console"), participant: await address("screen"), viewing: await address("watch") });
}

/** The console without a session, which shows of the robot what it is told (console_double.cpp). */
export const startDouble = () => started(program("CONSOLE_DOUBLE"), []);

/** What is printed stays to be looked at: without a printer it is over at once in one browser, and never in another. */
function holdPrinting() {
  window.print = () => { top.prints = (top.prints ?? 0) + 1; };
}

/** The frame that was sent to the printer, once. */
export const printedFrame = (page) => eventually(async () => {
  assert.equal(await page.evaluate(() => window.prints), 1, "what is printed is the figure alone");
  return page.frames().at(-1);
});

/** A page on a report, or at an address; a `script` runs before its own. What it says on the console, which errors it meets and what it asks a network for is kept. */
export async function open(file, { script, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, reducedMotion: "reduce", ...options });
  await context.addInitScript(holdPrinting);
  if (script) await context.addInitScript(script);
  const page = await context.newPage();
  const said = [];
  const requests = [];
  page.on("console", (message) => said.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(file.startsWith("http:") ? file : pathToFileURL(file).href);
  await page.waitForSelector("main, [role=main]");
  const outside = () => requests.filter((url) => !/^(data|blob):/.test(url)).slice(1);
  return { page, said, outside, close: () => context.close() };
}

/** Waits until all charts are drawn, which the page sees to without being scrolled, and all pictures are there. */
export const drawn = (page) => page.waitForFunction(() =>
  [...document.querySelectorAll(".chart")].every((chart) => chart.querySelector("svg")) && [...document.images].every((one) => one.complete), undefined, { polling: 20 });

async function lookAt({ page, said, outside }, look) {
  await look(page);
  assert.deepEqual(said, []);
  assert.deepEqual(outside(), []);
}

/** Looks at a page, which says nothing on the console and asks no network for anything. */
export async function onPage(file, look, options = {}) {
  const opened = await open(file, options);
  try {
    await lookAt(opened, look);
  } finally {
    await opened.close();
  }
}

const kept = new Map();
const stateOf = (page) => page.evaluate(() => `${document.querySelectorAll("*").length} ${document.querySelectorAll("[open]").length} ${document.body.textContent}`);

/** Looks at a page as it was opened, with every chart drawn: tests that only read share the page of a file. */
export async function reading(file, look) {
  if (!kept.has(file)) {
    const opened = await open(file);
    await drawn(opened.page);
    kept.set(file, { ...opened, state: await stateOf(opened.page) });
  }
  const opened = kept.get(file);
  await lookAt(opened, look);
  assert.equal(await stateOf(opened.page), opened.state, "who reads a page changes nothing of it, and who does takes onPage");
}

/** The numbers of a part of the page by name, each with every digit and as it is shown. */
export async function numbers(page, selector) {
  const all = await page.$$eval(`${selector} data[data-name]`, (elements) =>
    elements.map((e) => [e.dataset.name, { value: e.value === "null" ? null : Number(e.value), shown: e.textContent }]));
  return Object.fromEntries(all);
}

/** The same number, to the last digits: a product of two numbers of which --json has every digit. */
export function close(got, want, what) {
  if (want === null) return assert.equal(got, null, what);
  return assert.ok(Math.abs(got - want) <= exact * Math.abs(want), `${what}: ${got} is not ${want}`);
}

/** What is shown is the number, rounded to the digits that are shown. */
export function assertShown({ value, shown }, what) {
  const text = shown.replaceAll("−", "-");
  if (!/^-?\d+(\.\d+)?[ %°]*$/.test(text)) return;
  const half = 0.5 * 10 ** -((/\.(\d+)/.exec(text)?.[1] ?? "").length) * (1 + 1e-9);
  assert.ok(Math.abs(parseFloat(text) - value) <= half, `${what}: ${value} is shown as ${shown}`);
}

export const violations = async (page, options = {}) => {
  await page.evaluate(axeSource);
  const { violations: list } = await page.evaluate((more) => globalThis.axe.run(document, { resultTypes: ["violations"], ...more }), options);
  return list.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).join("; ")}`);
};

/** What axe finds wrong with the colours while the screen's user likes it dark; all else is what it is in the light. The page is light again after that. */
export async function violationsInDark(page) {
  await page.emulateMedia({ colorScheme: "dark" });
  const found = await violations(page, { runOnly: ["color-contrast", "link-in-text-block"] });
  await page.emulateMedia({ colorScheme: "light" });
  return found.map((one) => `dark: ${one}`);
}

export const violationsInBoth = async (page) => [...(await violationsInDark(page)), ...(await violations(page))];

/** What is wider than its place, and text of drawings that reaches out of them. */
export const clipped = (page) => page.evaluate(() => {
  const shown = (element) => element.checkVisibility() && element.getClientRects().length > 0;
  const wide = [...document.querySelectorAll("body *")].filter((one) => !one.closest("svg, pre") && shown(one) && one.clientWidth > 0 && one.scrollWidth > one.clientWidth + 1);
  const out = [...document.querySelectorAll("svg text")].filter((text) => {
    const [inner, outer] = [text.getBoundingClientRect(), text.ownerSVGElement.getBoundingClientRect()];
    return shown(text) && inner.width > 0 && (inner.left < outer.left - 1 || inner.right > outer.right + 1 || inner.top < outer.top - 2 || inner.bottom > outer.bottom + 2);
  });
  return [...wide, ...out].map((one) => `${one.tagName} ${one.className.baseVal ?? one.className}: ${one.textContent.slice(0, 60)}`);
});

/** Screenshot at 1440 px and an A4 PDF, to be looked at. */
export async function picture(page, name) {
  await drawn(page);
  await screenshot(page, name, { fullPage: true });
  return page.pdf({ path: join(pictures, `${name}.pdf`), preferCSSPageSize: true, printBackground: true });
}

// What two pages cost the loop at 1 kHz in real time, and how often they draw. One trial; in each turn, one after the
// other, nobody looks, two pages of the console are open, and two bare pages are. A bare page draws as much of its own as
// nothing: a canvas as large as the traces that it wipes in every frame. How many frames this machine and browser can do
// at the moment is what it shows, and what ours are to be held against; what a browser by itself costs the loop, too.
//
// How late the ticks of a turn came is the difference of the console's counts at its two ends, read by a program that is
// there for a moment and asks for no page. p99.9 with pages less p99.9 without is paired by turns, since the machine is
// another one in each; the order changes from turn to turn. The interval of the median is by order statistics. Times are
// reported and never judged.
//
// Run in the build folder of the page, where the packages are: cd build/bench/web/report, then
//   MBK=$PWD/../../bin/mbk node ../../../../bench/console.mjs [TURNS] [--short]
import { randomBytes } from "node:crypto";
import { writeFileSync } from "node:fs";
import { request } from "node:http";
import { join } from "node:path";
import { closeBrowser, folder, open, start } from "../tests/web/browser.mjs";

const short = process.argv.includes("--short");
const turns = Number(process.argv.slice(2).find((word) => /^\d+$/.test(word)) ?? (short ? 2 : 10));
const [settling, looking] = short ? [1, 3] : [3, 15]; // [s]
const longestTurn = settling + looking + 4; // pages have to open
const seconds = 3 * turns * longestTurn + 20;

const experiment = join(folder, "long.toml");
writeFileSync(experiment, `[participant]\nkind = "arm"\nnumber = 1\n[control]\nkind = "position"\n[perturbation]\nkind = "multisine"\nduration_s = ${seconds}\n`);
const bare = join(folder, "bare.html");
writeFileSync(bare, `<!doctype html><html lang="en"><title>bare</title><main><canvas width="730" height="243"></canvas><canvas width="730" height="243"></canvas></main><script>
  const canvases = [...document.querySelectorAll("canvas")].map((one) => one.getContext("2d", { alpha: false }));
  let drawn = 0;
  const draw = () => {
    for (const paint of canvases) {
      paint.fillStyle = ++drawn % 4 < 2 ? "#fff" : "#eee";
      paint.fillRect(0, 0, 730, 243);
    }
    requestAnimationFrame(draw);
  };
  requestAnimationFrame(draw);
</script>`);

/** Counts the frames that the browser displays, of whichever page. */
function countFrames() {
  globalThis.displayed = 0;
  const count = () => {
    ++globalThis.displayed;
    requestAnimationFrame(count);
  };
  requestAnimationFrame(count);
}

const wait = (time) => new Promise((resolve) => setTimeout(resolve, 1000 * time));
const frames = ({ page }) => page.evaluate(() => [performance.now(), globalThis.displayed, Number(document.documentElement.dataset.framesPerSecond ?? NaN)]);

/** The text messages in what came of a WebSocket (RFC 6455, section 5.2; a server masks nothing), as far as they are whole; each may come in several frames. */
function* messagesIn(bytes) {
  let [kind, parts] = [0, []];
  for (let at = 0; at + 2 <= bytes.length; ) {
    const [last, code, size] = [bytes[at] & 0x80, bytes[at] & 0x0f, bytes[at + 1] & 0x7f];
    const header = size === 127 ? 10 : size === 126 ? 4 : 2;
    if (at + header > bytes.length) return;
    const length = size === 127 ? Number(bytes.readBigUInt64BE(at + 2)) : size === 126 ? bytes.readUInt16BE(at + 2) : size;
    if (at + header + length > bytes.length) return;
    const part = bytes.subarray(at + header, at + header + length);
    at += header + length;
    if (code >= 8) continue; // a ping
    if (code > 0) [kind, parts] = [code, []];
    parts.push(part);
    if (last && kind === 1) yield Buffer.concat(parts).toString("utf8");
  }
}

/** The console's next state, for whoever may watch. */
function state(address) {
  const { origin, hostname, port, search } = new URL(address);
  return new Promise((resolve, reject) => {
    const asked = request({ hostname, port, path: `/stream${search}`, headers: { Origin: origin, Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": 13, "Sec-WebSocket-Key": randomBytes(16).toString("base64") } });
    asked.on("error", reject);
    asked.on("response", ({ statusCode }) => reject(new Error(`the console answers ${statusCode}`)));
    asked.on("upgrade", (_, socket, head) => {
      let bytes = head;
      const look = () => {
        for (const message of messagesIn(bytes)) {
          const said = JSON.parse(message);
          if (said.type !== "state") continue;
          socket.destroy();
          resolve(said);
          return;
        }
      };
      socket.on("error", reject);
      socket.on("close", () => reject(new Error("the console closed the connection")));
      socket.on("data", (more) => {
        bytes = Buffer.concat([bytes, more]);
        look();
      });
      look();
    });
    asked.end();
  });
}

/** How often ticks were how late since the trial began: counts by the upper edge [µs]. */
async function latenessOf(address) {
  const { running, times } = await state(address);
  if (!running) throw new Error("the trial is over: it was too short for these turns");
  return new Map(times.lateness.bins.map(([, upper, count]) => [upper, count]));
}

/** What a share of the ticks between two such counts kept within [µs]; right to the width of a bin, 5 %. */
function quantile(before, after, share) {
  const bins = [...after].map(([upper, count]) => [upper, count - (before.get(upper) ?? 0)]).sort(([a], [b]) => a - b);
  const all = bins.reduce((sum, [, count]) => sum + count, 0);
  let below = 0;
  return bins.find(([, count]) => (below += count) >= share * all)?.[0] ?? NaN;
}

/** One turn with these pages open: how late ticks came; of each page, the frames displayed per second, and what it says of those that it drew anew. */
async function look(addresses, watching) {
  const pages = await Promise.all(addresses.map((address) => open(address, { viewport: { width: 1920, height: 1080 }, script: countFrames })));
  await wait(settling);
  const [late, before] = [await latenessOf(watching), await Promise.all(pages.map(frames))];
  const drawn = [];
  for (let k = 0; k < looking; ++k) {
    await wait(1);
    if (pages.length > 0) drawn.push(...(await Promise.all(pages.map(frames))).map(([, , rate]) => rate));
  }
  const [later, after] = [await latenessOf(watching), await Promise.all(pages.map(frames))];
  for (const page of pages) await page.close();
  const displayed = after.map(([time, count], k) => (1000 * (count - before[k][1])) / (time - before[k][0]));
  return { displayed, drawn, late: quantile(late, later, 0.999) };
}

const sorted = (values) => [...values].sort((a, b) => a - b);
const median = (values) => {
  const [all, half] = [sorted(values), values.length >> 1];
  return values.length % 2 ? all[half] : (all[half - 1] + all[half]) / 2;
};
const range = (values) => `${median(values).toFixed(1)} (${sorted(values)[0].toFixed(1)} to ${sorted(values).at(-1).toFixed(1)})`;

/** Ends of an interval that holds the median of whatever the values are drawn from with a chance of 95 % or more: between the k-th smallest and largest, where fewer than k of n tosses fall on one side with 2.5 % at most. */
function intervalOfMedian(values) {
  const n = values.length;
  let [chance, tail, k] = [0.5 ** n, 0, 0]; // of k heads; of k - 1 at most
  while (tail + chance <= 0.025) {
    tail += chance;
    chance *= (n - k) / (k + 1);
    ++k;
  }
  return k === 0 ? undefined : [sorted(values)[k - 1], sorted(values)[n - k]];
}

/** "+1.2 µs (95 %: -0.4 to 2.0)" */
function paired(some, others) {
  const differences = some.map((value, k) => value - others[k]);
  const interval = intervalOfMedian(differences);
  const ends = interval ? `95 %: ${interval.map((end) => end.toFixed(1)).join(" to ")}` : `${differences.length} turn${differences.length === 1 ? " is" : "s are"} too few for an interval: ${sorted(differences).map((one) => one.toFixed(1)).join(", ")}`;
  return `${median(differences).toFixed(1)} µs (${ends})`;
}

const running = start("run", experiment, "--out", "long.h5", "--console", "--quiet", "--no-measure");
const [, operator] = await running.until(/console: +(http\S+)/);
const [, watching] = await running.until(/watch: +(http\S+)/);
for (let perturbing = false; !perturbing; await wait(0.2)) ({ perturbing } = await state(watching));
const kinds = [["none", []], ["ours", [operator, watching]], ["bare", [bare, bare]]];
const all = Object.fromEntries(kinds.map(([name]) => [name, { displayed: [], drawn: [], late: [] }]));
for (let turn = 0; turn < turns; ++turn) {
  for (const [name, addresses] of turn % 2 ? [...kinds].reverse() : kinds) {
    const { displayed, drawn, late } = await look(addresses, watching);
    all[name].displayed.push(...displayed);
    all[name].drawn.push(...drawn);
    all[name].late.push(late);
  }
}
await closeBrowser();
running.child.kill("SIGTERM"); // which ends the session too: a page that was there a moment ago is not asked
await running.code;
console.log(`frames per second, median (least to most) of ${turns} turns of ${looking} s with two pages`);
console.log(`  bare pages: displayed ${range(all.bare.displayed)}`);
console.log(`  our pages:  displayed ${range(all.ours.displayed)}, with new samples ${range(all.ours.drawn)}`);
console.log(`lateness of the loop in the same turns, p99.9 [µs], median (least to most)`);
console.log(`  no page: ${range(all.none.late)}; our pages: ${range(all.ours.late)}; bare pages: ${range(all.bare.late)}`);
console.log(`  our pages less no page, paired by turns, median:  ${paired(all.ours.late, all.none.late)}`);
console.log(`  bare pages less no page, paired by turns, median: ${paired(all.bare.late, all.none.late)}`);
console.log(running.said);

// What two pages cost the loop at 1 kHz in real time, and how often they draw: one trial, without pages, then two of them
// and two bare pages by turns. A bare page draws as much of its own as nothing: a canvas as large as the traces that it
// wipes in every frame. How many frames this machine and browser can do at the moment is what it shows, and what ours are
// to be held against. Times are reported and never judged.
//
// Run in the build folder of the page, where the packages are: cd build/bench/web/report, then
//   MBK=$PWD/../../bin/mbk node ../../../../bench/console.mjs [TURNS]
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { closeBrowser, folder, open, start } from "../tests/web/browser.mjs";

const turns = Number(process.argv[2] ?? 5);
const [alone, settling, looking] = [10, 3, 6]; // [s]
const seconds = alone + 2 * turns * (settling + looking + 1) + 10;

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
const read = ({ page }) => page.evaluate(() => [performance.now(), globalThis.displayed, Number(document.documentElement.dataset.framesPerSecond ?? NaN)]);

/** Two pages for a while: of each, the frames displayed per second, and what it says of those that it drew anew. */
async function look(addresses) {
  const pages = await Promise.all(addresses.map((address) => open(address, { viewport: { width: 1920, height: 1080 }, script: countFrames })));
  await wait(settling);
  const before = await Promise.all(pages.map(read));
  const drawn = pages.map(() => []);
  for (let k = 0; k < looking; ++k) {
    await wait(1);
    (await Promise.all(pages.map(read))).forEach(([, , rate], page) => drawn[page].push(rate));
  }
  const after = await Promise.all(pages.map(read));
  for (const page of pages) await page.close();
  return { displayed: after.map(([time, frames], k) => (1000 * (frames - before[k][1])) / (time - before[k][0])), drawn: drawn.flat() };
}

const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
const range = (values) => `${median(values).toFixed(1)} (${values[0].toFixed(1)} to ${values.at(-1).toFixed(1)})`;

const running = start("run", experiment, "--out", "long.h5", "--console", "--quiet", "--no-measure");
const [, operator] = await running.until(/console: +(http\S+)/);
const [, watching] = await running.until(/watch: +(http\S+)/);
await wait(alone);
const all = { bare: { displayed: [], drawn: [] }, ours: { displayed: [], drawn: [] } };
for (let turn = 0; turn < turns; ++turn) {
  for (const [name, addresses] of [["bare", [bare, bare]], ["ours", [operator, watching]]]) {
    const { displayed, drawn } = await look(addresses);
    all[name].displayed.push(...displayed);
    all[name].drawn.push(...drawn);
  }
}
await closeBrowser();
running.child.kill("SIGINT");
await running.code;
console.log(`frames per second, median (least to most) of ${turns} turns of ${looking} s with two pages`);
console.log(`  bare pages: displayed ${range(all.bare.displayed)}`);
console.log(`  our pages:  displayed ${range(all.ours.displayed)}, with new samples ${range(all.ours.drawn)}`);
console.log(running.said);

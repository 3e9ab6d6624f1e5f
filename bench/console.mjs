// What two pages cost the loop at 1 kHz in real time, and how often they draw: one trial, without pages, with two of them,
// without again. Times are reported and never judged.
//
// Run in the build folder of the page, where the packages are: cd build/bench/web/report, then
//   MBK=$PWD/../../bin/mbk node ../../../../bench/console.mjs
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { closeBrowser, folder, open, start } from "../tests/web/browser.mjs";

const experiment = join(folder, "minute.toml");
writeFileSync(experiment, '[participant]\nkind = "arm"\nnumber = 1\n[control]\nkind = "position"\n[perturbation]\nkind = "multisine"\nduration_s = 55\n');
const wait = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
const rate = ({ page }) => page.evaluate(() => document.documentElement.dataset.framesPerSecond);

const running = start("run", experiment, "--out", "minute.h5", "--console", "--quiet", "--no-measure");
const [, operator] = await running.until(/console: +(http\S+)/);
const [, watching] = await running.until(/watch: +(http\S+)/);
await wait(15);
const pages = [await open(operator, { viewport: { width: 1920, height: 1080 } }), await open(watching, { viewport: { width: 1920, height: 1080 } })];
const rates = [];
for (let k = 0; k < 20; ++k) {
  await wait(1);
  rates.push((await Promise.all(pages.map(rate))).map(Number));
}
await closeBrowser();
await running.code;
for (const k of pages.keys()) {
  const drawn = rates.map((both) => both[k]).sort((a, b) => a - b);
  console.log(`page ${k + 1}: ${drawn[drawn.length >> 1]} frames drawn per second (median; least ${drawn[0]}, most ${drawn.at(-1)})`);
}
console.log(running.said);

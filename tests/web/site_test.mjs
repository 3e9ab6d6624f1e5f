// The documentation site as its readers open it: from a folder, light and dark, by keyboard and with a screen reader.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath } from "node:url";
import { closeBrowser, eventually, folder, open, screenshot, violations } from "./browser.mjs";

after(closeBrowser);

const skipped = 77;
for (const tool of ["doxygen", "sphinx-build"]) {
  if (spawnSync(tool, ["--version"]).error) {
    console.log(`skipped: no ${tool}`);
    process.exit(skipped);
  }
}
const site = join(folder, "site");
const built = spawnSync(fileURLToPath(new URL("../../tools/docs", import.meta.url)), ["--mbk", process.env.MBK, "--to", site], { encoding: "utf8" });
assert.equal(built.status, 0, built.stdout + built.stderr);
const address = (name) => join(site, "html", `${name}.html`);

/** Part of what is seen that is nearly white. */
async function whiteShare(page) {
  const png = (await page.screenshot()).toString("base64");
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height });
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    let white = 0;
    for (let k = 0; k < pixels.length; k += 4) white += Math.min(pixels[k], pixels[k + 1], pixels[k + 2]) > 200;
    return white / (image.width * image.height);
  }, png);
}

const mostlyText = 0.1; // letters of a dark page cover less of it
const pages = ["index", "guide/reading_a_result", "guide/own_robot", "theory/equations", "commands/mbk-measure", "python/functions",
  "documents/ellipse", "library", "search", "api/files", "api/arm_8h", "api/arm_8h_source", "source/thesis/source.h"];

for (const name of pages) {
  test(`${name}: no error, no violation found by axe, dark where the screen is`, async () => {
    const { page, said, close } = await open(address(name));
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      await screenshot(page, `site_${name.replaceAll("/", "_")}_${colorScheme}`);
      const share = await whiteShare(page);
      assert.ok(colorScheme === "light" ? share > 0.5 : share < mostlyText, `${colorScheme}: ${share} of the page is white`);
      assert.deepEqual(await violations(page, { preload: false }), [], colorScheme);
    }
    assert.deepEqual(said, []);
    await close();
  });
}

test("the button's choice of dark holds on pages that other programs made", async () => {
  const { page, close } = await open(address("index"));
  await page.locator(".theme-toggle-content .theme-toggle").click(); // automatic, here light → dark
  for (const name of ["index", "api/files", "source/thesis/source.h"]) {
    await page.goto(`file://${address(name)}`);
    assert.ok(await whiteShare(page) < mostlyText, name);
  }
  await close();
});

test("the recording plays by keyboard, and is text for those who asked for less motion", async () => {
  const { page, said, close } = await open(address("index"), { reducedMotion: "no-preference" });
  const terminal = page.locator(".terminal .ap-wrapper");
  await terminal.focus();
  await page.keyboard.press("Space");
  await eventually(async () => assert.match(await page.locator(".terminal").innerText(), /mbk measure/));
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.reload();
  assert.equal(await terminal.count(), 0);
  assert.ok(await page.locator(".recorded pre").isVisible());
  assert.deepEqual(said, []);
  await close();
});

test("a search from a file finds the guide's page first", async () => {
  const { page, said, close } = await open(address("guide/run"));
  await page.fill(".sidebar-search", "clinicians");
  await page.press(".sidebar-search", "Enter");
  await eventually(async () => assert.match(await page.getAttribute("#search-results li a", "href", { timeout: 1000 }), /^guide\/clinician\.html/));
  assert.deepEqual(said, []);
  await close();
});

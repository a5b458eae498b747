// The widget of notebooks in a real browser: node tests/widget.mjs WIDGET.js STATE.json PICTURES
import { join } from "node:path";
import { check, launched, must, watch } from "./chromium.mjs";
import { shown } from "./stub.mjs";

const [, , file, given, pictures] = process.argv;
const { context, wrong } = await launched({ width: 1100, height: 760 });
await check({ context, wrong }, async () => {
  const page = await context.newPage();
  watch(page, wrong);
  await shown(page, file, given);
  const clock = () => page.locator(".clock").evaluate((output) => Number.parseFloat(output.value));
  await page.waitForFunction(
    () => Number.parseFloat(document.getElementById("cell").shadowRoot.querySelector(".clock").value) > 0.02,
  );

  // speed, exaggeration, scrub, step by keys, which the notebook does not get
  await page.getByLabel("Speed").selectOption("0.1");
  await page.getByLabel("Exaggeration").selectOption("2");
  await page.getByLabel("Time", { exact: true }).fill("0.1");
  must((await clock()) === 0.1, `scrubbed to ${await clock()} s instead of 0.1 s`);
  await page.locator("canvas").first().focus();
  await page.keyboard.press("ArrowRight");
  must((await clock()) === 0.11, `a step led to ${await clock()} s instead of 0.11 s`);
  must(!(await page.evaluate(() => globalThis.leaked)), "the notebook hears keys that were meant for the widget");

  // both runs are drawn, with their curves, and the notebook keeps its style
  must((await page.locator(".plots figure").count()) >= 3, "there are no plots");
  await page.waitForTimeout(100);
  const coloured = await page
    .locator(".plots canvas")
    .first()
    .evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let found = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] > 200 && Math.max(...data.slice(i, i + 3)) - Math.min(...data.slice(i, i + 3)) > 60) found++;
      return found;
    });
  must(coloured > 50, `the first plot has a curve of ${coloured} pixels`);
  const pixels = await page
    .locator("canvas")
    .first()
    .evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      let faint = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i] === 0xa9 && data[i + 1] === 0xb4 && data[i + 2] === 0xc0) faint++;
      return faint;
    });
  must(pixels > 200, `the other run has ${pixels} pixels`);
  const heading = await page
    .locator("h1")
    .first()
    .evaluate((h) => getComputedStyle(h).fontFamily);
  must(heading === "serif", `the notebook's heading has become ${heading}`);
  if (pictures) await page.screenshot({ path: join(pictures, "widget.png") });

  // its height follows the trait; in the dark; closed, it leaves nothing
  await page.evaluate(() => globalThis.model.set("height", 480));
  must((await page.locator(".page").evaluate((p) => p.clientHeight)) === 478, "the height does not follow");
  await page.evaluate(() => {
    document.getElementById("cell").dataset.theme = "dark";
  });
  await page.setViewportSize({ width: 640, height: 640 });
  await page.waitForTimeout(150);
  if (pictures) await page.screenshot({ path: join(pictures, "widget-dark.png") });
  await page.evaluate(() => globalThis.close());
  must((await page.evaluate(() => globalThis.heard.size)) === 0, "a closed widget still listens");
});

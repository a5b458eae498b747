// The page around the picture in a real browser: node tests/shell.mjs ADDRESS FOLDER SERVER PICTURES; SERVER: number of its process.
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { check, launched, must, watch } from "./chromium.mjs";

const [, , address, folder, server, pictures] = process.argv;
const cycles = Number(process.env.STUDIO_CYCLES ?? 10);
const TABS = ["Values", "Form", "Text", "Result", "Sweep", "Lesson"];
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const LONG = readFileSync(join(folder, "rope.yaml"), "utf8")
  .replace("speed: 10 m/s, measured: slip, from: 0 m", "speed: 0 m/s, from: 5.1 m")
  .replace("0.3 s", "3000 s");
for (const name of ["long.yaml", "other.yaml"]) writeFileSync(join(folder, name), LONG.replace("slack", name));

const { context, wrong } = await launched({ width: 1280, height: 800 });
const said = []; // messages of the page
async function opened() {
  const page = await context.newPage();
  page.setDefaultTimeout(30_000);
  watch(page, wrong);
  page.on("dialog", (dialog) => {
    said.push(dialog.message());
    dialog.accept();
  });
  await page.exposeFunction("heard", (text) => said.push(text));
  await page.addInitScript(() => {
    addEventListener("DOMContentLoaded", () => {
      const texts = () => [...document.querySelectorAll(".status, .state")].map((one) => one.textContent);
      new MutationObserver(() => texts().forEach(globalThis.heard)).observe(document.body, {
        subtree: true,
        childList: true,
        characterData: true,
      });
    });
  });
  await page.goto(address);
  await ready(page);
  return page;
}
const ready = (page) => page.waitForFunction(() => globalThis.ropewalkDelays?.length > 0);
const look = async (page, name) => pictures && page.screenshot({ path: join(pictures, `${name}.png`) });
const press = (page, name) => page.getByRole("button", { name, exact: true }).click();
const choose = (page, name) => page.getByLabel("Open", { exact: true }).selectOption(name);
const state = (page, text) => page.locator(".state", { hasText: text }).waitFor();
const focused = (page) =>
  page.evaluate(() => {
    const { id, ariaLabel, textContent, tagName } = document.activeElement;
    return id || ariaLabel || textContent || tagName;
  });
const place = (page) => page.locator('dt:text-is("walker: place x, z") + dd').textContent();
/** Stop what is computed; the seconds until something can be run again: less than 1 on an idle machine. */
async function stopped(page, what, most = 2.5) {
  await page.locator("button:not(:disabled)", { hasText: "Stop" }).waitFor();
  const seconds = await page.evaluate(
    () =>
      new Promise((done) => {
        const run = document.querySelector("header button.main");
        const begin = performance.now();
        const watch = new MutationObserver(() => run.disabled || done((performance.now() - begin) / 1000));
        watch.observe(run, { attributes: true });
        [...document.querySelectorAll("header button")].find((one) => one.textContent === "Stop").click();
      }),
  );
  must(seconds < most, `${what} took ${seconds} s to stop`);
  return seconds;
}
async function faults(page, where) {
  if (!(await page.evaluate(() => globalThis.axe))) await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  for (const { id, nodes } of violations) wrong.push(`${where}: ${id} ${nodes[0].html} ${nodes[0].failureSummary}`);
}

await check({ context, wrong }, async () => {
  const page = await opened();

  // the name of the open file; a run, whose exports are of the result shown, one row of them
  must((await page.locator(".file").textContent()) === "rope.yaml", "the name of the file is not shown");
  await press(page, "Run");
  await page.getByText("result in rope.nc").waitFor();
  await choose(page, "result:rope.nc");
  await page.locator(".exports").first().waitFor();
  await choose(page, "result:rope.nc");
  await page.waitForFunction(() => document.querySelectorAll(".export").length > 0);
  await page.waitForTimeout(300);
  must((await page.getByText("Interactive page").count()) === 1, "exports are shown twice");
  await page.waitForFunction(() => Number.parseFloat(document.querySelector(".clock").value) > 0); // it plays

  // in every tab, light, dark, on a telephone and in large type: no faults of access, nothing wider than the page
  for (const look_ of ["light", "dark", "telephone", "large"]) {
    await page.emulateMedia({ colorScheme: look_ === "dark" ? "dark" : "light" });
    const telephone = { width: 390, height: 844 };
    await page.setViewportSize(look_ === "telephone" ? telephone : { width: 1280, height: 800 });
    if (look_ === "large") await press(page, "Large type");
    for (const tab of TABS) {
      await page.getByRole("tab", { name: tab }).click();
      await page.evaluate(() => scrollTo(0, 0));
      await page.waitForFunction(() => {
        const { height, clientHeight } = document.querySelector(".stage canvas");
        return height === clientHeight; // the picture is painted as high as it is shown
      });
      if (look_ !== "large") await faults(page, `${tab}, ${look_}`);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      must(wide <= 0, `${tab}, ${look_}: wider than the window by ${wide} pixels`);
      await look(page, `${tab.toLowerCase()}-${look_}`);
    }
  }
  await press(page, "Large type");

  // by keyboard: every control comes once, tabs by arrow keys, the load in the picture by arrow keys
  await press(page, "Drag the load");
  await page.locator('dt:text-is("walker: friction needed")').waitFor();
  await page.getByLabel("Open", { exact: true }).focus();
  const seen = [];
  for (let k = 0; k < 60 && !seen.includes(await focused(page)); k++) {
    seen.push(await focused(page));
    await page.keyboard.press("Tab");
  }
  for (const name of ["Open", "Run", "Large type", "tab-values", "Contact", "Into the text"])
    must(seen.includes(name), `${name} cannot be reached by Tab, only ${seen}`);
  must(seen.filter((name) => /^tab-/.test(name)).length === 1, `more than one tab in the order: ${seen}`);
  await page.locator("#tab-values").focus();
  const along = [];
  for (const key of ["ArrowRight", "End", "ArrowRight", "ArrowLeft", "Home"]) {
    await page.keyboard.press(key);
    along.push(await focused(page));
  }
  must(`${along}` === "tab-form,tab-lesson,tab-values,tab-lesson,tab-values", `arrow keys led to ${along}`);
  await page.locator("canvas").first().focus();
  const there = await place(page);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((old) => !document.querySelector(".numbers").textContent.includes(old), there);

  // a swipe scrolls, unless it starts on the load
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(200);
  const touch = await context.newCDPSession(page);
  await touch.send("Emulation.setTouchEmulationEnabled", { enabled: true });
  const box = await page.locator("canvas").first().boundingBox();
  const swipe = async (x, y, dx, dy) => {
    const at = (part) => [{ x: x + part * dx, y: y + part * dy }];
    await touch.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
    for (let part = 0.1; part < 1; part += 0.1)
      await touch.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(part) });
    await touch.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await page.waitForTimeout(300);
    return page.evaluate(() => scrollY);
  };
  const before = await place(page);
  must((await swipe(box.x + 60, box.y + box.height - 60, 0, -200)) > 100, "a swipe over the picture does not scroll");
  must((await place(page)) === before, "a swipe over the picture moves the load");
  await page.evaluate(() => scrollTo(0, 0));
  await page.waitForTimeout(500); // a busy machine may still be scrolling, which no touch interrupts
  const [left, top] = await page.evaluate(() => globalThis.ropewalkLoad());
  must((await swipe(box.x + left, box.y + top, 60, -60)) === 0, "a swipe that starts on the load scrolls");
  await page.waitForTimeout(500);
  must((await place(page)) !== before, "a swipe that starts on the load does not move it");
  await touch.send("Emulation.setTouchEmulationEnabled", { enabled: false });
  await page.setViewportSize({ width: 1280, height: 800 });

  // the text of a lesson is over its own picture only
  await page.getByRole("tab", { name: "Lesson" }).click();
  await page.locator(".steps button").first().click();
  await page.locator(".steps [aria-current]").waitFor();
  await choose(page, "file:long.yaml");
  await ready(page);
  await page.locator(".file", { hasText: "long.yaml" }).waitFor();
  must((await page.locator(".steps [aria-current]").count()) === 0, "the text of a lesson is over another picture");

  // what is computed is shown in the picture; it is found again after a reload, with its text; stopped, at once
  await press(page, "Run");
  await state(page, /^computing \d+ %/);
  await page.reload();
  await state(page, /^computing \d+ %/);
  must((await page.locator(".file").textContent()) === "long.yaml", "the file of the run is not found again");
  await page.waitForFunction(() => Number.parseFloat(document.querySelector(".clock").value) > 0.1);
  await look(page, "reloaded");
  await stopped(page, "a run");
  await page.locator(".status", { hasText: "interrupted" }).waitFor();

  // what is opened while something else is computed is shown alone
  await press(page, "Run");
  await state(page, /^computing/);
  await choose(page, "file:rope.yaml");
  await page.getByLabel("Contact", { exact: true }).waitFor(); // rope.yaml can be dragged
  await page.waitForTimeout(300);
  must((await page.locator(".export").count()) === 0, "exports of a stopped run are over another picture");

  // two pages compute at once; a worker that is killed costs the run of its page only
  const second = await opened();
  for (const [one, name] of [
    [page, "file:long.yaml"],
    [second, "file:other.yaml"],
  ]) {
    await choose(one, name);
    await one.locator(".file", { hasText: name.slice(5) }).waitFor();
    await press(one, "Run");
    await state(one, /^computing/);
  }
  for (const number of workers().slice(-1)) process.kill(number, "SIGKILL");
  await second.locator(".status.bad", { hasText: /process.* has ended/ }).waitFor();
  must(/^computing/.test(await page.locator(".state").textContent()), "the other page has lost its run");
  await press(second, "Run");
  await state(second, /^computing/);
  await stopped(second, "a run of a new worker");
  await second.close();
  await stopped(page, "the run of the other page");

  // open, run and stop again and again, whatever is under way by then
  const [session, memory] = [await context.newCDPSession(page), []];
  for (let k = 0, worst = 0; k < cycles; k++) {
    await choose(page, k % 2 ? "file:long.yaml" : "file:other.yaml");
    await page.locator(".file", { hasText: k % 2 ? "long.yaml" : "other.yaml" }).waitFor();
    await press(page, "Run");
    await page.waitForTimeout([0, 30, 100, 300][k % 4]);
    worst = Math.max(worst, await stopped(page, `cycle ${k}`));
    if (k % 20 === 19) {
      await session.send("HeapProfiler.collectGarbage");
      const heap = await page.evaluate(() => performance.memory.usedJSHeapSize / 1e6);
      const resident = Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server}/status`, "utf8"))[1]) / 1e3;
      memory.push([heap, resident]);
      console.log(
        `cycle ${k + 1}: page ${heap.toFixed(1)} MB, server ${resident.toFixed(1)} MB, ${worst.toFixed(2)} s`,
      );
    }
  }
  const [early, late] = [memory[1], memory.at(-1)];
  if (memory.length > 4)
    must(late[0] < 1.2 * early[0] + 2 && late[1] < 1.1 * early[1] + 5, `memory grows from ${early} MB to ${late} MB`);

  // messages without words of the command line and without full paths
  const private_ = said.filter((text) => /(^|\s)--?[a-z]|ropewalk (run|show|calc|sweep)|(^|\s)\/\w+\//.test(text));
  must(private_.length === 0, `messages: ${private_}`);
});

/** Numbers of the processes of the server that compute, in the order in which they began. */
function workers() {
  const children = readFileSync(`/proc/${server}/task/${server}/children`, "utf8").trim().split(" ").map(Number);
  return children.filter((one) => /spawn_main/.test(readFileSync(`/proc/${one}/cmdline`, "utf8")));
}

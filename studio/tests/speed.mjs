// How fast the studio is, as JSON: node tests/speed.mjs drag|linger ADDRESS SECONDS | play|stay PAGE.html SECONDS
import { launched, watch } from "./chromium.mjs";

const [, , what, given, seconds] = process.argv;
const { context, wrong } = await launched();
const page = await context.newPage();
watch(page, wrong);
const address = given.startsWith("http:") ? given : `file://${given}`;
const painted = () => page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime);

/** Move the mouse to and fro 60 times a second, not waiting for the page; how long the rope took to follow. */
async function drag() {
  const paints = [];
  for (let k = 0; k < 5; k++) {
    await page.goto(address);
    await page.waitForFunction(() => globalThis.ropewalkDelays?.length > 0, undefined, { timeout: 120_000 });
    paints.push(await painted());
  }
  const box = await page.locator("canvas").first().boundingBox();
  const session = await context.newCDPSession(page);
  const at = (ms) => ({ x: box.x + box.width * (0.5 + 0.25 * Math.sin(ms / 700)), y: box.y + 200 });
  const mouse = (type, ms) =>
    session.send("Input.dispatchMouseEvent", { type, ...at(ms), button: "left", buttons: 1, clickCount: 1 });
  await mouse("mousePressed", 0);
  await page.waitForTimeout(500);
  await page.evaluate(() => {
    globalThis.ropewalkDelays.length = 0;
    globalThis.moves = 0;
    document.querySelector("canvas").addEventListener("pointermove", () => {
      globalThis.moves++;
    });
  });
  console.log("BEGIN");
  const begin = performance.now();
  let sent = 0;
  while (performance.now() - begin < 1000 * seconds) {
    mouse("mouseMoved", performance.now() - begin).catch(() => {});
    sent++;
    await new Promise((later) => setTimeout(later, begin + (1000 / 60) * sent - performance.now()));
  }
  const ms = performance.now() - begin;
  console.log("END");
  const found = await page.evaluate(() => ({ delays: globalThis.ropewalkDelays, moves: globalThis.moves }));
  return { ms, sent, ...found, paints };
}

/** Frames of the browser while a film plays, which paints in every one. */
async function play() {
  await page.goto(address);
  await page.waitForFunction(() => Number.parseFloat(document.querySelector(".clock").value) > 0);
  console.log("BEGIN");
  const found = await page.evaluate(
    (ms) =>
      new Promise((done) => {
        const button = document.querySelector(".player button");
        const begin = performance.now();
        let frames = 0;
        const step = () => {
          const now = performance.now() - begin;
          if (now > ms) return done({ ms: now, frames });
          if (button.getAttribute("aria-label") === "Play") button.click();
          frames++;
          requestAnimationFrame(step);
        };
        requestAnimationFrame(step);
      }),
    1000 * seconds,
  );
  console.log("END");
  return { ...found, paints: [await painted()] };
}

/** The heap of the page after its garbage is gone, after every round of what is done again and again. */
async function heapAfter(round) {
  const session = await context.newCDPSession(page);
  await session.send("Performance.enable");
  const heap = [];
  for (let begin = Date.now(); Date.now() - begin < 1000 * seconds; ) {
    await round();
    await session.send("HeapProfiler.collectGarbage");
    const { metrics } = await session.send("Performance.getMetrics");
    const of = (name) => metrics.find((metric) => metric.name === name).value;
    heap.push([(Date.now() - begin) / 1000, of("JSHeapUsedSize"), of("Nodes")]);
    console.log("ROUND");
  }
  return { heap };
}

/** A film that plays again and again, ten seconds a round. */
async function stay() {
  await page.goto(address);
  return heapAfter(async () => {
    for (let k = 0; k < 10; k++) {
      await page.evaluate(() => {
        const button = document.querySelector(".player button");
        if (button.getAttribute("aria-label") === "Play") button.click();
      });
      await page.waitForTimeout(1000);
    }
  });
}

/** A load that is dragged for two seconds of twenty. */
async function linger() {
  await page.goto(address);
  await page.waitForFunction(() => globalThis.ropewalkDelays?.length > 0, undefined, { timeout: 120_000 });
  const box = await page.locator("canvas").first().boundingBox();
  const at = (k) => [box.x + box.width * (0.5 + 0.25 * Math.sin(k / 40)), box.y + 200];
  return heapAfter(async () => {
    await page.mouse.move(...at(0));
    await page.mouse.down();
    for (let k = 0; k < 120; k++) {
      await page.mouse.move(...at(k));
      await page.waitForTimeout(1000 / 60);
    }
    await page.mouse.up();
    await page.waitForTimeout(18_000);
  });
}

try {
  const found = await { drag, linger, play, stay }[what]();
  console.log(JSON.stringify({ ...found, wrong }));
} finally {
  await context.close();
}

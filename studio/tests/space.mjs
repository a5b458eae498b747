// A net of 6 m x 4 m that sags by 1 m, and ropes, in space: node tests/space.mjs WIDGET.js NET.json ROPES.json PICTURES
import { join } from "node:path";
import { check, launched, must, watch } from "./chromium.mjs";
import { shown } from "./stub.mjs";

const [, , module, net, ropes, pictures] = process.argv;
const { context, wrong } = await launched({ width: 1100, height: 760 });
const page = await context.newPage();
const look = async (name) => pictures && page.screenshot({ path: join(pictures, `space-${name}.png`) });
const view = async (name) => page.getByRole("button", { name, exact: true }).click();

/** How many pixels below the scale have colour, and from where to where: the floor is grey. */
async function drawn() {
  await page.waitForTimeout(150);
  return page.evaluate(async () => {
    const image = await createImageBitmap(document.getElementById("cell").shadowRoot.querySelector("canvas"));
    const flat = new OffscreenCanvas(image.width, image.height).getContext("2d");
    flat.drawImage(image, 0, 0);
    const { data } = flat.getImageData(0, 0, image.width, image.height);
    const found = { count: 0, left: 1e4, right: 0, up: 1e4, down: 0 };
    for (let i = 160 * image.width; i < data.length; i += 4) {
      const own = data.slice(i, i + 3);
      if (data[i + 3] < 100 || Math.max(...own) - Math.min(...own) < 20) continue;
      const [x, y] = [(i / 4) % image.width, Math.floor(i / 4 / image.width)];
      found.count++;
      [found.left, found.right] = [Math.min(found.left, x), Math.max(found.right, x)];
      [found.up, found.down] = [Math.min(found.up, y), Math.max(found.down, y)];
    }
    return { ...found, width: found.right - found.left + 1, height: found.down - found.up + 1 };
  });
}

await check({ context, wrong }, async () => {
  watch(page, wrong);
  await page.goto("about:blank");
  await shown(page, module, net);
  await page.getByRole("group", { name: "Camera" }).waitFor({ timeout: 20_000 });
  await page.getByLabel("Time", { exact: true }).fill("1");
  const aside = await drawn();
  must(aside.count > 3000, `${aside.count} pixels have colour`);
  await look("perspective");

  // the camera goes around by mouse and by keys; arrow keys alone step through time
  const over = page.locator("canvas").first();
  const box = await over.boundingBox();
  await page.mouse.move(box.x + 300, box.y + 150);
  await page.mouse.down();
  await page.mouse.move(box.x + 420, box.y + 150, { steps: 5 });
  await page.mouse.up();
  const turned = await drawn();
  must(Math.abs(turned.width - aside.width) > 8, "the camera does not follow the mouse");
  const clock = () => page.locator(".clock").evaluate((output) => Number.parseFloat(output.value));
  await over.focus();
  for (let k = 0; k < 6; k++) await page.keyboard.press("Shift+ArrowLeft");
  must(Math.abs((await drawn()).width - turned.width) > 4, "the camera does not follow keys");
  must((await clock()) === 1, "turning has changed the instant");
  await page.keyboard.press("ArrowLeft");
  must((await clock()) === 0.5, "an arrow key does not step");
  await page.keyboard.press("ArrowRight");

  // sizes are those of the net: without perspective, to scale; where one looks along it, grey threads hide its edges
  const near = (found, expected, what) =>
    must(Math.abs(found - expected) < 0.05 * expected, `${what}: ${found} instead of ${expected} pixels`);
  await view("Plan");
  const plan = await drawn();
  near(plan.width / plan.height, 6 / 4, "plan, width to height");
  await look("plan");
  await view("Elevation");
  const front = await drawn();
  near(front.width, plan.width, "elevation, width");
  near(front.height, plan.height / 4, "elevation, sag");
  await look("elevation");
  await view("Side");
  near((await drawn()).width, plan.height, "side, width");
  await page.getByLabel("Exaggeration").selectOption("2");
  near((await drawn()).height, 2 * front.height, "exaggerated sag");
  await page.keyboard.press("+"); // the button has the focus, not the picture
  await over.focus();
  await page.keyboard.press("+");
  near((await drawn()).width, 1.1 * plan.height, "nearer");
  await page.evaluate(() => globalThis.close());

  await shown(page, module, ropes);
  await page.getByRole("group", { name: "Camera" }).waitFor({ timeout: 20_000 });
  await page.getByLabel("Time", { exact: true }).fill("1");
  must((await drawn()).count > 500, "there are no ropes");
  await look("ropes");
});

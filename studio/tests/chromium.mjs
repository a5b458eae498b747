// A browser that writes down what must not be: requests beyond this machine.
import { existsSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const flags =
  "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync";

export function must(is, what) {
  if (!is) throw new Error(what);
}

/** A context of pages, and the list of what was wrong in them. */
export async function launched(viewport = { width: 1280, height: 720 }) {
  const wrong = [];
  const context = await chromium.launchPersistentContext(mkdtempSync(join(tmpdir(), "studio-")), {
    executablePath,
    headless: true,
    args: flags.split(" "),
    viewport,
  });
  context.on("request", (request) => {
    const { protocol, hostname } = new URL(request.url());
    if (!["data:", "blob:", "file:", "about:"].includes(protocol) && hostname !== "127.0.0.1")
      wrong.push(`asked ${request.url()}`);
  });
  return { context, wrong };
}

/** Write down what a page complains of. */
export function watch(page, wrong) {
  page.on("pageerror", (error) => wrong.push(`page error: ${error.message}`));
  page.on("console", (said) => {
    if (said.type() === "error" && !/WebSocket connection/.test(said.text())) wrong.push(`console: ${said.text()}`);
  });
}

/** Take the steps of a check and say how they ended, by the exit code as well. */
export async function check({ context, wrong }, steps) {
  try {
    await steps();
    must(wrong.length === 0, wrong.join("\n"));
    console.log("all as it should be");
  } catch (error) {
    console.log(`${error.message}\n${wrong.join("\n")}`);
    process.exitCode = 1;
  } finally {
    await context.close();
  }
}

import { expect, test } from "vitest";
import { inShadow, themeOf } from "../src/shadow";

test("in a shadow root the style of the root and of the body is that of the host and of the page in it", () => {
  const style = ':root:not([data-theme="light"]){--dark:1}:root{--dark:0}\nbody.shared aside,body{margin:0}.somebody{}';
  expect(inShadow(style)).toBe(
    ':host(:not([data-theme="light"])){--dark:1}:host{--dark:0}\n.page.shared aside,.page{margin:0}.somebody{}',
  );
});

test("the theme is that of the notebook, where it tells", () => {
  const body = (className: string, jpThemeLight?: string) => ({ className, dataset: { jpThemeLight } }) as never;
  expect(themeOf(body("", "false"))).toBe("dark");
  expect(themeOf(body("", "true"))).toBe("light");
  expect(themeOf(body("vscode-body vscode-dark"))).toBe("dark");
  expect(themeOf(body("vscode-high-contrast-light"))).toBe("light");
  expect(themeOf(body(""))).toBe(undefined);
});

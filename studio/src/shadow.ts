/** A page's style as that of a shadow root: what it says of the root and of the body holds for the host and `.page`. */
export function inShadow(style: string): string {
  return style
    .replace(/:root((?::not\([^)]*\)|\[[^\]]*\])?)/g, (_, more: string) => (more ? `:host(${more})` : ":host"))
    .replace(/(^|[\s,}])body(?=[\s.{,])/g, "$1.page");
}

/** Whether a notebook is light or dark, if it tells. */
export function themeOf(body: HTMLElement): "light" | "dark" | undefined {
  const light = body.dataset.jpThemeLight; // JupyterLab, Notebook 7
  if (light) return light === "true" ? "light" : "dark";
  const names = body.className; // Visual Studio Code
  if (/vscode-(dark|high-contrast(?!-light))/.test(names)) return "dark";
  return /vscode-/.test(names) ? "light" : undefined;
}

import { defineConfig, type Plugin } from "vite";

/** Takes script and style out of a build, which then consists of what is made of them. */
function inOneFile(made: (script: string, style: string) => { fileName: string; source: string }): Plugin {
  return {
    name: "one-file",
    enforce: "post", // when the style is there
    generateBundle(_, bundle) {
      let script = "";
      let style = "";
      for (const [name, file] of Object.entries(bundle)) {
        if (file.type === "chunk")
          script += file.code.replaceAll("__VITE_PRELOAD__", "void 0"); // all is here
        else if (name.endsWith(".css")) style += file.source;
        delete bundle[name];
      }
      this.emitFile({ type: "asset", ...made(script, style) });
    },
  };
}

/** One page with its script and style inside and a place for data: `ropewalk.studio.share` fills it. */
function onePage(script: string, style: string): { fileName: string; source: string } {
  const policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";
  const source = [
    '<!doctype html><html lang="en"><head><meta charset="utf-8">',
    '<meta name="viewport" content="width=device-width, initial-scale=1">',
    `<meta http-equiv="Content-Security-Policy" content="${policy}">`,
    `<title>ropewalk</title><style>${style}</style></head><body class="shared">`,
    `<script>${script.replaceAll("</script", "<\\/script")}</script>`,
    "<!--ropewalk-data--></body></html>",
  ].join("\n");
  return { fileName: "share.html", source };
}

/** One module with its style inside, for notebooks: `ropewalk.studio.widget` hands it over. */
function oneModule(script: string, style: string): { fileName: string; source: string } {
  return { fileName: "widget.js", source: script.replace(/(["'`])ropewalk-style\1/, () => JSON.stringify(style)) };
}

const PAGE = "../src/ropewalk/studio/page";
const SINGLE = { share: onePage, widget: oneModule };

// Modes `share` and `widget` make one file each.
export default defineConfig(({ mode }) => {
  const single = mode as keyof typeof SINGLE;
  const isSingle = single in SINGLE;
  return {
    base: isSingle ? "/" : "./",
    plugins: isSingle ? [inOneFile(SINGLE[single])] : [],
    build: {
      outDir: isSingle ? `${PAGE}/${mode}` : PAGE,
      emptyOutDir: true,
      cssCodeSplit: false,
      cssTarget: ["chrome111", "firefox114", "safari16.4"], // without light-dark(), which scripts read as it is written
      modulePreload: false,
      chunkSizeWarningLimit: 1500,
      rollupOptions: {
        input: isSingle ? `src/${single}.ts` : "index.html",
        preserveEntrySignatures: single === "widget" ? "strict" : undefined,
        checks: { emptyImportMeta: false, pluginTimings: false }, // of the helper that fetches parts: here are none
        output: isSingle ? { codeSplitting: false, format: single === "share" ? "iife" : "es" } : undefined,
      },
    },
  };
});

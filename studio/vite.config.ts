import { defineConfig, type Plugin } from "vite";

/** One page with its script and style inside and a place for data: `ropewalk.studio.share` fills it. */
function onePage(): Plugin {
  return {
    name: "one-page",
    generateBundle(_, bundle) {
      let script = "";
      let style = "";
      for (const [name, file] of Object.entries(bundle)) {
        if (file.type === "chunk") script += file.code;
        else if (name.endsWith(".css")) style += file.source;
        delete bundle[name];
      }
      const policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:";
      const source = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        `<meta http-equiv="Content-Security-Policy" content="${policy}">`,
        `<title>ropewalk</title><style>${style}</style></head><body class="shared">`,
        '<script type="application/json" id="data">"ropewalk-data"</script>',
        `<script type="module">${script.replaceAll("</script", "<\\/script")}</script></body></html>`,
      ].join("\n");
      this.emitFile({ type: "asset", fileName: "share.html", source });
    },
  };
}

export default defineConfig(({ mode }) => {
  const page = "../src/ropewalk/studio/page";
  const share = mode === "share";
  return {
    base: "./",
    plugins: share ? [onePage()] : [],
    build: {
      outDir: share ? `${page}/share` : page,
      emptyOutDir: true,
      cssCodeSplit: false,
      modulePreload: false,
      chunkSizeWarningLimit: 1500,
      rollupOptions: { input: share ? "src/share.ts" : "index.html" },
    },
  };
});

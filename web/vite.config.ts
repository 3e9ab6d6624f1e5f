// How each page becomes one file: vite build PAGE --config vite.config.ts
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { defineConfig, type Plugin } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

/** The 'sha256-…' of every element of that name whose text a browser runs or applies. Data are never run. */
function hashes(html: string, name: string): string {
  const elements = html.matchAll(new RegExp(`<${name}\\b([^>]*)>([^]*?)</${name}>`, "g"));
  return [...elements].filter(([, attributes]) => !attributes!.includes("application/json"))
    .map(([, , text]) => ` 'sha256-${createHash("sha256").update(text!).digest("base64")}'`).join("");
}

/** Allows a page that is opened as a file what stands in it, and no network. The console says the same in its headers. */
function contentSecurityPolicy(): Plugin {
  return {
    name: "content-security-policy",
    writeBundle({ dir }, bundle) {
      for (const name of Object.keys(bundle).filter((file) => file.endsWith(".html"))) {
        const file = join(dir ?? ".", name);
        const html = readFileSync(file, "utf8");
        if (!html.includes("@MBK_REPORT_DATA@")) continue;
        const policy = `default-src 'none'; script-src${hashes(html, "script")}; style-src${hashes(html, "style")}; img-src data: blob:; `
          + "base-uri 'none'; form-action 'none'";
        writeFileSync(file, html.replace("<head>", () => `<head>\n    <meta http-equiv="Content-Security-Policy" content="${policy}">`));
      }
    },
  };
}

export default defineConfig({
  plugins: [viteSingleFile(), contentSecurityPolicy()],
  build: { target: "es2022", chunkSizeWarningLimit: 2000 },
});

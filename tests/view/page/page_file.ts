// Pages for tests, put together as the command does it: schema/view.md, "Where".

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { dirname, join } from "node:path";

const kHere = dirname(fileURLToPath(import.meta.url));

/** Of the checkout: bundles lie in build/view_page, the page in lib/slamdb/view/page. */
export const kRoot = process.env.SLAMDB_ROOT ?? join(kHere, "../../..");
export const kPageFolder = join(kRoot, "lib/slamdb/view/page");

const hashOf = (text: string): string => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

export function escaped(text: string): string {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/"/g, "&quot;");
}

/** A page with markup, style and script of the checkout about the given data blocks. */
export function makePage(title: string, blocks: string, script: string): string {
  const style = readFileSync(join(kPageFolder, "page.css"), "utf8");
  const csp = `default-src 'none'; script-src ${hashOf(script)}; style-src ${hashOf(style)}; img-src data: blob:; connect-src 'none'; base-uri 'none'; form-action 'none'`;
  const parts: Record<string, string> = { TITLE: escaped(title), CSP: csp, STYLE: style, DATA: blocks, SCRIPT: script };
  return readFileSync(join(kPageFolder, "page.html"), "utf8").replace(/\{\{(\w+)\}\}/g, (_, name: string) => parts[name]);
}

/** The data blocks of a page that the command wrote. */
export function blocksOf(page: string): string {
  const begin = page.indexOf('<script type="text/plain"');
  const last = page.lastIndexOf('<script type="text/plain"');
  return begin < 0 ? "" : page.slice(begin, page.indexOf("</script>", last) + "</script>".length);
}

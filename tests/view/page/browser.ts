// A browser for tests: Debian's chromium, drawing by software. Each page has a profile of its own, which nothing was kept in.

import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { type Browser, chromium, type BrowserContext, type Page } from "playwright-core";
import type { Model } from "../../../lib/slamdb/view/page/model";
import type { Stage } from "../../../lib/slamdb/view/page/stage";
import { blocksOfParts, columnsOf, pack, type PlainScene } from "./encoder";
import { makePage } from "./page_file";
import { readPng, type Picture } from "./png";

export const kChromium = process.env.CHROMIUM ?? "/usr/bin/chromium";
export const noChromium = existsSync(kChromium) ? false : `${kChromium} is not there`;
const kArguments = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
  "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
];

export interface Look {
  width?: number;
  height?: number;
  scheme?: "dark" | "light";
  touch?: boolean;
  reducedMotion?: boolean;
  hash?: string;
  before?: string; // a script that runs before the page's
  state?: "ready" | "failed";
}

/** What main.ts leaves for tests. */
interface Left {
  slamdbView: {
    model: Model;
    stage: Stage;
  };
}
export type PageGlobals = typeof globalThis & Left & { violations: string[] };

export class Viewer {
  readonly folder = mkdtempSync(join(tmpdir(), "slamdb-view-"));
  private readonly script = readFileSync(process.env.PAGE_SCRIPT ?? "", "utf8").trimEnd();
  private browser?: Promise<Browser>; // begun with the first page
  private files = 0;

  /** A file with a page of the scene. */
  write(scene: PlainScene, change: (blocks: string) => string = (blocks) => blocks): string {
    return this.writeBlocks(scene.title, change(blocksOfParts(pack(columnsOf(scene)))));
  }

  writeBlocks(title: string, blocks: string): string {
    const file = join(this.folder, `page${this.files++}.html`);
    writeFileSync(file, makePage(title, blocks, this.script));
    return file;
  }

  async open(file: string, look: Look = {}): Promise<Opened> {
    this.browser ??= chromium.launch({ executablePath: kChromium, args: kArguments });
    const context = await (await this.browser).newContext({
      viewport: { width: look.width ?? 1000, height: look.height ?? 700 }, colorScheme: look.scheme ?? "dark",
      hasTouch: look.touch ?? false, reducedMotion: look.reducedMotion ? "reduce" : "no-preference", acceptDownloads: true,
    });
    const page = await context.newPage();
    const complaints: string[] = [];
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    page.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && complaints.push(`asks for ${request.url()}`));
    await page.addInitScript("globalThis.violations = []; document.addEventListener('securitypolicyviolation', (e) => violations.push(e.violatedDirective + ' ' + e.blockedURI));");
    if (look.before) await page.addInitScript(look.before);
    await page.goto(`file://${file}${look.hash ? `#${look.hash}` : ""}`);
    await page.waitForFunction((state) => document.documentElement.dataset.state === state, look.state ?? "ready", { timeout: 120000 });
    const opened = new Opened(page, complaints, context);
    if ((look.state ?? "ready") === "ready") await opened.rest();
    return opened;
  }

  async close(): Promise<void> {
    await (await this.browser)?.close();
    rmSync(this.folder, { recursive: true, force: true });
  }
}

export class Opened {
  constructor(readonly page: Page, private readonly complaints: string[], private readonly context: BrowserContext) {}

  /** Until everything asked for is drawn. */
  async rest(): Promise<void> {
    await this.page.waitForTimeout(60);
    await this.page.waitForFunction(() => (globalThis as PageGlobals).slamdbView.stage.resting, undefined, { timeout: 120000 });
  }

  /** The picture without the controls. */
  async picture(): Promise<Picture> {
    await this.rest();
    await this.page.evaluate(() => document.querySelectorAll<HTMLElement>("main > :not(canvas)").forEach((card) => (card.style.opacity = "0")));
    const file = await this.page.screenshot();
    await this.page.evaluate(() => document.querySelectorAll<HTMLElement>("main > :not(canvas)").forEach((card) => (card.style.opacity = "")));
    return readPng(file);
  }

  async screenshot(name: string): Promise<void> {
    const folder = process.env.SLAMDB_VIEW_SHOTS;
    if (!folder) return;
    await this.rest();
    await this.page.screenshot({ path: join(folder, `${name}.png`) });
  }

  /** Where a keyframe or a point is on the screen. */
  async place(kind: "keyframe" | "point", row: number): Promise<{ x: number; y: number }> {
    return this.page.evaluate(([kind, row]) => {
      const { stage, model } = (globalThis as PageGlobals).slamdbView;
      return stage.camera.project(kind === "keyframe" ? model.frames.keyframe(row) : model.frames.point(row))!;
    }, [kind, row] as const);
  }

  /** Rows of points that are not in the part of the view that the panel leaves free. */
  async outside(): Promise<number[]> {
    return this.page.evaluate(() => {
      const { stage, model } = (globalThis as PageGlobals).slamdbView;
      const { camera } = stage;
      const rows = Array.from({ length: model.scene.points.count }, (_, row) => row);
      return rows.filter((row) => {
        const at = camera.project(model.frames.point(row));
        return !at || at.x < camera.inset || at.x > camera.width || at.y < 0 || at.y > camera.height;
      });
    });
  }

  async selection(): Promise<{ kind: string; row: number } | null> {
    return this.page.evaluate(() => (globalThis as PageGlobals).slamdbView.model.selection);
  }

  async pose(): Promise<{ azimuth: number; elevation: number; distance: number; target: number[]; plan: boolean }> {
    return this.page.evaluate(() => ({ ...(globalThis as PageGlobals).slamdbView.stage.camera.pose }));
  }

  async find(text: string): Promise<void> {
    await this.page.fill("#search", text);
    await this.page.press("#search", "Enter");
    await this.page.evaluate(() => (document.activeElement as HTMLElement).blur());
    await this.rest();
  }

  /** Ends the page; gives what it complained about. */
  async end(): Promise<string[]> {
    const violations = await this.page.evaluate(() => (globalThis as PageGlobals).violations);
    await this.context.close();
    // Reading pixels back for a picture is slow on purpose, and Chromium says so.
    return [...this.complaints.filter((text) => !/GPU stall due to ReadPixels|GL Driver Message/.test(text)), ...violations];
  }
}

/** One for all tests of a file; it ends with them. */
export function viewerForTests(): Viewer {
  const viewer = new Viewer();
  after(() => viewer.close());
  return viewer;
}

/** Ends the page, which must not have complained. */
export async function quietly(opened: Opened): Promise<void> {
  assert.deepEqual(await opened.end(), []);
}

export const near = (a: number, b: number, by: number): void => assert.ok(Math.abs(a - b) <= by, `${a} is not within ${by} of ${b}`);
export const isRed = ([r, g, b]: [number, number, number]): boolean => r > 170 && g < 110 && b < 110;
export const isPink = ([r, g, b]: [number, number, number]): boolean => r > 150 && g < 140 && b > 110 && r - g > 60;

// The page of `slamdb view`: reads the data that lies in it, and puts picture and controls together.

import { followModel, readAddress } from "./address";
import { DamagedData } from "./columns";
import { type Block, breathe, readScene } from "./data";
import { byId, h, refill } from "./dom";
import { NoWebGl } from "./gl";
import { buildInspector } from "./inspector";
import { listenToKeys } from "./keys";
import { Tape } from "./measure";
import { Model } from "./model";
import { buildPanel } from "./panel";
import { Pointer } from "./pointer";
import { buildScaleBar } from "./scale_bar";
import type { Scene } from "./scene";
import { type Drawing, Stage, openDrawing } from "./stage";
import { resolvedTheme } from "./theme";
import { buildTimeline } from "./timeline";
import { buildActions, buildToolbar } from "./toolbar";

function pageBlocks(): Block[] {
  return [...document.querySelectorAll<HTMLScriptElement>("script[data-name]")].map((element) => ({
    name: element.dataset.name ?? "",
    part: Number(element.dataset.part ?? 0),
    size: element.textContent?.length ?? 0,
    take: () => {
      const text = element.textContent ?? "";
      element.remove();
      return text;
    },
  }));
}

function showProgress(share: number, what: string): void {
  (byId("loading-bar") as HTMLProgressElement).value = share;
  byId("loading-text").textContent = what;
}

function fail(error: unknown): void {
  byId("loading").hidden = true;
  const known = error instanceof DamagedData || error instanceof NoWebGl;
  const text = error instanceof Error ? error.message : String(error);
  refill(byId("failure"), h("div", {}, h("h1", {}, "The map cannot be shown"), h("p", {}, text),
    h("p", { class: "quiet" }, error instanceof DamagedData ? "Make the page anew with slamdb view, or copy it again from where it came from." : "")));
  byId("failure").hidden = false;
  document.documentElement.dataset.state = "failed";
  if (!known) console.error(error);
}

let noticeTimer = 0;
function notice(text: string): void {
  const place = byId("notice");
  place.textContent = text;
  place.hidden = text === "";
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => (place.hidden = true), 6000) as unknown as number;
}

function assemble(drawing: Drawing, scene: Scene): { model: Model; stage: Stage; start: () => void } {
  const model = new Model(scene);
  const pose = readAddress(model, location.hash);
  const stage = new Stage(drawing, model);
  const motion = matchMedia("(prefers-reduced-motion: reduce)");
  stage.camera.calm = motion.matches;
  motion.addEventListener("change", () => (stage.camera.calm = motion.matches));
  stage.onLost = () => fail(new NoWebGl("The graphics card was taken from the page. Reload it to see the map again."));
  const themed = (): void => {
    document.documentElement.dataset.theme = resolvedTheme(model.settings.theme);
  };
  themed();
  model.on(["theme"], themed);
  return { model, stage, start: () => start(model, stage, pose) };
}

function start(model: Model, stage: Stage, pose: typeof stage.camera.pose | null): void {
  const tape = new Tape(model, stage, notice);
  const scaleBar = buildScaleBar(model, stage);
  stage.onFrame = () => {
    scaleBar();
    tape.place();
  };
  const fit = (): void => {
    const inset = panel.inset();
    document.documentElement.style.setProperty("--inset", `${inset}px`);
    stage.resize(innerWidth, innerHeight, inset);
  };
  const panel = buildPanel(model, stage, fit);
  const actions = buildActions(model, stage, tape, notice);
  buildToolbar(model, stage, tape, actions);
  buildInspector(model, stage);
  const timeline = buildTimeline(model, stage);
  listenToKeys({ model, stage, tape, timeline, actions, togglePanel: panel.toggle });
  new Pointer(model, stage, tape);
  addEventListener("resize", fit);
  fit();
  stage.camera.pose = pose ?? stage.home();
  model.changed("camera");
  followModel(model, () => stage.camera.pose);
}

async function main(): Promise<void> {
  document.documentElement.dataset.theme = resolvedTheme("auto");
  const drawing = openDrawing(byId("view") as HTMLCanvasElement);
  const scene = await readScene(pageBlocks(), showProgress);

  const { model, stage, start } = assemble(drawing, scene);
  await stage.upload(breathe);

  start();
  byId("loading").hidden = true;
  stage.request();
  // For tests, and for whoever looks under the bonnet.
  Object.assign(globalThis, { slamdbView: { model, stage } });
  requestAnimationFrame(() => {
    document.documentElement.dataset.openMs = String(Math.round(performance.now()));
    document.documentElement.dataset.state = "ready";
  });
}

main().catch(fail);

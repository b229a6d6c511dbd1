// The panel at the left: title, search, and sections that fold.

import { buildColour } from "./panel_colour";
import { buildDifferences } from "./panel_diff";
import { buildFindingsSection } from "./panel_findings";
import { buildLayers } from "./panel_layers";
import { buildMaps } from "./panel_maps";
import { buildStatistics } from "./panel_statistics";
import { summary } from "./describe";
import { byId, h, iconButton, refill } from "./dom";
import type { Model } from "./model";
import { buildSearch } from "./search";
import type { Stage } from "./stage";

export interface Panel {
  toggle: () => void;
  inset: () => number;
}

export function buildPanel(model: Model, stage: Stage, resized: () => void): Panel {
  const panel = byId("panel");
  const { header } = model.scene;
  const toggle = (): void => {
    const folded = panel.classList.toggle("folded");
    fold.setAttribute("aria-expanded", String(!folded));
    resized();
  };
  const fold = iconButton("panel", "Controls", toggle, { "aria-expanded": "true", "aria-keyshortcuts": "H" });
  const narrow = matchMedia("(max-width: 720px)");
  if (narrow.matches) {
    panel.classList.add("folded");
    fold.setAttribute("aria-expanded", "false");
  }
  const leftOut = h("div", { class: "left-out" }, ...header.left_out.map((text) => h("p", {}, text)), h("p", {}, header.generator));
  refill(
    panel,
    h("header", {}, h("div", {}, h("h1", { title: header.title }, header.title), h("p", { class: "sub", id: "summary" }, summary(model.scene))), fold),
    buildSearch(model, stage),
    h("div", { class: "scroll", tabindex: "-1" },
      buildColour(model, stage), buildDifferences(model, stage), buildLayers(model), buildFindingsSection(model, stage), buildMaps(model),
      buildStatistics(model), leftOut),
  );
  panel.hidden = false;
  return {
    toggle,
    inset: () => (narrow.matches || panel.classList.contains("folded") ? 0 : panel.getBoundingClientRect().right),
  };
}

// What `check` found, as a list to step through; each in its place.

import { announce, button, h, iconButton, refill, section } from "./dom";
import { grouped } from "./format";
import { findingPlace } from "./highlights";
import type { Model } from "./model";
import type { Finding } from "./scene";
import type { Stage } from "./stage";

const kListed = 200;

export function buildFindingsSection(model: Model, stage: Stage): HTMLElement | null {
  const findings = model.scene.header.findings ?? [];
  const leftOut = model.scene.header.findings_left_out ?? 0;
  if (findings.length === 0) return null;
  const at = h("span", { class: "at", "aria-live": "polite" });
  const list = h("ol", { class: "findings", "aria-label": "Findings" });
  let page = -1;
  const refresh = (): void => {
    const total = grouped(findings.length);
    at.textContent = model.finding < 0 ? total : `${grouped(model.finding + 1)} of ${total}`;
    const wanted = Math.floor(Math.max(0, model.finding) / kListed);
    if (wanted !== page) {
      page = wanted;
      fill(list, findings, page, (index) => visitFinding(model, stage, index));
    }
    list.querySelectorAll("button").forEach((item, i) => item.setAttribute("aria-pressed", String(page * kListed + i === model.finding)));
    const current = list.querySelector<HTMLElement>('[aria-pressed="true"]');
    if (current) list.scrollTop = current.offsetTop - list.offsetTop - list.clientHeight / 3;
  };
  model.on(["finding"], refresh);
  refresh();
  const steps = h("div", { class: "steps" },
    iconButton("back", "Finding before", () => stepFinding(model, stage, -1), { class: "icon small", "aria-keyshortcuts": "Shift+N" }), at,
    iconButton("forward", "Next finding", () => stepFinding(model, stage, 1), { class: "icon small", "aria-keyshortcuts": "N" }));
  return section(`Findings (${grouped(findings.length + leftOut)})`, true, steps, list,
    leftOut > 0 ? h("p", { class: "quiet" }, `${grouped(leftOut)} more are not in the page: slamdb check lists all.`) : null);
}

function fill(list: HTMLElement, findings: Finding[], page: number, visit: (index: number) => void): void {
  const first = page * kListed;
  refill(list, ...findings.slice(first, first + kListed).map((finding, i) => {
    const item = button(h("span", { class: "rule" }, finding.rule), () => visit(first + i));
    item.append(finding.text);
    return h("li", { class: finding.severity }, item);
  }));
}

export function stepFinding(model: Model, stage: Stage, by: number): void {
  const count = model.scene.header.findings?.length ?? 0;
  if (count > 0) visitFinding(model, stage, (model.finding + by + count + (model.finding < 0 && by < 0 ? 1 : 0)) % count);
}

function visitFinding(model: Model, stage: Stage, index: number): void {
  const finding = model.scene.header.findings![index];
  model.finding = index;
  model.changed("finding");
  announce(`${finding.rule}: ${finding.text}`);
  const place = findingPlace(model, index);
  if (!place) return;
  if (finding.kind === "point" || finding.kind === "keyframe") model.select({ kind: finding.kind, row: finding.row });
  stage.flyNear(place, Math.max(stage.frustumDepth * 9, 1e-3));
}

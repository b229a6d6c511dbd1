// What `check` found, by rule: what holds in a sound map, what comes of it where it does not, and where; to step through.

import { announce, button, h, iconButton, refill, section } from "./dom";
import { counted, grouped } from "./format";
import { findingPlace, hasPlace } from "./highlights";
import type { Model } from "./model";
import type { HeaderRule } from "./scene";
import type { Stage } from "./stage";

const kListed = 200;

export function buildFindingsSection(model: Model, stage: Stage): HTMLElement | null {
  const { findings, findings_left_out: leftOut, rules } = model.scene.header;
  if (findings.length === 0) return null;
  const at = h("span", { class: "at", "aria-live": "polite" });
  const lists = rules.map((rule) => buildRule(model, stage, rule));
  const refresh = (): void => {
    const total = grouped(findings.length);
    at.textContent = model.finding < 0 ? total : `${grouped(model.finding + 1)} of ${total}`;
    for (const list of lists) list.follow(model.finding);
  };
  model.on(["finding"], refresh);
  refresh();
  lists[0].element.open = true;
  const steps = h("div", { class: "steps" },
    iconButton("back", "Finding before", () => stepFinding(model, stage, -1), { class: "icon small", "aria-keyshortcuts": "Shift+N" }), at,
    iconButton("forward", "Next finding", () => stepFinding(model, stage, 1), { class: "icon small", "aria-keyshortcuts": "N" }));
  return section(`Findings (${grouped(findings.length + leftOut)})`, true, steps,
    h("p", { class: "quiet" }, `${grouped(findings.filter((finding) => hasPlace(model.scene, finding)).length)} of ${grouped(findings.length)} have a place in the picture.`),
    leftOut > 0 ? h("p", { class: "quiet" }, `${grouped(leftOut)} more are not in the page: slamdb check lists all.`) : null,
    h("div", { class: "findings" }, ...lists.map((list) => list.element)));
}

interface RuleList {
  element: HTMLDetailsElement;
  follow: (finding: number) => void; // the finding that is looked at, of whatever rule
}

/** Findings of one rule, which follow each other in the header. Of very many a page is listed: that of the one looked at. */
function buildRule(model: Model, stage: Stage, rule: HeaderRule): RuleList {
  const { findings } = model.scene.header;
  const first = Math.max(0, findings.findIndex((finding) => finding.rule === rule.id));
  const end = first + findings.filter((finding) => finding.rule === rule.id).length;
  const list = h("ol", { "aria-label": `Findings of ${rule.id}` });
  const rest = h("p", { class: "quiet" });
  const element = h("details", { class: `rule ${rule.severity}` },
    h("summary", {}, h("span", { class: "name" }, rule.id), h("span", { class: "count" }, counted(rule.count, rule.severity))),
    h("p", { class: "quiet" }, rule.consequence ? `In a sound atlas ${rule.title}. Here ORB-SLAM3 ${rule.consequence}.` : rule.title), list, rest);
  let begin = -1;
  const follow = (finding: number): void => {
    const mine = finding >= first && finding < end;
    const wanted = mine ? finding - ((finding - first) % kListed) : Math.max(begin, first);
    if (wanted !== begin) {
      begin = wanted;
      const last = Math.min(begin + kListed, end);
      refill(list, ...findings.slice(begin, last).map(({ place, text }, i) => {
        const item = button(h("span", { class: "place" }, `${place}:`), () => visitFinding(model, stage, begin + i));
        item.append(` ${text}`);
        return h("li", {}, item);
      }));
      rest.textContent = last - begin < end - first ? `${grouped(begin - first + 1)} to ${grouped(last - first)} of ${grouped(end - first)}; stepping goes on.` : "";
    }
    list.querySelectorAll("button").forEach((item, i) => item.setAttribute("aria-pressed", String(begin + i === finding)));
    if (!mine) return;
    element.open = true;
    list.querySelector('[aria-pressed="true"]')?.scrollIntoView({ block: "nearest" });
  };
  return { element, follow };
}

export function stepFinding(model: Model, stage: Stage, by: number): void {
  const count = model.scene.header.findings.length;
  if (count > 0) visitFinding(model, stage, (model.finding + by + count + (model.finding < 0 && by < 0 ? 1 : 0)) % count);
}

function visitFinding(model: Model, stage: Stage, index: number): void {
  const finding = model.scene.header.findings[index];
  model.finding = index;
  model.changed("finding");
  announce(`${finding.rule}: ${finding.place}: ${finding.text}`);
  if ((finding.kind === "point" || finding.kind === "keyframe") && finding.row >= 0) model.select({ kind: finding.kind, row: finding.row });
  const place = findingPlace(model, index);
  if (place) stage.flyNear(place, Math.max(stage.frustumDepth * 9, 1e-3));
}

// The keyboard: every key in one table, which is also what the help shows.

import { kColourModes } from "./colours";
import { byId, h, iconButton, refill } from "./dom";
import { visit } from "./describe";
import type { Tape } from "./measure";
import type { Model } from "./model";
import { stepFinding } from "./panel_findings";
import { layerRows } from "./panel_layers";
import type { Stage } from "./stage";
import type { Timeline } from "./timeline";
import { type Actions, toggleHelp } from "./toolbar";

interface Key {
  keys: string[]; // as KeyboardEvent.key
  label: string;
  does: string;
  run: (event: KeyboardEvent) => void;
}

export interface Keyboard {
  model: Model;
  stage: Stage;
  tape: Tape;
  timeline: Timeline;
  actions: Actions;
  togglePanel: () => void;
}

const kArrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function keyTable({ model, stage, tape, timeline, actions, togglePanel }: Keyboard): Key[] {
  const move = (run: () => void): void => {
    run();
    stage.moved();
  };
  const stepKeyframe = (by: number): void => {
    const { byTime, rank, count } = model.scene.keyframes;
    if (count === 0) return;
    const at = model.selection?.kind === "keyframe" ? rank[model.selection.row] + by : by > 0 ? 0 : count - 1;
    visit(model, stage, { kind: "keyframe", row: byTime[(at + count) % count] });
  };
  const escape = (): void => {
    if (tape.active) tape.toggle();
    else if (model.finding >= 0 || model.selection) {
      model.finding = -1;
      model.select(null);
      model.changed("finding");
    }
  };
  const nextColour = (): void => {
    const modes = kColourModes.map(({ mode }) => mode).filter((mode) => mode !== "status" || model.scene.header.diff);
    model.setColour(modes[(modes.indexOf(model.settings.colour) + 1) % modes.length]);
  };
  const layer = (event: KeyboardEvent): void => {
    const row = layerRows(model)[Number(event.key) - 1];
    if (row) model.setLayer(row.layer, !model.settings.layers[row.layer]);
  };
  return [
    { keys: Object.keys(kArrows), label: "\u2190 \u2191 \u2192 \u2193", does: "Turn; with Shift, move", run: (event) => move(() => {
      const [x, y] = kArrows[event.key];
      if (event.shiftKey || (stage.camera.pose.plan && y !== 0)) stage.camera.pan(-x * 40, -y * 40);
      else stage.camera.orbit(-x * 16, -y * 16);
    }) },
    { keys: ["+", "="], label: "+", does: "Nearer", run: () => move(() => stage.camera.zoom(0.85)) },
    { keys: ["-", "_"], label: "\u2212", does: "Farther", run: () => move(() => stage.camera.zoom(1 / 0.85)) },
    { keys: ["f", "F"], label: "F", does: "Show all", run: actions.fit },
    { keys: ["p", "P"], label: "P", does: "Plan view and back", run: actions.plan },
    { keys: ["Enter"], label: "Enter", does: "Fly to the selection", run: () => model.selection && visit(model, stage, model.selection) },
    { keys: ["/"], label: "/", does: "Find by id", run: () => byId("search").focus() },
    { keys: ["]"], label: "]", does: "Next keyframe in time", run: () => stepKeyframe(1) },
    { keys: ["["], label: "[", does: "Keyframe before", run: () => stepKeyframe(-1) },
    { keys: ["n"], label: "N", does: "Next finding", run: () => stepFinding(model, stage, 1) },
    { keys: ["N"], label: "Shift N", does: "Finding before", run: () => stepFinding(model, stage, -1) },
    { keys: [" "], label: "Space", does: "Play or pause the growth", run: timeline.toggle },
    { keys: ["c", "C"], label: "C", does: "Next colouring", run: nextColour },
    { keys: [..."123456789"], label: "1 \u2026 9", does: "Layers on and off", run: layer },
    { keys: ["m", "M"], label: "M", does: "Measuring tape", run: actions.measure },
    { keys: ["s", "S"], label: "S", does: "Save a picture", run: actions.picture },
    { keys: ["t", "T"], label: "T", does: "Light or dark", run: actions.theme },
    { keys: ["h", "H"], label: "H", does: "Fold the controls", run: togglePanel },
    { keys: ["Escape"], label: "Esc", does: "End measuring; select nothing", run: escape },
    { keys: ["?"], label: "?", does: "This help", run: toggleHelp },
  ];
}

const kGestures: [string, string][] = [
  ["Drag", "Turn; in the plan, move"], ["Right drag", "Move; in the plan, turn"], ["Shift drag", "Move"], ["Wheel", "Nearer and farther"],
  ["Click", "Select a point or a keyframe"], ["Double click", "Fly there"], ["One finger", "Turn"], ["Two fingers", "Move and zoom"],
];

export function listenToKeys(keyboard: Keyboard): void {
  const table = keyTable(keyboard);
  const byKey = new Map(table.flatMap((key) => key.keys.map((name) => [name, key] as const)));
  buildHelp(table);
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || (byId("help") as HTMLDialogElement).open) return;
    const key = byKey.get(event.key);
    if (!key) return;
    const typing = target.matches("input:not([type=checkbox]), select, textarea");
    if (event.key === "Escape" && typing) return keyboard.stage.canvas.focus();
    // Keys that the focused control needs for itself stay with it.
    const own = target.matches("button, summary, input") && (event.key === " " || event.key === "Enter");
    const scrolls = target !== keyboard.stage.canvas && target !== document.body && event.key in kArrows;
    if (typing || own || scrolls) return;
    event.preventDefault();
    key.run(event);
  });
}

function buildHelp(table: Key[]): void {
  const dialog = byId("help") as HTMLDialogElement;
  const list = (entries: [string, string][]): HTMLElement =>
    h("dl", {}, ...entries.flatMap(([label, does]) => [h("dt", {}, h("kbd", {}, label)), h("dd", {}, does)]));
  const keys = table.map(({ label, does }): [string, string] => [label, does]);
  const half = Math.ceil((keys.length + kGestures.length) / 2);
  refill(dialog,
    h("header", {}, h("h1", {}, "Keys and gestures"), iconButton("close", "Close", toggleHelp)),
    h("div", { class: "columns" }, list(keys.slice(0, half)), list(keys.slice(half)), list(kGestures)),
    h("p", { class: "quiet" }, "The address of the page holds what is seen: copy it to come back to it."));
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
}


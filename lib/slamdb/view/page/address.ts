// What is seen, in the part of the page's address behind #: it can be kept and sent on. Unknown and broken parts are passed over.

import type { CameraPose } from "./camera";
import { type ColourMode, kColourModes } from "./colours";
import type { Arrangement } from "./frames";
import { type Model, kLayers } from "./model";

const kArrangements: Arrangement[] = ["own", "atlases", "maps"];
const short = (value: number): string => String(Number(value.toPrecision(6)));

export function writeAddress(model: Model, pose: CameraPose): string {
  const { settings, selection, frames, scene } = model;
  const parts: [string, string][] = [
    ["c", [pose.azimuth, pose.elevation, pose.distance, ...pose.target, pose.aside].map(short).join(",") + (pose.plan ? ",plan" : "")],
    ["m", settings.colour],
    ["l", kLayers.map((layer) => (settings.layers[layer] ? "1" : "0")).join("")],
  ];
  if (selection) parts.push(["s", `${selection.kind === "keyframe" ? "kf" : "mp"}${selection.row}`]);
  if (settings.time < scene.keyframes.count) parts.push(["t", String(Math.round(settings.time))]);
  if (settings.theme !== "auto") parts.push(["th", settings.theme]);
  if (scene.maps.length > 1) parts.push(["a", frames.arrangement]);
  const hidden = frames.visible.flatMap((visible, index) => (visible ? [] : [index]));
  if (hidden.length > 0) parts.push(["h", hidden.join(",")]);
  const moved = frames.offsets.flatMap((offset, index) => (offset.some((value) => value !== 0) ? [`${index}:${offset.map(short).join(":")}`] : []));
  if (moved.length > 0) parts.push(["o", moved.join(",")]);
  if (scene.header.diff && settings.statuses !== 0b11111) parts.push(["d", String(settings.statuses)]);
  if (settings.pointSize !== 1) parts.push(["ps", short(settings.pointSize)]);
  if (settings.frustumSize !== 1) parts.push(["fs", short(settings.frustumSize)]);
  return parts.map(([name, value]) => `${name}=${value}`).join("&");
}

/** Sets the model as the address says; gives the camera's pose, where one is said. */
export function readAddress(model: Model, hash: string): CameraPose | null {
  const values = new Map(hash.replace(/^#/, "").split("&").map((part) => {
    const at = part.indexOf("=");
    return [part.slice(0, at), part.slice(at + 1)] as const;
  }));
  const { settings, frames, scene } = model;
  const whole = (name: string, limit: number): number | null => {
    const text = values.get(name);
    return text !== undefined && /^\d+$/.test(text) && Number(text) <= limit ? Number(text) : null;
  };
  const within = (name: string, low: number, high: number, set: (value: number) => void): void => {
    const value = Number(values.get(name));
    if (values.has(name) && value >= low && value <= high) set(value);
  };
  const mode = values.get("m") as ColourMode;
  if (kColourModes.some((known) => known.mode === mode) && (mode !== "status" || scene.header.diff)) settings.colour = mode;
  const layers = values.get("l");
  if (layers && /^[01]+$/.test(layers) && layers.length === kLayers.length) kLayers.forEach((layer, i) => (settings.layers[layer] = layers[i] === "1"));
  const theme = values.get("th");
  if (theme === "light" || theme === "dark") settings.theme = theme;
  const arrangement = values.get("a") as Arrangement;
  if (kArrangements.includes(arrangement)) frames.arrangement = arrangement;
  settings.time = whole("t", scene.keyframes.count) ?? settings.time;
  settings.statuses = whole("d", 0b11111) ?? settings.statuses;
  within("ps", 0.4, 3, (value) => (settings.pointSize = value));
  within("fs", 0.2, 5, (value) => (settings.frustumSize = value));
  for (const index of (values.get("h") ?? "").split(",")) {
    if (/^\d+$/.test(index) && Number(index) < frames.visible.length) frames.visible[Number(index)] = false;
  }
  for (const text of (values.get("o") ?? "").split(",")) {
    const [index, ...offset] = text.split(":").map(Number);
    if (offset.length === 4 && offset.every(Number.isFinite) && frames.offsets[index]) offset.forEach((value, i) => (frames.offsets[index][i] = value));
  }
  frames.update();
  const selected = /^(kf|mp)(\d+)$/.exec(values.get("s") ?? "");
  if (selected) {
    const kind = selected[1] === "kf" ? "keyframe" : "point";
    const row = Number(selected[2]);
    if (row < (kind === "keyframe" ? scene.keyframes.count : scene.points.count)) model.selection = { kind, row };
  }
  return readPose(values.get("c") ?? "");
}

function readPose(text: string): CameraPose | null {
  const parts = text.split(",");
  const numbers = parts.slice(0, 7).map(Number);
  if (numbers.length !== 7 || !numbers.every(Number.isFinite) || !(numbers[2] > 0)) return null;
  const [azimuth, elevation, distance, x, y, z, aside] = numbers;
  return { azimuth, elevation, distance, target: [x, y, z], aside, plan: parts[7] === "plan" };
}

/** Follows the model: the address is written when things rest. */
export function followModel(model: Model, pose: () => CameraPose): void {
  let timer = 0;
  model.on(["layers", "colour", "theme", "frames", "selection", "time", "size", "camera"], () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      try {
        history.replaceState(null, "", `#${writeAddress(model, pose())}`);
      } catch {
        // Some browsers forbid it to pages from files: then the address stays as it is.
      }
    }, 350) as unknown as number;
  });
}

// What points are coloured by: a mode gives each point a byte, the theme gives each byte a colour.
// Scales are perceptual and colour-blind-safe (viridis and inferno by Smith, van der Walt and Firing; categories after Okabe
// and Ito, Color Universal Design), cut at the end that would vanish in the background.

import { quantile, rotate } from "./maths";
import { type Scene, birthOf, errorOf, isHiddenPoint, kStatusNames, mapTitle, originLabel, placePoint } from "./scene";
import type { Frames } from "./frames";

export type Rgb = [number, number, number]; // 0 .. 255
export type ColourMode = "map" | "origin" | "observers" | "error" | "height" | "age" | "status" | "plain";
export type Theme = "dark" | "light";

export const kColourModes: { mode: ColourMode; label: string }[] = [
  { mode: "map", label: "Map" },
  { mode: "origin", label: "Origin map" },
  { mode: "observers", label: "Observers" },
  { mode: "error", label: "Reprojection error" },
  { mode: "height", label: "Height" },
  { mode: "age", label: "Age" },
  { mode: "status", label: "Difference" },
  { mode: "plain", label: "One colour" },
];

const kViridis: Rgb[] = [
  [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140], [34, 168, 132], [68, 191, 112],
  [122, 209, 81], [189, 223, 38], [253, 231, 37],
];
const kInferno: Rgb[] = [
  [0, 0, 4], [22, 11, 57], [66, 10, 104], [106, 23, 110], [147, 38, 103], [188, 55, 84], [221, 81, 58], [243, 120, 25],
  [252, 165, 10], [246, 215, 70], [252, 255, 164],
];
const kCategories: Record<Theme, Rgb[]> = {
  dark: [[86, 180, 233], [230, 159, 0], [0, 190, 140], [225, 145, 190], [240, 228, 66], [120, 150, 255], [235, 110, 50], [190, 190, 190]],
  light: [[0, 105, 170], [190, 110, 0], [0, 130, 95], [170, 70, 125], [125, 115, 0], [70, 75, 190], [185, 70, 0], [95, 95, 95]],
};
/** By Status: unchanged, added, removed, moved, changed. */
const kStatus: Record<Theme, Rgb[]> = {
  dark: [[120, 128, 140], [0, 200, 150], [240, 105, 50], [95, 175, 245], [240, 220, 80]],
  light: [[150, 156, 166], [0, 130, 95], [200, 75, 0], [0, 100, 180], [140, 120, 0]],
};

/** The shade of what belongs to no category. */
const kNoCategory = 255;

/** Behind those that are told apart best, hues that lie as far from each other as they can, in two lightnesses. */
export function category(index: number, theme: Theme): Rgb {
  const chosen = kCategories[theme];
  if (index === kNoCategory) return chosen[chosen.length - 1];
  if (index < chosen.length) return chosen[index];
  const more = index - chosen.length;
  const lightness = theme === "dark" ? [0.8, 0.55] : [0.22, 0.4];
  return fromHue((more * 137.508 + 205) % 360, 0.75, lightness[more % 2]);
}

/** HSL: hue in degrees, the others in 0 .. 1. */
function fromHue(hue: number, saturation: number, lightness: number): Rgb {
  const reach = saturation * Math.min(lightness, 1 - lightness);
  return [0, 8, 4].map((n) => {
    const k = (n + hue / 30) % 12;
    return 255 * (lightness - reach * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
  }) as Rgb;
}

export const statusColour = (status: number, theme: Theme): Rgb => kStatus[theme][status] ?? kStatus[theme][0];
export const css = (colour: Rgb): string => `rgb(${colour.map(Math.round).join(",")})`;

/** A scale at t in 0 .. 1. */
export function sample(scale: Rgb[], t: number): Rgb {
  const at = Math.min(Math.max(t, 0), 1) * (scale.length - 1);
  const low = Math.min(Math.floor(at), scale.length - 2);
  return [0, 1, 2].map((c) => scale[low][c] + (scale[low + 1][c] - scale[low][c]) * (at - low)) as Rgb;
}

const kSpan: Record<Theme, [number, number]> = { dark: [0.2, 1], light: [0, 0.82] };

export function scaleColour(mode: ColourMode, t: number, theme: Theme): Rgb {
  const [low, high] = mode === "error" && theme === "dark" ? [0.32, 1] : kSpan[theme];
  return sample(mode === "error" ? kInferno : kViridis, low + (high - low) * t);
}

/** What stands beside the colours: a scale with its ends, or names. */
export type Legend =
  | { kind: "scale"; low: string; middle: string; high: string; note: string }
  | { kind: "names"; entries: { colour: Rgb; label: string }[] };

export interface Shading {
  mode: ColourMode;
  shades: Uint8Array; // a byte a point
  categories: boolean; // shades are numbers of categories
  low: number;
  high: number;
}

const kSampled = 20000;

/** A value of up to 20,000 points, evenly taken, sorted; for ends of scales that strangers do not stretch. */
export function sampledValues(scene: Scene, value: (row: number) => number | null): Float64Array {
  const step = Math.max(1, Math.floor(scene.points.count / kSampled));
  const values: number[] = [];
  for (let row = 0; row < scene.points.count; row += step) {
    const v = isHiddenPoint(scene, row) ? null : value(row);
    if (v !== null && Number.isFinite(v)) values.push(v);
  }
  return Float64Array.from(values).sort();
}

export function shade(scene: Scene, frames: Frames, mode: ColourMode): Shading {
  const { points, keyframes } = scene;
  const shades = new Uint8Array(points.count);
  const result = (categories: boolean, low = 0, high = 0): Shading => ({ mode, shades, categories, low, high });
  switch (mode) {
    case "map":
      for (const map of scene.maps) shades.fill(map.index % 256, map.first_point, map.first_point + map.points);
      return result(true);
    case "origin": {
      const number = originNumbers(scene);
      for (let row = 0; row < points.count; ++row) {
        const keyframe = points.reference[row];
        shades[row] = keyframe < 0 ? kNoCategory : (number.get(keyframes.origin[keyframe]) ?? 0) % kNoCategory;
      }
      return result(true);
    }
    case "status":
      if (points.status) shades.set(points.status);
      return result(true);
    case "plain":
      return result(true);
    case "observers": {
      const high = Math.max(3, quantile(sampledValues(scene, (row) => points.observers[row]), 0.98));
      const byte = 255 / Math.log(high);
      for (let row = 0; row < points.count; ++row) shades[row] = Math.min(255, Math.log(Math.max(1, points.observers[row])) * byte);
      return result(false, 1, high);
    }
    case "error": {
      const high = quantile(sampledValues(scene, (row) => errorOf(scene, row)), 0.95) || 1;
      const byte = Array.from({ length: 256 }, (_, v) => Math.min(255, v === 0 ? 0 : (scene.header.error_max * ((v - 1) / 254) ** 2 * 255) / high));
      for (let row = 0; row < points.count; ++row) shades[row] = byte[points.error[row]];
      return result(false, 0, high);
    }
    case "age": {
      const byte = 255 / Math.max(1, birthOf(keyframes.count - 1, keyframes.count));
      for (let row = 0; row < points.count; ++row) shades[row] = points.birth[row] * byte;
      return result(false, 0, keyframes.count);
    }
    case "height":
      return shadeHeight(scene, frames, shades);
  }
}

function shadeHeight(scene: Scene, frames: Frames, shades: Uint8Array): Shading {
  const sampled = sampledValues(scene, (row) => frames.pointHeight(row));
  const low = quantile(sampled, 0.02);
  const high = Math.max(quantile(sampled, 0.98), low + 1e-9);
  for (const map of scene.maps) {
    // The third row of the turn: what of x, y and z goes up.
    const { rotation, translation } = frames.own[map.index];
    const up = [rotate(rotation, [1, 0, 0])[2], rotate(rotation, [0, 1, 0])[2], rotate(rotation, [0, 0, 1])[2]];
    const place = new Float64Array(3);
    for (let row = map.first_point, end = row + map.points; row < end; ++row) {
      placePoint(scene, map, row, place, 0);
      const height = translation[2] + up[0] * place[0] + up[1] * place[1] + up[2] * place[2];
      shades[row] = Math.min(255, Math.max(0, (255 * (height - low)) / (high - low)));
    }
  }
  return { mode: "height", shades, categories: false, low, high };
}

/** Origin maps of the scene in ascending order, numbered. */
export function originNumbers(scene: Scene): Map<number, number> {
  const ids = [...new Set(scene.keyframes.origin)].sort((a, b) => a - b);
  return new Map(ids.map((id, index) => [id, index]));
}

/** 256 colours of the shades, as RGBA bytes. */
export function palette(shading: Shading, theme: Theme, plain: Rgb): Uint8Array {
  const bytes = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) {
    let colour = plain;
    if (shading.mode === "status") colour = statusColour(i, theme);
    else if (shading.mode !== "plain") colour = shading.categories ? category(i, theme) : scaleColour(shading.mode, i / 255, theme);
    bytes.set([...colour.map(Math.round), 255], i * 4);
  }
  return bytes;
}

export function legend(scene: Scene, shading: Shading, theme: Theme, plain: Rgb, text: (value: number) => string): Legend {
  const { low, high } = shading;
  switch (shading.mode) {
    case "map":
      return { kind: "names", entries: scene.maps.map((map) => ({ colour: category(map.index, theme), label: mapTitle(scene, map) })) };
    case "origin": {
      const entries = [...originNumbers(scene)].map(([id, index]) => ({ colour: category(index, theme), label: originLabel(scene, id) }));
      return { kind: "names", entries };
    }
    case "status":
      return { kind: "names", entries: kStatusNames.map((label, status) => ({ colour: statusColour(status, theme), label })) };
    case "plain":
      return { kind: "names", entries: [{ colour: plain, label: "points" }] };
    case "observers":
      return { kind: "scale", low: "1", middle: String(Math.round(Math.sqrt(high))), high: `${Math.round(high)}+`, note: "keyframes that see the point" };
    case "error":
      return { kind: "scale", low: "0", middle: (high / 2).toFixed(1), high: `${high.toFixed(1)}+ px`, note: "mean reprojection error" };
    case "age":
      return { kind: "scale", low: "first", middle: "", high: "last", note: "keyframe that first saw the point" };
    case "height":
      return { kind: "scale", low: text(low), middle: "", high: text(high), note: "along the map\u2019s up" };
  }
}

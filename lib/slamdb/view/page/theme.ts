// Colours of what is drawn, in the dark and in the light; those of the panel are in page.css.

import type { Rgb, Theme } from "./colours";

export interface Paint {
  background: Rgb;
  plain: Rgb; // points without a scale
  trajectory: Rgb;
  frusta: Rgb;
  covisibility: Rgb;
  tree: Rgb;
  loops: Rgb;
  merges: Rgb;
  selection: Rgb;
  finding: Rgb;
  grid: Rgb;
  tape: Rgb;
  glow: Rgb; // what the timeline has just brought
}

export const kPaint: Record<Theme, Paint> = {
  dark: {
    background: [17, 20, 25], plain: [150, 172, 200], trajectory: [250, 244, 230], frusta: [150, 168, 196],
    covisibility: [96, 150, 205], tree: [125, 205, 140], loops: [255, 186, 70], merges: [190, 150, 255],
    selection: [255, 110, 205], finding: [255, 77, 77], grid: [120, 132, 150], tape: [255, 225, 120], glow: [255, 255, 255],
  },
  light: {
    background: [247, 248, 250], plain: [70, 92, 125], trajectory: [28, 32, 40], frusta: [72, 88, 115],
    covisibility: [40, 105, 170], tree: [30, 125, 60], loops: [190, 105, 0], merges: [110, 60, 190],
    selection: [200, 0, 140], finding: [215, 20, 20], grid: [110, 120, 136], tape: [150, 95, 0], glow: [0, 0, 0],
  },
};

export function resolvedTheme(asked: "auto" | Theme): Theme {
  if (asked !== "auto") return asked;
  return matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
}

export const unit = (colour: Rgb): [number, number, number] => [colour[0] / 255, colour[1] / 255, colour[2] / 255];

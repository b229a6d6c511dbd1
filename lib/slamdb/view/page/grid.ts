// The metric grid at the foot of the scene, and the length of its cells.

import type { Rgb } from "./colours";
import { roundStep } from "./format";
import type { Bounds } from "./frames";
import { clamp } from "./maths";
import { Lines } from "./shapes";

const kMostCells = 60;

/** Cells of 1, 2 or 5 times a power of ten, about 80 pixels wide. */
export const gridStep = (unitsPerPixel: number): number => roundStep(unitsPerPixel * 110);

/** Around `bounds`, at its foot; every fifth line is stronger, and all fade towards the border. */
export function buildGrid(bounds: Bounds, step: number, colour: Rgb): Lines {
  const lines = new Lines();
  const { low, high } = bounds;
  const reach = Math.max(high[0] - low[0], high[1] - low[1]) * 0.25 + step;
  const cell = Math.max(step, roundStep((Math.max(high[0] - low[0], high[1] - low[1]) + 2 * reach) / kMostCells) * 2);
  const used = cell > step * 2.1 ? cell : step;
  const first = [0, 1].map((axis) => Math.floor((low[axis] - reach) / used));
  const last = [0, 1].map((axis) => Math.ceil((high[axis] + reach) / used));
  for (const axis of [0, 1]) {
    const other = 1 - axis;
    for (let i = first[axis]; i <= last[axis]; ++i) {
      const middle = (first[axis] + last[axis]) / 2;
      const side = clamp(1.15 - Math.abs(i - middle) / ((last[axis] - first[axis]) / 2), 0, 1);
      const strength = (i % 5 === 0 ? 0.34 : 0.16) * side;
      for (let j = first[other]; j < last[other]; ++j) {
        const along = clamp(1.15 - Math.abs(j + 0.5 - (first[other] + last[other]) / 2) / ((last[other] - first[other]) / 2), 0, 1);
        if (strength * along < 0.015) continue;
        const a: [number, number, number] = [0, 0, low[2]];
        const b: [number, number, number] = [0, 0, low[2]];
        a[axis] = b[axis] = i * used;
        a[other] = j * used;
        b[other] = (j + 1) * used;
        lines.add(a, b, colour, strength * along);
      }
    }
  }
  return lines;
}

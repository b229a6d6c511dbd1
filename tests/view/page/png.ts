// Pixels of a PNG as browsers write it: 8 bits, RGB or RGBA, not interlaced.

import { inflateSync } from "node:zlib";

export interface Picture {
  width: number;
  height: number;
  at: (x: number, y: number) => [number, number, number];
}

export function readPng(file: Buffer): Picture {
  let at = 8;
  let width = 0, height = 0, channels = 4;
  const packed: Buffer[] = [];
  while (at < file.length) {
    const size = file.readUInt32BE(at);
    const type = file.toString("latin1", at + 4, at + 8);
    const body = file.subarray(at + 8, at + 8 + size);
    if (type === "IHDR") [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), body[9] === 6 ? 4 : 3];
    if (type === "IDAT") packed.push(body);
    at += size + 12;
  }
  const rows = unfiltered(inflateSync(Buffer.concat(packed)), width * channels, height, channels);
  return { width, height, at: (x, y) => [0, 1, 2].map((c) => rows[(y * width + x) * channels + c]) as [number, number, number] };
}

function unfiltered(raw: Buffer, stride: number, height: number, channels: number): Uint8Array {
  const out = new Uint8Array(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let i = 0; i < stride; ++i) {
      const left = i >= channels ? out[y * stride + i - channels] : 0;
      const up = y > 0 ? out[(y - 1) * stride + i] : 0;
      const corner = y > 0 && i >= channels ? out[(y - 1) * stride + i - channels] : 0;
      const p = left + up - corner;
      const [dl, du, dc] = [Math.abs(p - left), Math.abs(p - up), Math.abs(p - corner)];
      const paeth = dl <= du && dl <= dc ? left : du <= dc ? up : corner;
      const guess = [0, left, up, (left + up) >> 1, paeth][filter];
      out[y * stride + i] = raw[y * (stride + 1) + 1 + i] + guess;
    }
  }
  return out;
}

/** Share of pixels for which `test` holds. */
export function share(picture: Picture, test: (colour: [number, number, number]) => boolean): number {
  let found = 0;
  for (let y = 0; y < picture.height; ++y) for (let x = 0; x < picture.width; ++x) if (test(picture.at(x, y))) ++found;
  return found / (picture.width * picture.height);
}

/** Share of pixels that differ clearly. */
export function difference(a: Picture, b: Picture): number {
  let found = 0;
  for (let y = 0; y < a.height; ++y) {
    for (let x = 0; x < a.width; ++x) {
      const p = a.at(x, y), q = b.at(x, y);
      if (Math.abs(p[0] - q[0]) + Math.abs(p[1] - q[1]) + Math.abs(p[2] - q[2]) > 24) ++found;
    }
  }
  return found / (a.width * a.height);
}

export const isColoured = ([r, g, b]: [number, number, number]): boolean => Math.max(r, g, b) - Math.min(r, g, b) > 40;

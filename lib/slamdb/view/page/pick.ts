// What is under a pixel: points and keyframes are drawn once more about it, each in its number instead of its colour, into an
// integer picture of 25 x 25 pixels.

import { type Gl, Program } from "./gl";
import { kKeyframeBit } from "./keyframes";
import { multiply } from "./maths";
import type { Selection } from "./model";
import { type PointCloud, type PointLook, kPointVertex, rowOfIndex } from "./points";
import { type Scene, mapOfPoint } from "./scene";
import type { Layer, ShapePrograms } from "./shapes";

const kSide = 25;
const kSmallestPoint = 7;

const kVertex = `${kPointVertex}
uniform uint first;
flat out uint id;
void main() {
  float newness, depth;
  id = first + uint(gl_VertexID) + 1u;
  place(newness, depth);
}`;
const kFragment = `
flat in uint id;
out uint result;
void main() {
  if (length(gl_PointCoord * 2.0 - 1.0) > 1.0) discard;
  result = id;
}`;

export const pickProgram = (gl: Gl): Program => new Program(gl, kVertex, kFragment);

export class Picker {
  private readonly target: WebGLFramebuffer;
  private readonly pixels = new Uint32Array(kSide * kSide);
  lastMs = 0;

  constructor(
    private readonly gl: Gl, private readonly program: Program, private readonly scene: Scene, private readonly cloud: PointCloud,
    private readonly shapes: ShapePrograms,
  ) {
    this.target = gl.createFramebuffer()!;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    for (const [format, attachment] of [[gl.R32UI, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]] as const) {
      const buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, kSide, kSide);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** x and y in device pixels from the left upper corner; `marks` are drawn in front of the points. */
  pick(x: number, y: number, width: number, height: number, look: PointLook | null, lines: Layer[], marks: Layer[], now: number): Selection {
    const { gl, shapes } = this;
    const begin = performance.now();
    // The square about the pixel fills the small picture.
    const sx = width / kSide, sy = height / kSide;
    const zoom = new Float32Array([
      sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 1, 0, -((2 * x) / width - 1) * sx, ((2 * y) / height - 1) * sy, 0, 1,
    ]);
    const viewProjection = shapes.viewProjection;
    const near = multiply(zoom, viewProjection);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, kSide, kSide);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.disable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    if (look) {
      this.program.use({});
      this.cloud.drawMaps(this.program, { ...look, viewProjection: near, fresh: 0, smallest: kSmallestPoint }, (map) => this.program.set({ first: map.first_point }));
    }
    shapes.viewProjection = near;
    shapes.viewport = [kSide, kSide];
    for (const layer of lines) shapes.drawNumbers(layer, { size: 5, now });
    gl.disable(gl.DEPTH_TEST);
    for (const layer of marks) shapes.drawNumbers(layer, { size: 13, now });
    gl.enable(gl.DEPTH_TEST);
    gl.readPixels(0, 0, kSide, kSide, gl.RED_INTEGER, gl.UNSIGNED_INT, this.pixels);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    shapes.viewProjection = viewProjection;
    shapes.viewport = [width, height];
    this.lastMs = performance.now() - begin;
    return selectionOf(this.scene, nearestNumber(this.pixels, kSide));
  }
}

/** The number nearest to the middle of a square picture; 0 where there is none within its circle. */
export function nearestNumber(pixels: Uint32Array, side: number): number {
  const middle = (side - 1) / 2;
  let best = 0;
  let reach = (middle + 0.5) ** 2;
  for (let i = 0; i < pixels.length; ++i) {
    if (pixels[i] === 0) continue;
    const d = ((i % side) - middle) ** 2 + (Math.floor(i / side) - middle) ** 2;
    if (d < reach) [best, reach] = [pixels[i], d];
  }
  return best;
}

/** What a number stands for: keyframes have the highest bit, points count from 1 in the order of the card's buffers. */
export function selectionOf(scene: Scene, number: number): Selection {
  if (number === 0) return null;
  if (number >= kKeyframeBit) return { kind: "keyframe", row: number - kKeyframeBit };
  const map = mapOfPoint(scene, number - 1);
  return { kind: "point", row: map.first_point + rowOfIndex(number - 1 - map.first_point, map.points) };
}

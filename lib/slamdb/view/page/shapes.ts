// Lines of any width and marks of any size, in the scene's frame: trajectory, frusta, edges, grid, rays, rings. Each element has
// a colour, a birth (for the timeline) and a number (for picking).

import type { Rgb } from "./colours";
import { type Gl, Program, pointAttributes } from "./gl";
import type { Vec3 } from "./maths";

const kLineBytes = 36; // a b, colour, birth, number
const kMarkBytes = 24; // position, colour, birth, number

/** Elements in the making: a buffer that grows. */
class Elements {
  count = 0;
  private bytes: ArrayBuffer;
  floats!: Float32Array;
  words!: Uint32Array;
  octets!: Uint8Array;

  constructor(readonly stride: number) {
    this.bytes = new ArrayBuffer(stride * 256);
    this.view();
  }

  /** The place of a new element, in 32-bit words. */
  grow(): number {
    if ((this.count + 1) * this.stride > this.bytes.byteLength) {
      const larger = new ArrayBuffer(this.bytes.byteLength * 2);
      new Uint8Array(larger).set(this.octets);
      this.bytes = larger;
      this.view();
    }
    return (this.count++ * this.stride) / 4;
  }

  paint(word: number, colour: Rgb, alpha: number, birth: number, number: number): void {
    const byte = word * 4;
    for (let c = 0; c < 3; ++c) this.octets[byte + c] = colour[c];
    this.octets[byte + 3] = alpha * 255;
    this.floats[word + 1] = birth;
    this.words[word + 2] = number;
  }

  used(): Uint8Array {
    return this.octets.subarray(0, this.count * this.stride);
  }

  private view(): void {
    this.floats = new Float32Array(this.bytes);
    this.words = new Uint32Array(this.bytes);
    this.octets = new Uint8Array(this.bytes);
  }
}

export class Lines extends Elements {
  constructor() {
    super(kLineBytes);
  }
  add(a: Vec3, b: Vec3, colour: Rgb, alpha = 1, birth = 0, number = 0): void {
    const word = this.grow();
    this.floats.set(a, word);
    this.floats.set(b, word + 3);
    this.paint(word + 6, colour, alpha, birth, number);
  }
}

export class Marks extends Elements {
  constructor() {
    super(kMarkBytes);
  }
  add(position: Vec3, colour: Rgb, alpha = 1, birth = 0, number = 0): void {
    const word = this.grow();
    this.floats.set(position, word);
    this.paint(word + 3, colour, alpha, birth, number);
  }
}

const kLineVertex = `
uniform mat4 view_projection;
uniform vec2 viewport; // pixels
uniform float width, now;
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec4 paint;
layout(location = 3) in float birth;
layout(location = 4) in uint number;
out vec4 colour;
out float side;
flat out uint id;
const float kNear = 1e-4;
void main() {
  colour = paint; id = number; side = 0.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (birth > now) return;
  vec4 a = view_projection * vec4(from, 1.0);
  vec4 b = view_projection * vec4(to, 1.0);
  if (a.w < kNear && b.w < kNear) return;
  if (a.w < kNear) a = mix(a, b, (kNear - a.w) / (b.w - a.w));
  if (b.w < kNear) b = mix(b, a, (kNear - b.w) / (a.w - b.w));
  vec2 pa = a.xy / a.w * viewport * 0.5;
  vec2 pb = b.xy / b.w * viewport * 0.5;
  vec2 along = pb - pa;
  float size = length(along);
  along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  float end = float(gl_VertexID & 1);
  side = float(gl_VertexID >> 1) * 2.0 - 1.0;
  vec4 p = end == 0.0 ? a : b;
  vec2 offset = across * side * (width * 0.5 + 0.75) + along * (end * 2.0 - 1.0) * width * 0.35;
  gl_Position = vec4(p.xy + offset * 2.0 / viewport * p.w, p.zw);
}`;
const kLineFragment = `
uniform float width, opacity;
in vec4 colour;
in float side;
out vec4 result;
void main() {
  float edge = (1.0 - abs(side)) * (width * 0.5 + 0.75);
  result = vec4(colour.rgb, colour.a * opacity * clamp(edge / 1.25, 0.0, 1.0));
}`;
const kMarkVertex = `
uniform mat4 view_projection;
uniform float size, now;
layout(location = 0) in vec3 position;
layout(location = 2) in vec4 paint;
layout(location = 3) in float birth;
layout(location = 4) in uint number;
flat out vec4 colour;
flat out float pixels;
flat out uint id;
void main() {
  colour = paint; id = number; pixels = size;
  gl_Position = birth > now ? vec4(2.0, 2.0, 2.0, 1.0) : view_projection * vec4(position, 1.0);
  gl_PointSize = size;
}`;
const kMarkFragment = `
uniform float ring, opacity; // ring: width of the rim in pixels, 0 for a disc
flat in vec4 colour;
flat in float pixels;
out vec4 result;
void main() {
  float inside = (1.0 - length(gl_PointCoord * 2.0 - 1.0)) * pixels * 0.5;
  float cover = clamp(inside + 0.5, 0.0, 1.0);
  if (ring > 0.0) cover *= clamp(ring - inside + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  result = vec4(colour.rgb, colour.a * opacity * cover);
}`;
const kIdFragment = `
flat in uint id;
out uint result;
void main() { result = id; }`;

/** Elements on the graphics card. */
export class Layer {
  count = 0;
  readonly array: WebGLVertexArrayObject;
  private readonly buffer: WebGLBuffer;

  constructor(private readonly gl: Gl, readonly kind: "lines" | "marks") {
    this.array = gl.createVertexArray()!;
    this.buffer = gl.createBuffer()!;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    const at = kind === "lines" ? 24 : 12;
    const position = { size: 3, type: gl.FLOAT };
    pointAttributes(gl, [
      { location: 0, offset: 0, ...position },
      ...(kind === "lines" ? [{ location: 1, offset: 12, ...position }] : []),
      { location: 2, size: 4, type: gl.UNSIGNED_BYTE, offset: at, normalized: true },
      { location: 3, size: 1, type: gl.FLOAT, offset: at + 4 },
      { location: 4, size: 1, type: gl.UNSIGNED_INT, offset: at + 8, integer: true },
    ], kind === "lines" ? kLineBytes : kMarkBytes, kind === "lines" ? 1 : 0);
    gl.bindVertexArray(null);
  }

  set(elements: Lines | Marks): this {
    const { gl } = this;
    this.count = elements.count;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, elements.used(), gl.DYNAMIC_DRAW);
    return this;
  }
}

export interface ShapeLook {
  size: number; // width of lines, diameter of marks; device pixels
  opacity?: number;
  ring?: number;
  now?: number;
  share?: number; // of the elements, from the first
}

/** Draws layers, and their numbers for picking. */
export class ShapePrograms {
  private readonly programs: Record<"lines" | "marks", Program>;
  private readonly numbers: Record<"lines" | "marks", Program>;
  viewProjection: Float32Array = new Float32Array(16);
  viewport: [number, number] = [1, 1];

  constructor(private readonly gl: Gl) {
    this.programs = { lines: new Program(gl, kLineVertex, kLineFragment), marks: new Program(gl, kMarkVertex, kMarkFragment) };
    this.numbers = { lines: new Program(gl, kLineVertex, kIdFragment), marks: new Program(gl, kMarkVertex, kIdFragment) };
  }

  draw(layer: Layer, look: ShapeLook): void {
    this.run(this.programs[layer.kind], layer, look);
  }

  drawNumbers(layer: Layer, look: ShapeLook): void {
    this.run(this.numbers[layer.kind], layer, look);
  }

  private run(program: Program, layer: Layer, { size, opacity = 1, ring = 0, now = 1e9, share = 1 }: ShapeLook): void {
    const { gl } = this;
    if (layer.count === 0) return;
    program.use({ view_projection: this.viewProjection, viewport: this.viewport, width: size, size, opacity, ring, now });
    const count = Math.ceil(layer.count * share);
    gl.bindVertexArray(layer.array);
    if (layer.kind === "lines") gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    else gl.drawArrays(gl.POINTS, 0, count);
    gl.bindVertexArray(null);
  }
}

// The cloud. Each map's points lie on the graphics card in sixteen strides (every 16th point, then those between), so that any
// beginning of a buffer is an even sample of the map: while the view moves, as much is drawn as the card manages in time.

import { type Frames, drawnStatuses } from "./frames";
import { type Context, type Gl, Program, pointAttributes } from "./gl";
import { matrixOf } from "./maths";
import { type Scene, type SceneMap, kLastBirth, placePoint } from "./scene";

/** The order of strides: bits of the number reversed, so that each fills the widest gap. */
export const kStrides = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];

const kCount = kStrides.length;
const strideLength = (stride: number, rows: number): number => Math.max(0, Math.ceil((rows - kStrides[stride]) / kCount));

/** The row, counted from the first of its map, of the point at `index` of a buffer of `rows`. */
export function rowOfIndex(index: number, rows: number): number {
  for (let stride = 0, begin = 0; stride < kCount; ++stride) {
    const size = strideLength(stride, rows);
    if (index < begin + size) return kStrides[stride] + (index - begin) * kCount;
    begin += size;
  }
  return -1;
}

/** Calls `visit` with all rows of a map in the order of the buffer. */
export function inOrder(rows: number, visit: (row: number, index: number) => void): void {
  let index = 0;
  for (const first of kStrides) {
    for (let row = first; row < rows; row += kCount) visit(row, index++);
  }
}

const kChunk = 1 << 18;
const kHiddenStatus = 31; // a bit no mask has

export const kPointVertex = `
uniform mat4 view_projection, model;
uniform float size, focus, now, fresh, smallest, largest;
uniform int statuses;
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 look; // shade, status
layout(location = 2) in float birth;
bool place(out float newness, out float depth) {
  newness = 0.0; depth = 1.0;
  gl_PointSize = 0.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (birth > now || (statuses & (1 << int(look.y))) == 0) return false;
  gl_Position = view_projection * model * vec4(position, 1.0);
  depth = gl_Position.w;
  // Nearer points are larger, but less so than perspective has it: far parts stay readable.
  float nearness = focus > 0.0 ? pow(clamp(focus / max(depth, 1e-9), 0.08, 40.0), 0.75) : 1.0;
  newness = fresh > 0.0 ? clamp(1.0 - (now - birth) / fresh, 0.0, 1.0) : 0.0;
  gl_PointSize = clamp(size * nearness, smallest, largest) * (1.0 + 0.8 * newness);
  return true;
}
`;

const kVertex = `${kPointVertex}
uniform sampler2D palette;
uniform vec3 background, glow;
uniform float fog_begin, fog_end, fog;
flat out vec3 colour;
flat out float pixels;
void main() {
  float newness, depth;
  colour = vec3(0.0); pixels = 1.0;
  if (!place(newness, depth)) return;
  vec3 own = texelFetch(palette, ivec2(int(look.x), 0), 0).rgb;
  own = mix(own, glow, 0.7 * newness);
  colour = mix(own, background, focus > 0.0 ? fog * smoothstep(fog_begin, fog_end, depth) : 0.0);
  pixels = gl_PointSize;
}`;

// Round by coverage, which needs no order; a rim slightly darker keeps points apart where they are dense.
const kFragment = `
flat in vec3 colour;
flat in float pixels;
uniform float cover_from;
out vec4 result;
void main() {
  float r = length(gl_PointCoord * 2.0 - 1.0);
  float cover = pixels < 2.5 ? 1.0 : clamp((1.0 - r) * pixels * 0.5 + 0.5, 0.0, 1.0);
  if (cover <= cover_from) discard;
  float rim = pixels > 3.5 ? 1.0 - 0.28 * smoothstep(0.45, 1.0, r) : 1.0;
  result = vec4(colour * rim, cover);
}`;

export const pointProgram = (gl: Gl): Program => new Program(gl, kVertex, kFragment);

interface MapBuffers {
  map: SceneMap;
  array: WebGLVertexArrayObject;
  looks: WebGLBuffer;
}

/** How points are drawn in one frame. */
export interface PointLook {
  viewProjection: Float32Array;
  size: number; // device pixels at the focus
  focus: number; // depth of the target; 0 without perspective
  radius: number;
  now: number; // the last birth that is drawn
  fresh: number; // births before now that glow
  statuses: number;
  share: number; // of the points
  background: number[];
  glow: number[];
  smallest?: number;
}

export class PointCloud {
  private readonly gl: Gl;
  private readonly buffers: MapBuffers[] = [];
  private readonly palette: WebGLTexture;

  constructor(private readonly context: Context, private readonly program: Program, private readonly scene: Scene, private readonly frames: Frames) {
    this.gl = context.gl;
    this.palette = this.gl.createTexture()!;
  }

  /** In pieces, so that neither the browser nor the driver holds all points twice. */
  async upload(progress: () => Promise<void>): Promise<void> {
    const { gl, scene } = this;
    for (const map of scene.maps) {
      const array = gl.createVertexArray()!;
      gl.bindVertexArray(array);
      const positions = gl.createBuffer()!;
      gl.bindBuffer(gl.ARRAY_BUFFER, positions);
      gl.bufferData(gl.ARRAY_BUFFER, map.points * 12, gl.STATIC_DRAW);
      pointAttributes(gl, [{ location: 0, size: 3, type: gl.FLOAT, offset: 0 }], 12);
      const looks = gl.createBuffer()!;
      gl.bindBuffer(gl.ARRAY_BUFFER, looks);
      gl.bufferData(gl.ARRAY_BUFFER, map.points * 4, gl.DYNAMIC_DRAW);
      pointAttributes(gl, [
        { location: 1, size: 2, type: gl.UNSIGNED_BYTE, offset: 0 },
        { location: 2, size: 1, type: gl.UNSIGNED_SHORT, offset: 2 },
      ], 4);
      this.buffers.push({ map, array, looks });
      const staging = new Float32Array(Math.min(kChunk, map.points) * 3);
      let first = 0;
      let filled = 0;
      for (const offset of kStrides) {
        for (let local = offset; local < map.points; local += kCount) {
          placePoint(scene, map, map.first_point + local, staging, filled * 3);
          if (++filled === kChunk || first + filled === map.points) {
            gl.bindBuffer(gl.ARRAY_BUFFER, positions);
            gl.bufferSubData(gl.ARRAY_BUFFER, first * 12, staging, 0, filled * 3);
            first += filled;
            filled = 0;
            await progress();
          }
        }
      }
    }
    gl.bindVertexArray(null);
  }

  /** A shade for each point, by rows. */
  setShades(shades: Uint8Array): void {
    const { gl, scene } = this;
    const { birth, status, hidden } = scene.points;
    for (const { map, looks } of this.buffers) {
      gl.bindBuffer(gl.ARRAY_BUFFER, looks);
      const bytes = new Uint8Array(Math.min(kChunk, map.points) * 4);
      const words = new Uint16Array(bytes.buffer);
      let first = 0;
      let filled = 0;
      inOrder(map.points, (local) => {
        const row = map.first_point + local;
        bytes[filled * 4] = shades[row];
        bytes[filled * 4 + 1] = hidden !== null && hidden[row] !== 0 ? kHiddenStatus : status !== null ? status[row] : 0;
        words[filled * 2 + 1] = birth[row];
        if (++filled === kChunk || first + filled === map.points) {
          gl.bufferSubData(gl.ARRAY_BUFFER, first * 4, bytes, 0, filled * 4);
          first += filled;
          filled = 0;
        }
      });
    }
  }

  setPalette(bytes: Uint8Array): void {
    const { gl } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }

  draw(look: PointLook): void {
    const { gl } = this;
    gl.enable(gl.SAMPLE_ALPHA_TO_COVERAGE);
    gl.bindTexture(gl.TEXTURE_2D, this.palette);
    this.program.use({
      palette: 0, cover_from: this.context.multisampled ? 0.05 : 0.5, background: look.background, glow: look.glow, fog: 0.72,
      fog_begin: look.focus, fog_end: look.focus + look.radius * 2.6,
    });
    this.drawMaps(this.program, look);
    gl.disable(gl.SAMPLE_ALPHA_TO_COVERAGE);
  }

  /** With a program of one's own, which has the uniforms of kPointVertex; `before` is told each map. */
  drawMaps(program: Program, look: PointLook, before?: (map: SceneMap) => void): void {
    const { gl, frames } = this;
    program.set({
      view_projection: look.viewProjection, size: look.size, focus: look.focus, now: look.now, fresh: look.fresh,
      smallest: look.smallest ?? 1.2, largest: 26,
    });
    for (const { map, array } of this.buffers) {
      if (map.points === 0 || !frames.shown(map)) continue;
      const statuses = drawnStatuses(this.scene, map, look.statuses) & 0x7fffffff;
      if (statuses === 0) continue;
      program.set({ model: matrixOf(frames.now[map.index]), statuses });
      before?.(map);
      gl.bindVertexArray(array);
      gl.drawArrays(gl.POINTS, 0, Math.min(map.points, Math.ceil(map.points * look.share)));
    }
    gl.bindVertexArray(null);
  }
}

export const kAllBirths = kLastBirth + 1;

// A thin layer over WebGL2. Why not three.js: Debian's is r111, which has no types and no integer attributes or render targets
// (needed for picking), and would put 600 kB into every page; points and lines need the few calls below.

export type Gl = WebGL2RenderingContext;

export class NoWebGl extends Error {}

export interface Context {
  gl: Gl;
  software: boolean; // a processor draws, not a graphics card
  multisampled: boolean;
}

/** With several samples a pixel, but where a processor draws: that halves its frames. */
export function openContext(canvas: HTMLCanvasElement): Context {
  const probe = document.createElement("canvas").getContext("webgl2");
  const software = probe !== null && isSoftware(probe);
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  const gl = canvas.getContext("webgl2", { antialias: !software, alpha: false, powerPreference: "high-performance" });
  if (!gl) {
    throw new NoWebGl(
      "This browser cannot draw in 3D here: WebGL2 is missing or switched off. A current Firefox, Chrome, Edge or Safari has it; in a remote desktop or a virtual machine, software rendering may have to be allowed.",
    );
  }
  return { gl, software, multisampled: (gl.getParameter(gl.SAMPLES) as number) > 1 };
}

function isSoftware(gl: Gl): boolean {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

type Value = number | number[] | Float32Array;

/** A program and its uniforms by name. It is asked for nothing before it is used, so that programs are compiled side by side, and while data
 * is read. */
export class Program {
  private readonly program: WebGLProgram;
  private places: Map<string, { place: WebGLUniformLocation; type: number }> | null = null;

  constructor(private readonly gl: Gl, vertex: string, fragment: string) {
    this.program = gl.createProgram()!;
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
      const shader = gl.createShader(type)!;
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;\nprecision highp int;\n${source}`);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
      gl.deleteShader(shader);
    }
    gl.linkProgram(this.program);
  }

  private linked(): Map<string, { place: WebGLUniformLocation; type: number }> {
    if (this.places) return this.places;
    const { gl } = this;
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(this.program)!.map((shader) => gl.getShaderInfoLog(shader));
      throw new NoWebGl(`The graphics driver refused a shader: ${[gl.getProgramInfoLog(this.program), ...logs].join(" ")}`);
    }
    const places = (this.places = new Map());
    const count = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS) as number;
    for (let i = 0; i < count; ++i) {
      const { name, type } = gl.getActiveUniform(this.program, i)!;
      places.set(name, { place: gl.getUniformLocation(this.program, name)!, type });
    }
    return places;
  }

  use(values: Record<string, Value>): void {
    this.gl.useProgram(this.program);
    this.set(values);
  }

  set(values: Record<string, Value>): void {
    const { gl } = this;
    const places = this.linked();
    for (const [name, value] of Object.entries(values)) {
      const uniform = places.get(name);
      if (!uniform) continue; // optimised away
      const { place, type } = uniform;
      if (type === gl.FLOAT) gl.uniform1f(place, value as number);
      else if (type === gl.INT || type === gl.SAMPLER_2D) gl.uniform1i(place, value as number);
      else if (type === gl.UNSIGNED_INT) gl.uniform1ui(place, value as number);
      else if (type === gl.FLOAT_VEC2) gl.uniform2fv(place, value as number[]);
      else if (type === gl.FLOAT_VEC3) gl.uniform3fv(place, value as number[]);
      else if (type === gl.FLOAT_VEC4) gl.uniform4fv(place, value as number[]);
      else gl.uniformMatrix4fv(place, false, value as Float32Array);
    }
  }
}

export interface Attribute {
  location: number;
  size: number;
  type: number;
  offset: number;
  normalized?: boolean;
  integer?: boolean;
}

/** Names attributes of the buffer that is bound to ARRAY_BUFFER. */
export function pointAttributes(gl: Gl, attributes: Attribute[], stride: number, divisor = 0): void {
  for (const { location, size, type, offset, normalized, integer } of attributes) {
    gl.enableVertexAttribArray(location);
    if (integer) gl.vertexAttribIPointer(location, size, type, stride, offset);
    else gl.vertexAttribPointer(location, size, type, normalized ?? false, stride, offset);
    gl.vertexAttribDivisor(location, divisor);
  }
}

/** Tells when the graphics card has done what was sent to it, without waiting: a frame is sent when the last one is done. */
export class FrameClock {
  lastMs = 0; // from sending a frame to its end
  private sync: WebGLSync | null = null;
  private begin = 0;
  constructor(private readonly gl: Gl) {}

  get busy(): boolean {
    return this.sync !== null;
  }

  sent(begin: number, done: () => void): void {
    const { gl } = this;
    this.begin = begin;
    this.sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = (): void => {
      if (!this.sync) return;
      const state = gl.getSyncParameter(this.sync, gl.SYNC_STATUS) as number | null;
      if (state === gl.UNSIGNALED) {
        setTimeout(look, 1);
        return;
      }
      gl.deleteSync(this.sync);
      this.sync = null;
      this.lastMs = performance.now() - this.begin;
      done();
    };
    setTimeout(look, 0);
  }
}

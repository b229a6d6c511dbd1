// The eye: turns about a target, pans, zooms, flies. z of the scene is up; the plan view looks straight down without perspective.

import {
  type Vec3, add, clamp, dot, length, mix, mixPoints, multiply, orthographic, perspective, project, quantile, scale, subtract,
} from "./maths";

export interface CameraPose {
  target: Vec3;
  distance: number;
  azimuth: number; // radians, of the eye as seen from the target
  elevation: number;
  plan: boolean;
  aside: number; // CSS pixels at the right that the inspector covers: flights to a selection show it beside that
}

export interface Projected {
  x: number; // CSS pixels
  y: number;
  depth: number;
}

const kFov = (42 * Math.PI) / 180;
const kTan = Math.tan(kFov / 2);
const kStraight = Math.PI / 2;
const kSmallest = 1e-4;
const kLargest = 1e7;

interface Flight {
  from: CameraPose;
  to: CameraPose;
  begin: number;
  duration: number;
}

export class Camera {
  pose: CameraPose = { target: [0, 0, 0], distance: 10, azimuth: -1.2, elevation: 0.6, plan: false, aside: 0 };
  width = 1;
  height = 1;
  inset = 0; // CSS pixels at the left that the panel covers: the target is in the middle of the rest
  radius = 10; // of the scene, for the depth range
  calm = false; // no flights: the user prefers reduced motion
  private flight: Flight | null = null;

  get flying(): boolean {
    return this.flight !== null;
  }

  /** Right, up, and from the target to the eye. */
  basis(): { right: Vec3; up: Vec3; back: Vec3; eye: Vec3 } {
    const { azimuth, elevation, target, distance } = this.pose;
    const c = Math.cos(azimuth), s = Math.sin(azimuth), cosE = Math.cos(elevation), sinE = Math.sin(elevation);
    const back: Vec3 = [cosE * c, cosE * s, sinE];
    return { right: [-s, c, 0], up: [-sinE * c, -sinE * s, cosE], back, eye: add(target, scale(back, distance)) };
  }

  viewProjection(): Float32Array {
    const { right, up, back, eye } = this.basis();
    const view = new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
    ]);
    const { distance, plan } = this.pose;
    const aspect = this.width / this.height;
    const far = distance + this.radius * 4;
    const half = distance * kTan;
    const lens = plan ? orthographic(half * aspect, half, -far, far) : perspective(kFov, aspect, Math.max(distance * 0.01, far * 1e-5), far);
    const shift = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, (this.inset - this.pose.aside) / this.width, 0, 0, 1]);
    return multiply(shift, multiply(lens, view));
  }

  /** Length of a CSS pixel at the target. */
  unitsPerPixel(): number {
    return (2 * this.pose.distance * kTan) / this.height;
  }

  orbit(dx: number, dy: number): void {
    this.stop();
    const { pose } = this;
    pose.azimuth -= dx * 0.006;
    if (!pose.plan) pose.elevation = clamp(pose.elevation + dy * 0.006, -kStraight, kStraight);
  }

  pan(dx: number, dy: number): void {
    this.stop();
    const { right, up } = this.basis();
    const unit = this.unitsPerPixel();
    this.pose.target = add(this.pose.target, add(scale(right, -dx * unit), scale(up, dy * unit)));
  }

  /** factor < 1 goes nearer; what is under the pixel stays there. */
  zoom(factor: number, x = this.centre()[0], y = this.centre()[1]): void {
    this.stop();
    const before = clamp(this.pose.distance * factor, kSmallest, kLargest) / this.pose.distance;
    const [cx, cy] = this.centre();
    const { right, up } = this.basis();
    const unit = this.unitsPerPixel() * (1 - before);
    this.pose.target = add(this.pose.target, add(scale(right, (x - cx) * unit), scale(up, (cy - y) * unit)));
    this.pose.distance *= before;
  }

  centre(): [number, number] {
    return [(this.width + this.inset - this.pose.aside) / 2, this.height / 2];
  }

  /** null behind the eye. */
  project(p: Vec3, matrix = this.viewProjection()): Projected | null {
    const [x, y, , w] = project(matrix, p);
    if (w <= 0) return null;
    return { x: ((x / w + 1) * this.width) / 2, y: ((1 - y / w) * this.height) / 2, depth: w };
  }

  /** Where the line of sight through a pixel meets the level `z`; null where it does not. */
  onLevel(x: number, y: number, z: number): Vec3 | null {
    const { right, up, back, eye } = this.basis();
    const [cx, cy] = this.centre();
    const unit = this.unitsPerPixel();
    const aside = add(scale(right, (x - cx) * unit), scale(up, (cy - y) * unit));
    const from = this.pose.plan ? add(eye, aside) : eye;
    const ray = this.pose.plan ? scale(back, -1) : subtract(aside, scale(back, this.pose.distance));
    const t = (z - from[2]) / ray[2];
    return Number.isFinite(t) && t > 0 ? add(from, scale(ray, t)) : null;
  }

  /** A pose that shows all landmarks from the given side, in the middle of what the panel leaves free. */
  framed(landmarks: Vec3[], azimuth: number, elevation: number, plan = false): CameraPose {
    const looking = new Camera();
    looking.pose = { target: [0, 0, 0], distance: 1, azimuth, elevation, plan, aside: 0 };
    const { right, up, back } = looking.basis();
    const tanY = kTan * 0.9;
    const tanX = (kTan * 0.9 * Math.max(this.width - this.inset, 50)) / this.height;
    const across = spanFrom(landmarks, right, back, plan ? 0 : tanX);
    const along = spanFrom(landmarks, up, back, plan ? 0 : tanY);
    const depth = spanFrom(landmarks, back, back, 0);
    const eye = Math.max(across.half / tanX, along.half / tanY); // in perspective: how far along `back`
    const target = add(scale(right, across.middle), add(scale(up, along.middle), scale(back, depth.middle)));
    return { target, distance: clamp((plan ? eye : eye - depth.middle) || 1, kSmallest, kLargest), azimuth, elevation, plan, aside: 0 };
  }

  flyTo(to: CameraPose, now: number, duration = 520): void {
    if (this.calm || duration <= 0) {
      this.pose = { ...to };
      this.flight = null;
      return;
    }
    const from = { ...this.pose };
    // The short way round.
    from.azimuth = to.azimuth + Math.atan2(Math.sin(from.azimuth - to.azimuth), Math.cos(from.azimuth - to.azimuth));
    this.flight = { from, to: { ...to }, begin: now, duration };
  }

  /** The same side, nearer: shows `target` with `radius` about it. */
  flyNear(target: Vec3, radius: number, now: number, aside = this.pose.aside): void {
    const distance = Math.max(radius / kTan, kSmallest);
    this.flyTo({ ...this.pose, target, aside, distance: Math.min(distance, Math.max(this.pose.distance, distance * 0.5)) }, now);
  }

  stop(): void {
    this.flight = null;
  }

  /** Goes on with a flight; whether the pose changed. */
  tick(now: number): boolean {
    if (!this.flight) return false;
    const { from, to, begin, duration } = this.flight;
    const linear = clamp((now - begin) / duration, 0, 1);
    const t = linear < 0.5 ? 4 * linear ** 3 : 1 - (-2 * linear + 2) ** 3 / 2;
    if (linear >= 1) {
      this.pose = { ...to };
      this.flight = null;
      return true;
    }
    this.pose = {
      target: mixPoints(from.target, to.target, t),
      distance: Math.exp(mix(Math.log(from.distance), Math.log(to.distance), t)),
      azimuth: mix(from.azimuth, to.azimuth, t),
      elevation: mix(from.elevation, to.elevation, t),
      plan: from.plan && to.plan,
      aside: mix(from.aside, to.aside, t),
    };
    return true;
  }
}

/** Middle and half width of points along an axis, as an eye sees them whose sight widens by `tan` with each step from it. */
function spanFrom(points: Vec3[], axis: Vec3, back: Vec3, tan: number): { middle: number; half: number } {
  let low = Infinity, high = -Infinity;
  for (const p of points) {
    const at = dot(p, axis), nearer = tan * dot(p, back);
    low = Math.min(low, at - nearer);
    high = Math.max(high, at + nearer);
  }
  return points.length > 0 ? { middle: (low + high) / 2, half: (high - low) / 2 } : { middle: 0, half: 0 };
}

/** The middle of what most points are in. */
function middle(points: Vec3[]): Vec3 {
  if (points.length === 0) return [0, 0, 0];
  return [0, 1, 2].map((axis) => {
    const sorted = Float64Array.from(points, (p) => p[axis]).sort();
    return (quantile(sorted, 0.05) + quantile(sorted, 0.95)) / 2;
  }) as Vec3;
}

/** The side from which the landmarks are widest: across the long axis of their plan. */
export function widestAzimuth(points: Vec3[]): number {
  const centre = middle(points);
  const distances = Float64Array.from(points, (p) => length(subtract(p, centre))).sort();
  const reach = quantile(distances, 0.9);
  let xx = 0, xy = 0, yy = 0;
  for (const p of points) {
    const x = p[0] - centre[0], y = p[1] - centre[1];
    if (Math.hypot(x, y) > reach) continue;
    xx += x * x, xy += x * y, yy += y * y;
  }
  // The eye looks across the long axis, from a little aside.
  return Math.atan2(2 * xy, xx - yy) / 2 - Math.PI / 2 + 0.3;
}

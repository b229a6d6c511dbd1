// The picture: what is drawn, in which order, how much of it while it moves, and what is under a pixel.

import { Camera, widestAzimuth } from "./camera";
import { type Shading, type Theme, palette, shade } from "./colours";
import { type EdgeLayer, buildEdges } from "./edges";
import { type Context, FrameClock, type Gl, type Program, openContext } from "./gl";
import { buildGrid, gridStep } from "./grid";
import { buildFindings, buildLit, buildMoves } from "./highlights";
import { buildCentres, buildFrusta, buildTrajectory, usualFrustum } from "./keyframes";
import { type Vec3, distance } from "./maths";
import type { LayerName, Model, Selection, Topic } from "./model";
import { Picker, pickProgram } from "./pick";
import { PointCloud, type PointLook, kAllBirths, pointProgram } from "./points";
import { birthOf } from "./scene";
import { Layer, Lines, Marks, ShapePrograms } from "./shapes";
import { kPaint, resolvedTheme, unit } from "./theme";

const kMovingMs = { card: 24, software: 70 }; // a frame, while the view moves
const kLeastMoving = 50_000; // points: fewer save no time, since all else is drawn too
const kRestMs = 1500; // a frame at rest, at most
const kRestAfter = 140;
const kLineLayers = ["grid", "covisibility", "tree", "loops", "merges", "frusta", "trajectory", "moves", "lit", "rays", "tape"] as const;
const kMarkLayers = ["centres", "points", "keypoints", "rings", "findings", "finding", "tapeEnds"] as const;

/** What draws; made before there is anything to draw. */
export interface Drawing extends Context {
  canvas: HTMLCanvasElement;
  points: Program;
  pick: Program;
  shapes: ShapePrograms;
}

export function openDrawing(canvas: HTMLCanvasElement): Drawing {
  const context = openContext(canvas);
  const { gl } = context;
  return { ...context, canvas, points: pointProgram(gl), shapes: new ShapePrograms(gl), pick: pickProgram(gl) };
}

export class Stage {
  readonly canvas: HTMLCanvasElement;
  readonly gl: Gl;
  readonly camera = new Camera();
  readonly cloud: PointCloud;
  readonly software: boolean;
  shading!: Shading;
  theme: Theme;
  frames = 0; // drawn
  onFrame: () => void = () => {};
  onLost: () => void = () => {};
  private readonly shapes: ShapePrograms;
  private readonly picker: Picker;
  private readonly clock: FrameClock;
  private readonly layers = {} as Record<(typeof kLineLayers)[number] | (typeof kMarkLayers)[number], Layer>;
  private pixelRatio = 1;
  private dirty = false;
  private scheduled = false;
  private movedAt = -1e9;
  private movingBudget: number;
  private share = 1;
  private moving = false;
  private pointsPerMs = 0;
  private extent = 1;
  private gridCell = 0;
  private readonly staleEdges = new Set<EdgeLayer>();

  constructor(drawing: Drawing, readonly model: Model) {
    const { canvas, gl } = drawing;
    this.canvas = canvas;
    this.gl = gl;
    this.software = drawing.software;
    this.theme = resolvedTheme(model.settings.theme);
    this.cloud = new PointCloud(drawing, drawing.points, model.scene, model.frames);
    this.shapes = drawing.shapes;
    this.picker = new Picker(gl, drawing.pick, model.scene, this.cloud, this.shapes);
    this.clock = new FrameClock(gl);
    this.movingBudget = this.software ? 150_000 : 1_500_000;
    for (const name of kLineLayers) this.layers[name] = new Layer(gl, "lines");
    for (const name of kMarkLayers) this.layers[name] = new Layer(gl, "marks");
    canvas.addEventListener("webglcontextlost", () => this.onLost());
    this.listen();
  }

  async upload(progress: () => Promise<void>): Promise<void> {
    await this.cloud.upload(progress);
    this.recolour();
    this.reframe();
  }

  private listen(): void {
    const on = (topics: Topic[], told: () => void): void => this.model.on(topics, () => (told(), this.request()));
    on(["colour"], () => (this.recolour(), this.rebuildKeyframes()));
    on(["theme"], () => {
      this.theme = resolvedTheme(this.model.settings.theme);
      this.paintPalette();
      this.rebuildAll();
    });
    on(["frames"], () => this.reframe());
    on(["arrangement"], () => this.showAll());
    on(["size"], () => this.rebuildKeyframes());
    on(["selection"], () => this.rebuildLit());
    on(["finding"], () => this.rebuildFindings());
    on(["layers", "time"], () => {});
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.model.changed("theme"));
  }

  get frustumDepth(): number {
    return usualFrustum(this.model.scene, this.extent) * this.model.settings.frustumSize;
  }

  private recolour(): void {
    this.shading = shade(this.model.scene, this.model.frames, this.model.settings.colour);
    this.cloud.setShades(this.shading.shades);
    this.paintPalette();
  }

  private paintPalette(): void {
    this.cloud.setPalette(palette(this.shading, this.theme, kPaint[this.theme].plain));
  }

  private reframe(): void {
    const { low, high } = this.model.frames.bounds();
    this.extent = distance(low, high);
    this.camera.radius = Math.max(this.extent, 1e-3) * 1.5;
    this.rebuildAll();
  }

  private rebuildAll(): void {
    this.gridCell = 0;
    this.rebuildKeyframes();
    this.rebuildFindings();
    this.layers.moves.set(buildMoves(this.model, this.theme));
  }

  private rebuildKeyframes(): void {
    const { model, theme, layers } = this;
    layers.frusta.set(buildFrusta(model, theme, this.frustumDepth));
    layers.trajectory.set(buildTrajectory(model, theme));
    layers.centres.set(buildCentres(model, theme));
    for (const name of ["covisibility", "tree", "loops", "merges"] as const) this.staleEdges.add(name);
    this.rebuildLit();
  }

  /** Edges are many: those that are not shown are not built. */
  private refreshEdges(): void {
    for (const name of this.staleEdges) {
      if (!this.model.settings.layers[name]) continue;
      this.layers[name].set(buildEdges(this.model, name, this.theme));
      this.staleEdges.delete(name);
    }
  }

  private rebuildLit(): void {
    const lit = buildLit(this.model, this.theme, this.frustumDepth);
    this.layers.lit.set(lit.lines);
    this.layers.rays.set(lit.rays);
    this.layers.points.set(lit.points);
    this.layers.keypoints.set(lit.keypoints);
    this.layers.rings.set(lit.rings);
  }

  private rebuildFindings(): void {
    const { all, current } = buildFindings(this.model, this.theme);
    this.layers.findings.set(all);
    this.layers.finding.set(current);
  }

  /** Comparisons show and hide keyframes by status. */
  statusesChanged(): void {
    this.rebuildAll();
    this.request();
  }

  setTape(places: Vec3[]): void {
    const lines = new Lines();
    const ends = new Marks();
    const colour = kPaint[this.theme].tape;
    places.forEach((place, i) => {
      ends.add(place, colour);
      if (i > 0) lines.add(places[i - 1], place, colour);
    });
    this.layers.tape.set(lines);
    this.layers.tapeEnds.set(ends);
    this.request();
  }

  /** The first look: from above and aside, across the long axis of the map. */
  home(plan = false): typeof this.camera.pose {
    const landmarks = this.model.frames.landmarks();
    const azimuth = widestAzimuth(landmarks);
    return this.camera.framed(landmarks, plan ? azimuth - 0.3 : azimuth, plan ? Math.PI / 2 : 0.62, plan);
  }

  /** Flies to where all is seen, from the side from which it is widest. */
  showAll(plan = this.camera.pose.plan): void {
    this.camera.flyTo(this.home(plan), performance.now());
    this.moved();
  }

  resize(width: number, height: number, inset: number): void {
    this.pixelRatio = Math.min(devicePixelRatio || 1, this.software ? 1.5 : 3);
    const w = Math.max(1, Math.round(width * this.pixelRatio)), h = Math.max(1, Math.round(height * this.pixelRatio));
    if (this.canvas.width !== w || this.canvas.height !== h) [this.canvas.width, this.canvas.height] = [w, h];
    [this.camera.width, this.camera.height, this.camera.inset] = [Math.max(1, width), Math.max(1, height), inset];
    this.request();
  }

  /** Flies to a place, and shows `radius` about it beside the inspector. */
  flyNear(place: Vec3, radius: number): void {
    const inspector = document.getElementById("inspector");
    const covered = !inspector || inspector.hidden || innerWidth <= 900 ? 0 : innerWidth - inspector.getBoundingClientRect().left;
    this.camera.flyNear(place, radius, performance.now(), covered);
    this.model.changed("camera");
    this.request();
  }

  /** The view was moved by hand: until it rests, speed counts more than the last point. */
  moved(): void {
    this.movedAt = performance.now();
    this.model.changed("camera");
    this.request();
  }

  request(): void {
    this.dirty = true;
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      if (!this.clock.busy) this.frame();
    });
  }

  private frame(): void {
    const begin = performance.now();
    const flown = this.camera.tick(begin);
    const moving = this.moving = flown || begin - this.movedAt < kRestAfter;
    if (flown) this.model.changed("camera");
    this.dirty = this.camera.flying;
    this.share = this.shareNow(moving);
    const sent = this.model.scene.points.count * this.share;
    this.draw();
    this.frames += 1;
    this.onFrame();
    this.clock.sent(begin, () => this.frameDone(moving, sent));
  }

  private frameDone(moving: boolean, sent: number): void {
    const ms = this.clock.lastMs;
    // The first frame pays for the start of the card; later ones may be held up by others: the best counts, and fades.
    if (sent > 20000 && this.frames > 1) this.pointsPerMs = Math.max(sent / Math.max(ms, 1), this.pointsPerMs * 0.9);
    if (moving) {
      const factor = Math.min(1.3, Math.max(0.5, kMovingMs[this.software ? "software" : "card"] / Math.max(ms, 4)));
      this.movingBudget = Math.min(Math.max(this.movingBudget * factor, kLeastMoving), Math.max(this.model.scene.points.count, kLeastMoving) * 1.3);
    }
    if (this.dirty) this.request();
    else if (moving || this.share < this.restShare()) setTimeout(() => this.request(), moving ? kRestAfter : 0);
  }

  private restShare(): number {
    const { count } = this.model.scene.points;
    return this.pointsPerMs > 0 ? Math.min(1, (this.pointsPerMs * kRestMs) / Math.max(count, 1)) : 1;
  }

  /** At rest the share grows fourfold a frame, so that a hand on the mouse never waits long. */
  private shareNow(moving: boolean): number {
    const budget = Math.min(1, this.movingBudget / Math.max(this.model.scene.points.count, 1));
    if (moving) return budget;
    return Math.min(this.restShare(), Math.max(budget, this.frames === 0 ? budget : this.share * 4));
  }

  /** Of very many frusta some are left out while the view moves. */
  private movingFrusta(): number {
    return Math.min(1, (this.software ? 250 : 20_000) / Math.max(1, this.model.scene.keyframes.count));
  }

  private pointLook(): PointLook {
    const { model, camera, theme } = this;
    const { count } = model.scene.points;
    const { settings } = model;
    // Few points are drawn large, many small; a share of them somewhat larger; nearer ones grow a little.
    const density = Math.min(5.2, Math.max(1.5, 9.5 - 1.25 * Math.log10(Math.max(count, 10))));
    const zoomed = Math.min(1.8, Math.max(0.8, (this.extent / camera.pose.distance) ** 0.25));
    const thin = Math.min(2, this.share ** -0.18);
    const frames = settings.time >= model.scene.keyframes.count ? 0 : Math.max(2, model.scene.keyframes.count * 0.012);
    return {
      viewProjection: this.shapes.viewProjection,
      size: density * zoomed * thin * settings.pointSize * this.pixelRatio,
      focus: camera.pose.plan ? 0 : camera.pose.distance, radius: this.camera.radius,
      now: model.now, fresh: birthOf(frames, model.scene.keyframes.count),
      statuses: settings.statuses, share: this.share, background: unit(kPaint[theme].background), glow: unit(kPaint[theme].glow),
    };
  }

  draw(): void {
    const { gl, shapes, layers, model, pixelRatio: px } = this;
    const { canvas } = this;
    const shown = (name: LayerName): boolean => model.settings.layers[name];
    const now = model.now === kAllBirths ? 1e9 : model.now;
    shapes.viewProjection = this.camera.viewProjection();
    shapes.viewport = [canvas.width, canvas.height];
    this.refreshGrid();
    this.refreshEdges();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...unit(kPaint[this.theme].background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    if (shown("points")) this.cloud.draw(this.pointLook());
    gl.depthMask(false);
    gl.enable(gl.BLEND);
    if (shown("grid")) shapes.draw(layers.grid, { size: 1 * px });
    if (shown("covisibility")) shapes.draw(layers.covisibility, { size: 1 * px, now });
    if (shown("tree")) shapes.draw(layers.tree, { size: 1.4 * px, now });
    if (shown("moves")) shapes.draw(layers.moves, { size: 1.4 * px, now });
    if (shown("frusta")) shapes.draw(layers.frusta, { size: 1.1 * px, now, share: this.moving ? this.movingFrusta() : 1 });
    // Through the points, faintly: where one has been is never lost to sight.
    for (const through of [true, false]) {
      if (through) gl.disable(gl.DEPTH_TEST);
      else gl.enable(gl.DEPTH_TEST);
      const opacity = through ? 0.4 : 1;
      if (shown("loops")) shapes.draw(layers.loops, { size: 2.4 * px, opacity, now });
      if (shown("merges")) shapes.draw(layers.merges, { size: 2.4 * px, opacity, now });
      if (shown("trajectory")) shapes.draw(layers.trajectory, { size: 2.2 * px, opacity, now });
    }
    gl.disable(gl.DEPTH_TEST);
    this.drawLit(shown, px);
    gl.depthMask(true);
  }

  private drawLit(shown: (name: LayerName) => boolean, px: number): void {
    const { shapes, layers } = this;
    if (shown("rays")) shapes.draw(layers.rays, { size: 1 * px });
    shapes.draw(layers.lit, { size: 1.8 * px });
    shapes.draw(layers.points, { size: 5.5 * px });
    if (shown("keypoints")) shapes.draw(layers.keypoints, { size: 2.6 * px });
    shapes.draw(layers.rings, { size: 19 * px, ring: 2 * px });
    if (shown("findings")) {
      shapes.draw(layers.findings, { size: 9 * px, ring: 1.7 * px });
      shapes.draw(layers.finding, { size: 24 * px, ring: 3 * px });
    }
    shapes.draw(layers.tape, { size: 2.2 * px });
    shapes.draw(layers.tapeEnds, { size: 8 * px });
  }

  private refreshGrid(): void {
    const step = gridStep(this.camera.unitsPerPixel());
    if (step === this.gridCell) return;
    this.gridCell = step;
    this.layers.grid.set(buildGrid(this.model.frames.bounds(), step, kPaint[this.theme].grid));
  }

  /** x and y in CSS pixels of the canvas. */
  pick(x: number, y: number): Selection {
    const { layers, model, pixelRatio, canvas } = this;
    const shown = model.settings.layers;
    const now = model.now === kAllBirths ? 1e9 : model.now;
    this.shapes.viewProjection = this.camera.viewProjection();
    const keyframes = shown.frusta || shown.trajectory;
    return this.picker.pick(
      x * pixelRatio, y * pixelRatio, canvas.width, canvas.height, shown.points ? this.pointLook() : null,
      shown.frusta ? [layers.frusta] : [], keyframes ? [layers.centres] : [], now,
    );
  }

  /** Hovering picks where that takes no time. */
  get quickPicks(): boolean {
    return this.picker.lastMs < 20 && this.model.scene.points.count < (this.software ? 120_000 : 3_000_000);
  }

  get frameMs(): number {
    return this.clock.lastMs;
  }

  get drawnShare(): number {
    return this.share;
  }

  get resting(): boolean {
    return !this.dirty && !this.scheduled && !this.clock.busy && performance.now() - this.movedAt > kRestAfter && this.share >= this.restShare();
  }

  /** A picture of what is seen, with all points, as PNG. */
  async picture(): Promise<Blob> {
    this.share = 1;
    this.moving = false;
    this.draw();
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The picture could not be made."))), "image/png");
      this.request();
    });
  }
}

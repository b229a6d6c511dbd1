// What the page shows at a time: settings, selection, frames; and who is told of changes.

import type { ColourMode, Theme } from "./colours";
import { type Arrangement, Frames } from "./frames";
import { type Scene, birthOf, unitOf } from "./scene";
import { kAllBirths } from "./points";

export const kLayers = [
  "points", "trajectory", "frusta", "covisibility", "tree", "loops", "merges", "findings", "moves", "rays", "keypoints", "grid",
] as const;
export type LayerName = (typeof kLayers)[number];

export type Selection = { kind: "keyframe" | "point"; row: number } | null;

/** What changed: whoever draws or lists it looks again. */
export type Topic = "layers" | "colour" | "theme" | "frames" | "selection" | "arrangement" | "time" | "size" | "camera" | "tape" | "finding";

export interface Settings {
  colour: ColourMode;
  theme: "auto" | Theme;
  pointSize: number; // times the usual
  frustumSize: number;
  minWeight: number; // of covisibility edges that are drawn
  statuses: number; // bits by Status, in a comparison
  layers: Record<LayerName, boolean>;
  time: number; // how many keyframes, in the order of time, are there yet
}

export class Model {
  readonly frames: Frames;
  readonly settings: Settings;
  readonly unit: string;
  selection: Selection = null;
  finding = -1; // row of header.findings that is looked at
  private readonly listeners: { topics: Topic[]; told: () => void }[] = [];

  constructor(readonly scene: Scene) {
    this.frames = new Frames(scene);
    this.settings = usualSettings(scene);
    this.unit = unitOf(scene.maps);
    if (!scene.header.diff && scene.header.layout === "side-by-side" && scene.header.atlases.length > 1) this.frames.arrangement = "atlases";
    this.frames.update();
  }

  on(topics: Topic[], told: () => void): void {
    this.listeners.push({ topics, told });
  }

  changed(...topics: Topic[]): void {
    for (const listener of this.listeners) {
      if (listener.topics.some((topic) => topics.includes(topic))) listener.told();
    }
  }

  setLayer(name: LayerName, shown: boolean): void {
    this.settings.layers[name] = shown;
    this.changed("layers");
  }

  setColour(mode: ColourMode): void {
    this.settings.colour = mode;
    this.changed("colour");
  }

  setTime(time: number): void {
    this.settings.time = Math.max(0, Math.min(this.scene.keyframes.count, time));
    this.changed("time");
  }

  setArrangement(arrangement: Arrangement): void {
    this.frames.arrangement = arrangement;
    this.framesChanged();
    this.changed("arrangement");
  }

  setVisible(map: number, visible: boolean): void {
    this.frames.visible[map] = visible;
    this.framesChanged();
  }

  framesChanged(): void {
    this.frames.update();
    this.changed("frames");
  }

  select(selection: Selection): void {
    this.selection = selection;
    this.changed("selection");
  }

  /** Births up to this are drawn. */
  get now(): number {
    const { time } = this.settings;
    const { count } = this.scene.keyframes;
    return time >= count ? kAllBirths : birthOf(Math.max(0, time - 1), count) - (time === 0 ? 1 : 0);
  }
}

function usualSettings(scene: Scene): Settings {
  const { header, maps } = scene;
  const colour: ColourMode = header.diff ? "status" : header.merged_from.length > 1 ? "origin" : maps.length > 1 ? "map" : "height";
  return {
    colour, theme: "auto", pointSize: 1, frustumSize: 1, minWeight: 30, statuses: 0b11111, time: scene.keyframes.count,
    layers: {
      points: true, trajectory: true, frusta: true, covisibility: false, tree: false, loops: true, merges: true, findings: true,
      moves: true, rays: true, keypoints: true, grid: true,
    },
  };
}

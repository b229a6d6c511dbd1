// Replays the growth of the map: keyframes in the order of time, and points with the keyframe that first saw them.

import { keyframeName, sinceBegin } from "./describe";
import { byId, h, iconButton, iconOf, refill } from "./dom";
import { clamp } from "./maths";
import type { Model } from "./model";
import { mapOfKeyframe } from "./scene";
import type { Stage } from "./stage";

export interface Timeline {
  toggle: () => void;
}

export function buildTimeline(model: Model, stage: Stage): Timeline {
  const { scene, settings } = model;
  const place = byId("timeline");
  const total = scene.keyframes.count;
  const input = h("input", { type: "range", min: 0, max: total, step: 1, value: settings.time, "aria-label": "Keyframes that are there yet", id: "time" });
  const output = h("output", { for: "time" });
  const play = iconButton("play", "Play", () => toggle(), { "aria-keyshortcuts": "Space" });
  let playing = false;
  let from = 0;
  let begin = 0;
  const perSecond = total / clamp(total / 14, 3, 16);

  // Recordings of different days follow each other: of several atlases the name is told.
  const where = (row: number): string => (scene.header.atlases.length > 1 ? `${scene.header.atlases[mapOfKeyframe(scene, row).atlas].name}  \u00b7  ` : "");
  const show = (): void => {
    input.value = String(Math.round(settings.time));
    const at = Math.round(settings.time);
    const last = scene.keyframes.byTime[at - 1];
    const text = at === 0 ? "before the first" : `${where(last)}${keyframeName(scene, last)}  \u00b7  ${sinceBegin(scene, last)}`;
    output.textContent = output.title = text;
    input.setAttribute("aria-valuetext", `${at} of ${total} keyframes, ${text}`);
  };
  const setPlaying = (wanted: boolean): void => {
    playing = wanted;
    refill(play, iconOf(wanted ? "pause" : "play"));
    play.setAttribute("aria-label", wanted ? "Pause" : "Play");
  };
  const step = (now: number): void => {
    if (!playing) return;
    const at = from + ((now - begin) / 1000) * perSecond;
    model.setTime(at);
    if (at >= total) setPlaying(false);
    else requestAnimationFrame(step);
  };
  const toggle = (): void => {
    setPlaying(!playing);
    if (!playing) return;
    from = settings.time >= total ? 0 : settings.time;
    begin = performance.now();
    requestAnimationFrame(step);
  };
  input.addEventListener("input", () => {
    setPlaying(false);
    model.setTime(input.valueAsNumber);
  });
  model.on(["time"], () => {
    show();
    stage.moved();
  });
  refill(place, play, input, output);
  place.hidden = total < 2;
  if (total > 0) show();
  return { toggle };
}

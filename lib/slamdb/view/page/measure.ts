// The measuring tape: from place to place that is clicked, with the length of each part and of all.

import { byId, h } from "./dom";
import { lengthText } from "./format";
import { type Vec3, distance, mixPoints } from "./maths";
import type { Model } from "./model";
import type { Stage } from "./stage";

export class Tape {
  active = false;
  places: Vec3[] = [];
  private labels: HTMLElement[] = [];

  constructor(private readonly model: Model, private readonly stage: Stage, private readonly notice: (text: string) => void) {
    model.on(["theme", "tape"], () => stage.setTape(this.places));
  }

  toggle(): void {
    this.active = !this.active;
    this.stage.canvas.classList.toggle("measuring", this.active);
    if (!this.active) this.clear();
    else this.notice("Click points or keyframes to measure between them; Escape ends.");
    this.model.changed("tape");
  }

  add(place: Vec3): void {
    this.places.push(place);
    this.refill();
    this.notice(this.places.length < 2 ? "Click the second place." : this.text());
  }

  clear(): void {
    this.places = [];
    this.refill();
    this.notice("");
  }

  /** The whole, and of a single part what of it is level and what is height. */
  text(): string {
    const { places } = this;
    const unit = this.model.unit;
    const whole = places.slice(1).reduce((sum, place, i) => sum + distance(places[i], place), 0);
    if (places.length !== 2) return `${lengthText(whole, unit)} in ${places.length - 1} parts`;
    const [a, b] = places;
    return `${lengthText(whole, unit)}: ${lengthText(Math.hypot(b[0] - a[0], b[1] - a[1]), unit)} level, ${lengthText(Math.abs(b[2] - a[2]), unit)} height`;
  }

  /** With each frame: labels go where their lines are. */
  place(): void {
    if (this.labels.length === 0) return;
    const matrix = this.stage.camera.viewProjection();
    this.labels.forEach((label, i) => {
      const at = this.stage.camera.project(mixPoints(this.places[i], this.places[i + 1], 0.5), matrix);
      label.hidden = at === null;
      if (at) [label.style.left, label.style.top] = [`${at.x}px`, `${at.y}px`];
    });
  }

  private refill(): void {
    this.labels = this.places.slice(1).map((place, i) => h("span", {}, lengthText(distance(this.places[i], place), this.model.unit)));
    byId("labels").replaceChildren(...this.labels);
    this.model.changed("tape");
    this.place();
  }
}

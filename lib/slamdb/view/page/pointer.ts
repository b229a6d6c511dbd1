// Mouse, pen and fingers on the picture.

import { placeOf, shortly, visit } from "./describe";
import { byId } from "./dom";
import type { Tape } from "./measure";
import type { Model } from "./model";
import type { Stage } from "./stage";

const kClickReach = 5; // pixels that a hand trembles
const kDoubleMs = 350;

type Place = { x: number; y: number };

export class Pointer {
  private readonly down = new Map<number, Place>();
  private begin: (Place & { moved: boolean }) | null = null;
  private lastClick = { time: -1e9, x: 0, y: 0 };
  private hoverAsked = false;
  private hoverPlace: Place = { x: 0, y: 0 };

  constructor(private readonly model: Model, private readonly stage: Stage, private readonly tape: Tape) {
    const { canvas } = stage;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", (event) => this.cancel(event));
    canvas.addEventListener("pointerleave", () => this.hideHover());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  private press(event: PointerEvent): void {
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.stage.canvas.focus({ preventScroll: true });
    event.preventDefault();
    const place = { x: event.clientX, y: event.clientY };
    this.down.set(event.pointerId, place);
    this.begin = this.down.size === 1 ? { ...place, moved: false } : null;
    this.hideHover();
  }

  private move(event: PointerEvent): void {
    const last = this.down.get(event.pointerId);
    const place = { x: event.clientX, y: event.clientY };
    if (!last) return this.hover(place, event.pointerType);
    if (this.begin && !this.begin.moved) {
      if (Math.hypot(place.x - this.begin.x, place.y - this.begin.y) < kClickReach) return;
      this.begin.moved = true;
      this.stage.canvas.classList.add("turning");
    }
    if (this.down.size === 2) this.pinch(event.pointerId, last, place);
    else if (this.down.size === 1) this.drag(event, place.x - last.x, place.y - last.y);
    this.down.set(event.pointerId, place);
    this.stage.moved();
  }

  private drag(event: PointerEvent, dx: number, dy: number): void {
    const { camera } = this.stage;
    const other = (event.buttons & 6) !== 0 || event.shiftKey || event.ctrlKey;
    if (other !== camera.pose.plan) camera.pan(dx, dy);
    else camera.orbit(dx, dy);
  }

  private pinch(id: number, last: Place, place: Place): void {
    const other = [...this.down].find(([key]) => key !== id)![1];
    const before = Math.hypot(last.x - other.x, last.y - other.y);
    const after = Math.hypot(place.x - other.x, place.y - other.y);
    const { camera } = this.stage;
    camera.pan((place.x - last.x) / 2, (place.y - last.y) / 2);
    if (before > 1 && after > 1) camera.zoom(before / after, (place.x + other.x) / 2, (place.y + other.y) / 2);
  }

  private release(event: PointerEvent): void {
    const click = this.begin !== null && !this.begin.moved && event.button === 0;
    this.cancel(event);
    if (!click) return;
    const { x, y } = { x: event.clientX, y: event.clientY };
    const double = event.timeStamp - this.lastClick.time < kDoubleMs && Math.hypot(x - this.lastClick.x, y - this.lastClick.y) < kClickReach * 2;
    this.lastClick = { time: event.timeStamp, x, y };
    this.click(x, y, double);
  }

  private cancel(event: PointerEvent): void {
    this.down.delete(event.pointerId);
    this.begin = null;
    this.stage.canvas.classList.remove("turning");
  }

  private click(x: number, y: number, double: boolean): void {
    const { model, stage, tape } = this;
    const found = stage.pick(x, y);
    if (tape.active) {
      const place = found ? placeOf(model, found) : stage.camera.pose.plan ? stage.camera.onLevel(x, y, model.frames.bounds().low[2]) : null;
      if (place && !double) tape.add(place);
      return;
    }
    if (found && double) visit(model, stage, found);
    else model.select(found);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 18 : event.deltaMode === 2 ? 300 : 1;
    const speed = event.ctrlKey ? 0.008 : 0.0014;
    this.stage.camera.zoom(Math.exp(Math.max(-240, Math.min(240, event.deltaY * lines)) * speed), event.clientX, event.clientY);
    this.hideHover();
    this.stage.moved();
  }

  /** Names what the pointer rests on: once a frame, and only where picking takes no time. */
  private hover(place: Place, type: string): void {
    this.hoverPlace = place;
    if (this.hoverAsked || type === "touch" || !this.stage.quickPicks) return;
    this.hoverAsked = true;
    setTimeout(() => {
      this.hoverAsked = false;
      if (this.down.size > 0 || !this.stage.resting) return;
      const found = this.stage.pick(this.hoverPlace.x, this.hoverPlace.y);
      const card = byId("hover");
      card.hidden = found === null;
      this.stage.canvas.classList.toggle("over", found !== null);
      if (!found) return;
      card.textContent = shortly(this.model.scene, found);
      const right = this.hoverPlace.x + 14 + card.offsetWidth < innerWidth - 8;
      card.style.left = `${right ? this.hoverPlace.x + 14 : this.hoverPlace.x - 14 - card.offsetWidth}px`;
      card.style.top = `${Math.max(6, this.hoverPlace.y - 34)}px`;
    }, 45);
  }

  private hideHover(): void {
    byId("hover").hidden = true;
    this.stage.canvas.classList.remove("over");
  }
}

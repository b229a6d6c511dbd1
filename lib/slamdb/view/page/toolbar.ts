// The buttons at the right: fit, plan, tape, picture, theme, help.

import { byId, iconButton, iconOf, refill } from "./dom";
import type { Tape } from "./measure";
import type { Model } from "./model";
import { scaleOf } from "./scale_bar";
import type { Stage } from "./stage";

export interface Actions {
  fit: () => void;
  plan: () => void;
  measure: () => void;
  picture: () => void;
  theme: () => void;
  help: () => void;
}

export function buildActions(model: Model, stage: Stage, tape: Tape, notice: (text: string) => void): Actions {
  const plan = (): void => {
    const { pose } = stage.camera;
    if (!pose.plan) {
      // The same place and scale, seen from straight above; all of it where all of it was seen.
      const home = stage.home(true);
      const overview = pose.distance > home.distance * 0.6;
      stage.camera.flyTo(overview ? home : { ...pose, azimuth: home.azimuth, elevation: Math.PI / 2, plan: true }, performance.now());
    } else {
      const home = stage.home();
      stage.camera.flyTo(pose.distance > home.distance * 0.6 ? home : { ...pose, elevation: home.elevation, plan: false }, performance.now());
    }
    stage.moved();
  };
  const theme = (): void => {
    model.settings.theme = stage.theme === "dark" ? "light" : "dark";
    model.changed("theme");
  };
  return {
    fit: () => stage.showAll(), plan, measure: () => tape.toggle(), theme, help: () => toggleHelp(),
    picture: () => void savePicture(model, stage).catch((error: Error) => notice(error.message)),
  };
}

export function buildToolbar(model: Model, stage: Stage, tape: Tape, actions: Actions): void {
  const bar = byId("toolbar");
  const plan = iconButton("plan", "Plan view", actions.plan, { "aria-keyshortcuts": "P", "aria-pressed": "false" });
  const measure = iconButton("tape", "Measuring tape", actions.measure, { "aria-keyshortcuts": "M", "aria-pressed": "false" });
  refill(bar,
    iconButton("fit", "Show all", actions.fit, { "aria-keyshortcuts": "F" }), plan, measure,
    iconButton("picture", "Save a picture", actions.picture, { "aria-keyshortcuts": "S" }),
    iconButton("theme", "Light or dark", actions.theme, { "aria-keyshortcuts": "T" }),
    iconButton("help", "Keys and gestures", actions.help, { "aria-keyshortcuts": "?" }));
  bar.hidden = false;
  let shown = false;
  model.on(["camera", "tape"], () => {
    measure.setAttribute("aria-pressed", String(tape.active));
    if (stage.camera.pose.plan === shown) return;
    shown = stage.camera.pose.plan;
    plan.setAttribute("aria-pressed", String(shown));
    refill(plan, iconOf(shown ? "cube" : "plan"));
  });
}

export function toggleHelp(): void {
  const dialog = byId("help") as HTMLDialogElement;
  if (dialog.open) dialog.close();
  else dialog.showModal();
}

/** The picture with its scale, as a PNG that the browser downloads. */
async function savePicture(model: Model, stage: Stage): Promise<void> {
  const picture = await createImageBitmap(await stage.picture());
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [picture.width, picture.height];
  const context = canvas.getContext("2d")!;
  context.drawImage(picture, 0, 0);
  const ratio = picture.width / stage.camera.width;
  const { pixels, text } = scaleOf(stage.camera.unitsPerPixel(), model.unit);
  context.scale(ratio, ratio);
  context.fillStyle = context.strokeStyle = stage.theme === "dark" ? "#e6eaf0" : "#1d232c";
  context.font = "13px system-ui, sans-serif";
  const right = stage.camera.width - 18, foot = stage.camera.height - 18;
  context.textAlign = "center";
  context.fillText(text, right - pixels / 2, foot - 9);
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(right - pixels, foot - 5);
  context.lineTo(right - pixels, foot);
  context.lineTo(right, foot);
  context.lineTo(right, foot - 5);
  context.stroke();
  const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!blob) throw new Error("The picture could not be made.");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = `${model.scene.header.title.replace(/[^\w.-]+/g, "_").slice(0, 80) || "map"}.png`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

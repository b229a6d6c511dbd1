// Find by id: "kf 12", "mp 530", "12". The same id may be in several maps: asking again goes on to the next.

import { nameOf, visit } from "./describe";
import { announce, h } from "./dom";
import type { Model, Selection } from "./model";
import { type Scene, mapOfKeyframe, mapOfPoint, mapTitle } from "./scene";
import type { Stage } from "./stage";

type Found = NonNullable<Selection>;

/** All that a text may mean, in the order of the scene; null where it is no id. */
export function findIds(scene: Scene, text: string): Found[] | null {
  const match = /^\s*(kf|keyframe|mp|map ?point|point)?\s*[/#:]?\s*(\d+)\s*$/i.exec(text);
  if (!match) return null;
  const id = Number(match[2]);
  const kind = match[1]?.toLowerCase() ?? "";
  const found: Found[] = [];
  const look = (ids: ArrayLike<number>, as: Found["kind"]): void => {
    for (let row = 0; row < ids.length; ++row) {
      if (ids[row] === id) found.push({ kind: as, row });
    }
  };
  if (!/^(mp|map|point)/.test(kind)) look(scene.keyframes.ids, "keyframe");
  if (!/^k/.test(kind)) look(scene.points.ids, "point");
  return found;
}

export function buildSearch(model: Model, stage: Stage): HTMLElement {
  const input = h("input", { type: "search", id: "search", placeholder: "Find kf 12 or mp 530", "aria-label": "Find a keyframe or a point by its id", autocomplete: "off", spellcheck: "false" });
  const answer = h("p", { role: "status" });
  const form = h("form", { role: "search" }, input, answer);
  let last = "";
  let next = 0;
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const found = findIds(model.scene, input.value);
    next = input.value === last ? next + 1 : 0;
    last = input.value;
    answer.textContent = found === null ? "Write kf 12, mp 530 or a number." : found.length === 0 ? `Nothing here has the id ${input.value.trim()}.` : "";
    if (!found || found.length === 0) return;
    const chosen = found[next % found.length];
    visit(model, stage, chosen);
    const map = chosen.kind === "keyframe" ? mapOfKeyframe(model.scene, chosen.row) : mapOfPoint(model.scene, chosen.row);
    const where = `${nameOf(model.scene, chosen)} in ${mapTitle(model.scene, map)}`;
    announce(where);
    if (found.length > 1) answer.textContent = `${where}: ${(next % found.length) + 1} of ${found.length}; Enter goes on.`;
  });
  return form;
}

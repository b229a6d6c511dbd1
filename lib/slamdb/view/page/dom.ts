// Elements of the page. Text goes in as text alone: what maps are called is never markup.

type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | undefined>;

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    element.setAttribute(name, value === true ? "" : String(value));
  }
  append(element, children);
  return element;
}

function append(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(child);
  }
}

export function refill(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

export function button(label: Child, click: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const element = h("button", { type: "button", ...attributes }, label);
  element.addEventListener("click", click);
  return element;
}

/** A button with a picture; its name is read out, and shown with its key where the pointer rests. */
export function iconButton(icon: IconName, name: string, click: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const key = attributes["aria-keyshortcuts"];
  return button(iconOf(icon), click, { class: "icon", "aria-label": name, title: key ? `${name} (${key})` : name, ...attributes });
}

export function checkbox(label: string, checked: boolean, change: (checked: boolean) => void, ...extra: Child[]): HTMLLabelElement {
  const box = h("input", { type: "checkbox", checked });
  box.addEventListener("change", () => change(box.checked));
  return h("label", { class: "check" }, box, h("span", { class: "name" }, label), ...extra);
}

export function slider(label: string, range: { min: number; max: number; step: number; value: number }, text: (value: number) => string, input: (value: number) => void): HTMLElement {
  const box = h("input", { type: "range", ...range });
  const output = h("output", {}, text(range.value));
  box.addEventListener("input", () => {
    output.textContent = text(box.valueAsNumber);
    input(box.valueAsNumber);
  });
  return h("label", { class: "slider" }, h("span", { class: "name" }, label), box, output);
}

export function swatch(colour: string): HTMLElement {
  const element = h("span", { class: "swatch", "aria-hidden": "true" });
  element.style.background = colour;
  return element;
}

export function section(title: string, open: boolean, ...children: Child[]): HTMLDetailsElement {
  return h("details", { open }, h("summary", {}, h("h2", {}, title)), h("div", { class: "body" }, ...children));
}

export function rows(entries: [string, Child][]): HTMLElement {
  const list = h("dl");
  for (const [label, value] of entries) list.append(h("dt", {}, label), h("dd", {}, value));
  return list;
}

const kIcons = {
  fit: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4M6 6h4v4H6z",
  plan: "M2 2h12v12H2zM2 6.7h12M2 10.3h12M6.7 2v12M10.3 2v12",
  cube: "M8 1.8 13.5 5v6L8 14.2 2.5 11V5zM2.5 5 8 8.2 13.5 5M8 8.2v6",
  tape: "M1.5 10.5 10.5 1.5l4 4-9 9zM4.2 8.2l1.6 1.6M6.4 6l2.2 2.2M8.6 3.8l1.6 1.6",
  picture: "M2 4.5h3l1-1.5h4l1 1.5h3v8.5H2zM8 11a2.6 2.6 0 1 0 0-5.2A2.6 2.6 0 0 0 8 11z",
  theme: "M8 2a6 6 0 1 0 0 12zM8 2a6 6 0 0 1 0 12",
  help: "M6 6a2 2 0 1 1 2.9 1.8c-.6.3-.9.7-.9 1.4v.3M8 12v.1M8 1.8a6.2 6.2 0 1 0 0 12.4A6.2 6.2 0 0 0 8 1.8z",
  panel: "M2 3h12v10H2zM6 3v10",
  play: "M4.5 2.5v11l9-5.5z",
  pause: "M4.5 3v10M11 3v10",
  close: "M3.5 3.5l9 9M12.5 3.5l-9 9",
  fly: "M14 2 2 7.2l5 1.8 1.8 5z",
  copy: "M6 6h8v8H6zM10 6V2H2v8h4",
  back: "M10 3 5 8l5 5",
  forward: "M6 3l5 5-5 5",
} as const;
export type IconName = keyof typeof kIcons;

export function iconOf(name: IconName): SVGSVGElement {
  const kSvg = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(kSvg, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(kSvg, "path");
  path.setAttribute("d", kIcons[name]);
  svg.append(path);
  return svg;
}

/** Says something to those who do not see the picture. */
export function announce(text: string): void {
  const place = document.getElementById("announcer");
  if (place) place.textContent = text;
}

export const byId = (id: string): HTMLElement => {
  const element = document.getElementById(id);
  if (!element) throw new Error(`The page has no element ${id}.`);
  return element;
};

export async function copyText(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from files may not have the clipboard: the old way works there.
    const area = h("textarea", { "aria-hidden": "true", class: "off-screen" });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  announce(`Copied ${text}`);
}

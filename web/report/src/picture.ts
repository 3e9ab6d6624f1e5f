// A figure as a file of its own: as SVG, on paper (and so as PDF), and its numbers as CSV.
import { h, svg } from "@mbk/shared/dom";
import { download } from "@mbk/shared/sheet";

/** What decides how a shape looks, with what it is where nothing says otherwise. */
const looks: Record<string, string> = {
  fill: "rgb(0, 0, 0)", "fill-opacity": "1", stroke: "none", "stroke-width": "1px", "stroke-opacity": "1", "stroke-dasharray": "none",
  "stroke-linejoin": "miter", "stroke-linecap": "butt", opacity: "1", "paint-order": "normal",
};
const lettering: Record<string, string> = { "font-family": "", "font-size": "", "font-weight": "400", "text-anchor": "start", "dominant-baseline": "auto" };
const holders = new Set(["svg", "g", "defs", "clipPath", "title", "desc"]);

/** A copy that needs no style sheet. */
function freed(drawing: SVGSVGElement): SVGSVGElement {
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  const copies = [copy, ...copy.querySelectorAll<SVGElement>("*")];
  [drawing, ...drawing.querySelectorAll<SVGElement>("*")].forEach((element, k) => {
    const to = copies[k] as SVGElement;
    const style = getComputedStyle(element);
    const said = holders.has(element.tagName) ? { opacity: "1" } : element.tagName === "text" || element.tagName === "tspan" ? { ...looks, ...lettering } : looks;
    for (const name of ["class", "style", "role", "aria-label", "aria-hidden", "tabindex"]) to.removeAttribute(name);
    for (const [name, usual] of Object.entries(said)) {
      const value = style.getPropertyValue(name);
      if (value === usual) to.removeAttribute(name);
      else to.setAttribute(name, value);
    }
  });
  return copy;
}

interface Line {
  text: string;
  left: number;
  top: number;
  bottom: number;
  style: CSSStyleDeclaration;
}

/** The lines of an element's text, as they stand on the screen. */
function linesOf(element: Element): Line[] {
  const lines: Line[] = [];
  const walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const style = getComputedStyle(node.parentElement as Element);
    for (const word of (node.textContent ?? "").matchAll(/\S+\s*/g)) {
      const range = document.createRange();
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].trimEnd().length);
      const { left, top, bottom } = range.getBoundingClientRect();
      const last = lines.at(-1);
      if (last && Math.abs(last.top - top) < 3) last.text += word[0];
      else lines.push({ text: word[0], left, top, bottom, style });
    }
  }
  return lines.filter(({ top, bottom }) => bottom > top);
}

const ascent = 0.79; // of a line's height
const margin = 8;

/** Drawings, legend and names of a figure as one drawing, each at its place: as on paper, whatever the screen looks like. */
function pictureOf(figure: HTMLElement, title: string): SVGSVGElement {
  const drawings = [...figure.querySelectorAll<SVGSVGElement>("svg")].filter((one) => !one.parentElement?.closest("svg"));
  const boxes: DOMRect[] = [];
  const content = svg("g");
  for (const drawing of drawings) {
    const box = drawing.getBoundingClientRect();
    if (box.width === 0 || box.height === 0) continue;
    boxes.push(box);
    const copy = freed(drawing);
    for (const [name, value] of Object.entries({ x: box.left, y: box.top, width: box.width, height: box.height })) copy.setAttribute(name, value.toFixed(1));
    content.append(copy);
  }
  for (const element of figure.querySelectorAll(".legend li, .panel-title, .panel-name, .panel-note")) {
    if (element.closest(".data-table, figcaption")) continue;
    for (const { text, left, top, bottom, style } of linesOf(element)) {
      boxes.push(new DOMRect(left, top, 7 * text.length, bottom - top));
      content.append(svg("text", {
        x: left.toFixed(1), y: (top + ascent * (bottom - top)).toFixed(1), fill: style.color,
        "font-family": style.fontFamily, "font-size": style.fontSize, "font-weight": style.fontWeight,
      }, text.trimEnd()));
    }
  }
  const left = Math.min(...boxes.map((box) => box.left)) - margin;
  const top = Math.min(...boxes.map((box) => box.top)) - margin;
  const width = Math.ceil(Math.max(...boxes.map((box) => box.right)) + margin - left);
  const height = Math.ceil(Math.max(...boxes.map((box) => box.bottom)) + margin - top);
  content.setAttribute("transform", `translate(${(-left).toFixed(1)} ${(-top).toFixed(1)})`);
  return svg("svg", { xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}` },
    svg("title", {}, title), svg("rect", { width, height, fill: "#fff" }), content);
}

/** How the figure is made ready for it, and put back. */
export type Around = <T>(act: () => T) => T;

/** Does it while the page has the colours of paper, whatever the screen has. */
function inLight<T>(act: () => T): T {
  const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules])
    .filter((rule): rule is CSSMediaRule => rule instanceof CSSMediaRule && rule.media.mediaText.includes("prefers-color-scheme"));
  const medias = rules.map(({ media }) => media.mediaText);
  for (const { media } of rules) media.mediaText = "not all";
  try {
    return act();
  } finally {
    rules.forEach(({ media }, k) => (media.mediaText = medias[k] ?? "not all"));
  }
}

function printed(picture: SVGSVGElement, title: string): void {
  const frame = h("iframe", { title, "aria-hidden": true, tabindex: -1, class: "printing" });
  frame.addEventListener("load", () => {
    const page = frame.contentWindow;
    if (!page) return;
    page.document.title = title;
    page.document.body.style.margin = "0";
    const drawing = page.document.importNode(picture, true);
    drawing.style.cssText = "max-width: 100%; height: auto";
    page.document.body.append(drawing);
    page.addEventListener("afterprint", () => frame.remove());
    page.print();
  }, { once: true });
  document.body.append(frame);
}

export interface Saved {
  /** Of the file, without its ending. */
  name: string;
  title: string;
  csv: () => string;
  around?: Around;
}

/** Buttons that save or print the figure that they stand in. */
export function savingButtons({ name, title, csv, around = (act) => act() }: Saved): HTMLElement[] {
  const button = (text: string, act: (figure: HTMLElement) => void) => {
    const made = h("button", { type: "button", "aria-label": `${text}: ${title}` }, text);
    made.addEventListener("click", () => act(made.closest("figure") as HTMLElement));
    return made;
  };
  const picture = (figure: HTMLElement) => around(() => inLight(() => pictureOf(figure, title)));
  return [
    button("Save SVG", (figure) => download(`${name}.svg`, new XMLSerializer().serializeToString(picture(figure)), "image/svg+xml")),
    button("Print, save PDF", (figure) => printed(picture(figure), title)),
    button("Save CSV", () => download(`${name}.csv`, csv())),
  ];
}

/** The figure with those buttons, above its caption. */
export function saveable<F extends HTMLElement | undefined>(figure: F, saved: Saved): F {
  if (!figure) return figure;
  const tools = h("div", { class: "tools", role: "group", "aria-label": `Tools: ${saved.title}` }, ...savingButtons(saved));
  const caption = figure.querySelector(":scope > figcaption");
  if (caption) caption.before(tools);
  else figure.append(tools);
  return figure;
}

// Which page controls: every page says it, and one that may control offers to take it.
import type { State, You } from "@mbk/shared/documents";
import { h } from "@mbk/shared/dom";
import { text } from "./words";

const watching = {
  elsewhere: "another page has control.",
  kept: "control is reserved for a few seconds for the page that was closed or is reloading.",
  nobody: "no page has control.",
};

export class ControlLine {
  readonly element = h("div", { class: "control", role: "status" });
  private readonly sign = h("span", { class: "control-sign", "aria-hidden": true });
  private readonly words = h("p", {});
  private readonly take = h("button", { type: "button", class: "take-control" }, "Take control");

  constructor(takeControl: () => void) {
    this.take.addEventListener("click", takeControl);
    this.element.append(this.sign, this.words, this.take);
  }

  show(you: You, connected: boolean, state: State | undefined): void {
    const here = you.control === "here";
    this.element.hidden = !connected || !state || state.over;
    this.element.classList.toggle("watches", !here);
    text(this.sign, here ? "●" : "○");
    text(this.words, here ? this.controls(state) : this.watches(you));
    this.take.hidden = here || !you.may_control;
  }

  private controls(state: State | undefined): string {
    const others = (state?.viewers ?? 1) - 1;
    return `This page has control.${others > 0 ? ` ${others} other ${others === 1 ? "page is" : "pages are"} open.` : ""}`;
  }

  private watches({ control, may_control }: You): string {
    const why = control === "here" ? "" : watching[control];
    const way = may_control ? "" : " To take control, open the console address that mbk run printed.";
    return `This page is for viewing only: ${why} STOP and the space bar also work here.${way}`;
  }
}

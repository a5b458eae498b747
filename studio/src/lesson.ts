import { element } from "./player";

export interface Step {
  title: string;
  text: string;
  scenario: string;
  beside?: string;
  do: string;
  contact?: string;
  expect: [string, string][]; // what is read, and its number
  pace?: number; // how fast a run is played
  larger?: number; // by how much its displacements are exaggerated
}

/** A story in steps. */
export class Lesson {
  private steps: Step[] = [];
  private now = -1; // none is shown

  constructor(
    private place: HTMLElement,
    private begin: (step: Step) => Promise<void>,
  ) {}

  learn(steps: Step[]): void {
    this.steps = steps;
    this.draw();
  }

  async go(k: number): Promise<void> {
    await this.begin(this.steps[Math.max(0, Math.min(k, this.steps.length - 1))]);
  }

  /** Show the text of the step whose picture is shown; none if the picture is of something else. */
  show(step?: Step): void {
    this.now = step ? this.steps.indexOf(step) : -1;
    this.draw();
  }

  private draw(): void {
    const step = this.steps[this.now];
    const list = element("ol", { class: "steps", "aria-label": "Steps" });
    this.steps.forEach((one, k) => {
      const button = element(
        "button",
        { type: "button", class: "icon", title: one.title, "aria-label": `Step ${k + 1}: ${one.title}` },
        `${k + 1}`,
      );
      if (k === this.now) button.setAttribute("aria-current", "step");
      button.onclick = () => this.go(k);
      list.append(element("li", {}, button));
    });
    const intro = element("p", { class: "hint" }, "Walking the line, in five steps");
    if (!step) return this.place.replaceChildren(intro, list, element("p", {}, "Choose a step to open its picture."));
    const next = element("button", { type: "button", class: "main" }, "Next");
    next.disabled = this.now === this.steps.length - 1;
    next.onclick = () => this.go(this.now + 1);
    this.place.replaceChildren(
      intro,
      list,
      element("h2", {}, `${this.now + 1}. ${step.title}`),
      element("p", {}, step.text),
      element("h2", {}, "To be read"),
      element(
        "dl",
        { class: "numbers" },
        ...step.expect.flatMap(([what, number]) => [element("dt", {}, what), element("dd", {}, number)]),
      ),
      element("p", {}, next),
    );
  }
}

import { button, element, pairs } from "./dom";

export interface Step {
  name: string;
  title: string;
  text: string;
  question: string;
  answer: string;
  expect: [string, string][]; // quantities of the answer, and their numbers
  scenario: string;
  beside?: string;
  pace: number; // how fast a run is played
}

/** Lessons with a question each, whose answer is folded until the reader opens it. */
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
    const list = element("ol", { class: "steps", "aria-label": "Lessons" });
    this.steps.forEach((one, k) => {
      const about = { title: one.title, "aria-label": `Lesson ${k + 1}: ${one.title}` };
      const made = button(`${k + 1}`, () => this.go(k), { class: "icon", ...about });
      if (k === this.now) made.setAttribute("aria-current", "step");
      list.append(element("li", {}, made));
    });
    if (!step) return this.place.replaceChildren(list, element("p", {}, "Choose a lesson to open its picture."));
    const next = button("Next lesson", () => this.go(this.now + 1));
    next.disabled = this.now === this.steps.length - 1;
    const answer = element(
      "details",
      {},
      element("summary", {}, "Show the answer"),
      element("p", {}, step.answer),
      element("dl", { class: "numbers" }, ...pairs(step.expect)),
    );
    this.place.replaceChildren(
      list,
      element("h2", {}, `${this.now + 1}. ${step.title}`),
      element("p", {}, step.text),
      element("p", { class: "question" }, element("strong", {}, step.question)),
      answer,
      element("p", {}, next),
    );
  }
}

import { autocompletion, type CompletionContext, type CompletionResult } from "@codemirror/autocomplete";
import { indentWithTab, isolateHistory, redo, undo } from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import { HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { EditorState } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { basicSetup } from "codemirror";
import { difference } from "./edits";
import { completions, type Schema } from "./schema";

const COLOURS = HighlightStyle.define([
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: "var(--accent)" },
  { tag: [tags.string, tags.special(tags.string)], color: "var(--load)" },
  { tag: [tags.comment, tags.meta, tags.punctuation], color: "var(--faint)" },
]);

export interface Problem {
  line: number | null;
  key: string;
  message: string;
}

/** The scenario as text, with completion from the schema and mistakes at their lines. */
export class Editor {
  private view: EditorView;
  schema?: Schema; // for completion

  constructor(
    place: HTMLElement,
    private changed: () => void,
  ) {
    this.view = new EditorView({ parent: place, state: this.state("") });
  }

  private state(text: string): EditorState {
    return EditorState.create({
      doc: text,
      extensions: [
        basicSetup,
        yaml(),
        syntaxHighlighting(COLOURS),
        lintGutter(),
        keymap.of([indentWithTab]),
        autocompletion({ override: [(context) => this.complete(context)] }),
        EditorView.contentAttributes.of({ "aria-label": "Scenario in YAML", tabindex: "0" }),
        EditorView.updateListener.of((update) => {
          if (update.docChanged) this.changed();
        }),
      ],
    });
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  set text(text: string) {
    this.view.setState(this.state(text));
  }

  /** The text as it is after a change by other means than typing; one step for `undo`. */
  change(text: string): void {
    this.view.dispatch({
      changes: difference(this.text, text),
      annotations: isolateHistory.of("full"),
      userEvent: "input.form",
    });
  }

  undo(): void {
    undo(this.view);
  }

  redo(): void {
    redo(this.view);
  }

  show(problems: Problem[]): void {
    const found: Diagnostic[] = problems.map((problem) => {
      const line = this.line(problem.line ?? 1);
      const indent = line.text.length - line.text.trimStart().length;
      return { from: line.from + indent, to: line.to, severity: "error", message: problem.message };
    });
    this.view.dispatch(setDiagnostics(this.view.state, found));
  }

  goTo(line: number): void {
    this.view.dispatch({ selection: { anchor: this.line(line).from }, scrollIntoView: true });
    this.view.focus();
  }

  private line(number: number) {
    const { doc } = this.view.state;
    return doc.line(Math.min(Math.max(number, 1), doc.lines));
  }

  private complete(context: CompletionContext): CompletionResult | null {
    const word = context.matchBefore(/[\w-]*/);
    if (!this.schema || !word || (word.from === word.to && !context.explicit)) return null;
    const before = context.state.sliceDoc(0, word.from);
    const options = completions(this.schema, before);
    return options.length ? { from: word.from, options } : null;
  }
}

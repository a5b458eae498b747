import type { Frame, Layout } from "./film";
import { type Quantity, type Shown, said } from "./picture";
import { dot, label, line, type Pen } from "./symbols";
import { short, ticks } from "./units";

interface Place {
  left: number;
  right: number;
  top: number;
  height: number;
}

interface Values {
  layout: Layout;
  frame: Frame;
  envelope?: { low: Float32Array; high: Float32Array };
  across: (node: number) => number; // pixels
}

/** A quantity along lines, below them: its curve, its largest values so far (dashed), and its extreme value now. */
export function diagram(
  pen: Pen,
  place: Place,
  quantity: Quantity,
  shown: Shown,
  { layout, frame, envelope, across }: Values,
): void {
  const { ink, colour } = pen;
  const values = frame[quantity.name];
  if (!values) return;
  const [low, high] = [Math.min(shown.low, 0), Math.max(shown.high, 0)];
  const [top, scale] = [place.top + 24, (place.height - 32) / (high - low || 1)];
  const up = (value: number) => top + scale * (quantity.down ? value - low : high - value);
  ink.textAlign = "right";
  ink.lineWidth = 1;
  for (const value of ticks(low, high, 4)) {
    ink.strokeStyle = colour(value === 0 ? "--faint" : "--grid");
    line(ink, [place.left, up(value)], [place.right, up(value)]);
    ink.fillStyle = colour("--faint");
    ink.fillText(short(value), place.left - 5, up(value) + 4);
  }
  ink.textAlign = "left";
  ink.fillStyle = colour("--ink");
  ink.fillText(`${quantity.label} (${shown.unit.replace("*", " ")})`, 8, place.top + 10);
  ink.save();
  ink.beginPath();
  ink.rect(place.left, place.top, place.right - place.left, place.height);
  ink.clip();
  let extreme = -1;
  for (const [name, first, count] of layout.nodes) {
    if (quantity.lines.length && !quantity.lines.includes(name)) continue;
    const curve = (of: Float32Array) => {
      ink.beginPath();
      for (let i = first; i < first + count; i++)
        if (Number.isFinite(of[i])) ink.lineTo(across(i), up(of[i] / shown.size));
    };
    ink.setLineDash([4, 4]);
    ink.strokeStyle = colour("--faint");
    for (const of of envelope ? [envelope.low, envelope.high] : []) {
      curve(of);
      ink.stroke();
    }
    ink.setLineDash([]);
    curve(values);
    ink.strokeStyle = colour("--accent");
    ink.lineWidth = 2;
    ink.stroke();
    ink.lineTo(across(first + count - 1), up(0));
    ink.lineTo(across(first), up(0));
    ink.globalAlpha = 0.15;
    ink.fillStyle = colour("--accent");
    ink.fill();
    ink.globalAlpha = ink.lineWidth = 1;
    for (let i = first; i < first + count; i++) {
      const seen = across(i) >= place.left && across(i) <= place.right;
      if (seen && Math.abs(values[i]) > (extreme < 0 ? 0 : Math.abs(values[extreme]))) extreme = i;
    }
  }
  if (extreme >= 0) {
    const [x, y] = [across(extreme), up(values[extreme] / shown.size)];
    const text = said(values[extreme] / shown.size, shown);
    ink.fillStyle = colour("--ink");
    dot(ink, [x, y], 3.5);
    const left = Math.min(x + 8, place.right - ink.measureText(text).width - 4);
    label(pen, text, [left, y > place.top + place.height / 2 ? y - 8 : y + 16], colour("--ink"));
  }
  ink.restore();
}

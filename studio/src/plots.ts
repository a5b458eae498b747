import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { coloursOf } from "./dom";
import type { Film } from "./film";
import { ends } from "./units";

const KEY = "ropewalk";
const LABELLED = 12; // most loads whose forces are shown

interface Curve {
  name: string;
  values: number[];
  colour: string;
}

/** Curves over time beside the picture, that share its cursor. */
export class Plots {
  private plots: uPlot[] = [];
  private version = -1;
  private now = 0;

  constructor(
    private place: HTMLElement,
    private chosen: (path: number) => void,
  ) {
    new ResizeObserver(() => this.resize()).observe(place);
  }

  private size(): { width: number; height: number } {
    const count = Math.max(this.plots.length, 3);
    return {
      width: Math.max(210, Math.floor(this.place.clientWidth / count) - 8),
      height: Math.max(80, this.place.clientHeight - 30),
    };
  }

  private resize(): void {
    for (const plot of this.plots) plot.setSize(this.size());
  }

  clear(): void {
    for (const plot of this.plots) plot.destroy();
    this.plots = [];
    this.place.replaceChildren();
    this.version = -1;
  }

  /** Draw anew if frames have come. */
  update(film: Film, beside?: Film): void {
    const version = film.version + 1e6 * (beside?.version ?? 0);
    if (version === this.version || film.count < 2 || !this.place.isConnected) return; // colours come with the page
    this.version = version;
    const x = Array.from(film.path.subarray(0, film.count));
    const colour = coloursOf(this.place);
    const groups = curves(film, colour, "");
    for (const [g, group] of (beside && beside.count > 1 ? curves(beside, colour, "beside: ") : []).entries())
      for (const { name, values } of group.curves) {
        const there = x.map((path) => (beside && path <= beside.end + 1e-9 ? values[beside.at(path)] : Number.NaN));
        groups[g]?.curves.push({ name, values: there, colour: colour("--beside") });
      }
    if (
      this.plots.length !== groups.length ||
      this.plots.some((p, g) => p.series.length !== groups[g].curves.length + 1)
    ) {
      this.clear();
      this.version = version;
      const label = film.layout.path === "time" ? "t (s)" : "path (m)";
      this.plots = groups.map((group) => this.made(group.title, label, group.curves, colour));
      this.resize(); // now that all are there
    }
    this.plots.forEach((plot, g) => {
      plot.setData([
        x,
        ...groups[g].curves.map((c) => c.values.map((v) => (Number.isFinite(v) ? v : null))),
      ] as uPlot.AlignedData);
    });
  }

  private made(title: string, label: string, group: Curve[], colour: (name: string) => string): uPlot {
    const axis = {
      stroke: colour("--faint"),
      grid: { stroke: colour("--grid"), width: 1 },
      ticks: { show: false },
      font: "11px system-ui",
      labelFont: "11px system-ui",
    };
    const options: uPlot.Options = {
      ...this.size(),
      title,
      cursor: { sync: { key: KEY }, drag: { x: false, y: false } },
      legend: { show: false },
      scales: { x: { time: false } },
      axes: [
        { ...axis, label, labelSize: 16, size: 26 },
        { ...axis, size: 48 },
      ],
      series: [{}, ...group.map((c) => ({ label: c.name, stroke: c.colour, width: 1.5, points: { show: false } }))],
      hooks: { draw: [(plot) => this.mark(plot, colour("--ink"))] },
    };
    const box = document.createElement("figure");
    this.place.append(box);
    const plot = new uPlot(options, [[]], box);
    plot.over.addEventListener("click", (event) => this.chosen(plot.posToVal(event.offsetX, "x")));
    box.setAttribute("aria-label", title);
    return plot;
  }

  private mark(plot: uPlot, stroke: string): void {
    const x = plot.valToPos(this.now, "x", true);
    if (!(x >= plot.bbox.left && x <= plot.bbox.left + plot.bbox.width)) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = stroke;
    plot.ctx.globalAlpha = 0.5;
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, plot.bbox.top);
    plot.ctx.lineTo(x, plot.bbox.top + plot.bbox.height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  cursor(path: number): void {
    if (path === this.now) return;
    this.now = path;
    for (const plot of this.plots) plot.redraw(false, false);
  }
}

function curves(film: Film, colour: (name: string) => string, prefix: string): { title: string; curves: Curve[] }[] {
  const axes = film.layout.axes.length;
  const loads = film.layout.loads.slice(0, 6);
  const tints = [colour("--load"), colour("--hold"), "#009e73", "#e69f00", "#cc79a7", "#56b4e9"];
  const scale = film.picture.around === null ? -1e-3 : 1; // kN downwards, or N upwards under an overhead line
  const found: { title: string; curves: Curve[] }[] = [];
  const add = (title: string, curves: (readonly [name: string, values: number[], colour?: string])[]) => {
    const tinted = curves.map(([name, values, own], k) => [prefix + name, values, own ?? tints[k % 6]] as const);
    found.push({ title, curves: tinted.map(([name, values, colour]) => ({ name, values, colour })) });
  };
  /** A component of the loads, upwards. */
  const upwards = (name: string, size: number) =>
    loads.map((load, k) => [load, film.series(`${name} ${k}`, (f) => size * f[name][k * axes + axes - 1])] as const);
  for (const { quantity, unit, curves } of film.curves.groups) {
    const symbol = unit.replace("*", " ").replace("^2", "²");
    const own = Object.entries(curves).map(([name, values]) => [name, shownOf(film, values)] as const);
    add(`${quantity} (${symbol}): ${Object.keys(curves).join(", ")}`, own);
  }
  const { colour: quantity, diagrams } = film.picture;
  const shown = quantity && film.state.ranges[quantity.name];
  if (quantity && shown && !found.some(({ title }) => title.startsWith(quantity.label))) {
    const most = film.series(quantity.name, (f) => ends(f[quantity.name])[1]).map((value) => value / shown.size);
    add(`largest ${quantity.label} (${shown.unit})`, [[quantity.label, most, colour("--accent")]]);
  }
  const title = scale > 0 ? "contact force, upwards (N)" : "contact force, downwards (kN)";
  if (loads.length && film.layout.loads.length <= LABELLED) add(title, upwards("contact_force", scale));
  if (loads.length && !diagrams.length) add("path of the load, z (m)", upwards("contact_position", 1));
  if (film.has("energy") && film.layout.path === "time") {
    const energy = (name: string) => {
      const at = film.energies.indexOf(name);
      return film.series(name, (f) => f.energy[at]);
    };
    const [kinetic, residual] = ["kinetic", "imbalance"].map(energy);
    const curves = [
      ["kinetic", kinetic, colour("--accent")] as const,
      ["residual", residual, colour("--load")] as const,
    ];
    add("energy (J): kinetic, residual", curves);
  }
  return found;
}

/** The values of a curve over all frames of a result at those that are shown. */
function shownOf({ path, count, curves }: Film, values: (number | null)[]): number[] {
  let k = 0;
  return Array.from(path.subarray(0, count), (at) => {
    while (k < curves.path.length - 1 && curves.path[k] < at - 1e-6 * (1 + at)) k++;
    return values[k] ?? Number.NaN;
  });
}

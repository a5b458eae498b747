import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GridHelper,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  OrthographicCamera,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { stepOf, steps } from "./colours";
import type { Frame, Layout } from "./film";
import { boxOf, turned, VIEWS } from "./orbit";
import { type Quantity, type Shown, valuesAlong } from "./picture";
import { element } from "./player";
import "./space.css";
import { ticks, written } from "./units";

/** What is drawn: nodes in m (exaggerated where that is asked), and what they are coloured by. */
export interface Drawn {
  layout: Layout;
  position: Float32Array;
  frame: Frame;
  colour: Quantity | null;
  shown: Shown | null; // range of the colours
  floor: number; // m, how high it lies
  beside?: { layout: Layout; position: Float32Array };
}

type Colour = (name: string) => string;

/** Lines and nets in space, seen by a camera that goes around them; what is written over them is the stage's. */
export class Space {
  private renderer: WebGLRenderer;
  private scene = new Scene();
  private perspective = new PerspectiveCamera(35, 1, 0.01, 1000);
  private parallel = new OrthographicCamera(-1, 1, 1, -1, 0.01, 1000);
  private camera: PerspectiveCamera | OrthographicCamera = this.perspective;
  private controls: OrbitControls;
  private bar = element("div", { class: "cameras", role: "group", "aria-label": "Camera" });
  private ropes = new Ropes();
  private others = new Ropes();
  private net = new Net();
  private otherNet = new Net();
  private floor?: GridHelper;
  private layout?: Layout;
  private radius = 1;
  private size: [number, number] = [1, 1]; // pixels
  private spacing = 1;
  private closing = new AbortController();

  constructor(
    over: HTMLCanvasElement,
    private changed: () => void,
  ) {
    const canvas = element("canvas", { class: "space", "aria-hidden": "true" });
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    over.before(canvas);
    over.after(this.bar);
    for (const camera of [this.perspective, this.parallel]) camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, over);
    this.controls.addEventListener("change", this.changed);
    this.scene.add(this.net.surface, this.net.threads, this.otherNet.threads, this.ropes.drawn, this.others.drawn);
    for (const name of Object.keys(VIEWS)) {
      const button = element("button", { type: "button", title: VIEWS[name].title }, name);
      button.onclick = () => this.look(name);
      this.bar.append(button);
    }
    over.addEventListener("keydown", (event) => this.key(event), { signal: this.closing.signal });
  }

  get isShown(): boolean {
    return !this.bar.hidden;
  }

  set isShown(shown: boolean) {
    if (shown === this.isShown) return;
    this.renderer.domElement.hidden = this.bar.hidden = !shown;
    this.controls.enabled = shown;
  }

  close(): void {
    this.closing.abort();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // a browser has few of them
    this.renderer.domElement.remove();
    this.bar.remove();
  }

  /** Look at all of it from one of the directions of `VIEWS`. */
  private look(name: string): void {
    const { direction, isParallel } = VIEWS[name];
    this.camera = isParallel ? this.parallel : this.perspective;
    const away = this.radius * (isParallel ? 4 : 0.9 / Math.sin(((this.perspective.fov / 2) * Math.PI) / 180));
    this.controls.object = this.camera;
    this.controls.enableRotate = !isParallel;
    this.camera.zoom = 1;
    this.camera.position
      .set(...direction)
      .setLength(away)
      .add(this.controls.target);
    for (const button of this.bar.querySelectorAll("button"))
      button.setAttribute("aria-pressed", `${button.textContent === name}`);
    this.controls.update();
    this.changed();
  }

  private key(event: KeyboardEvent): void {
    if (!this.isShown) return;
    const step = Math.PI / 36;
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-step, 0],
      ArrowRight: [step, 0],
      ArrowUp: [0, -step],
      ArrowDown: [0, step],
    };
    const turn = event.shiftKey ? turns[event.key] : undefined;
    const nearer = { "+": 1.1, "-": 1 / 1.1 }[event.key];
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target);
    if (turn && this.controls.enableRotate) offset.set(...turned(offset.toArray(), ...turn));
    else if (nearer && this.camera === this.perspective) offset.divideScalar(nearer);
    else if (nearer) this.camera.zoom *= nearer;
    else return;
    this.camera.position.copy(target).add(offset);
    this.controls.update();
    this.changed();
    event.preventDefault();
    event.stopPropagation(); // arrow keys alone step through time
  }

  /** Draw, above so many pixels that are left free. */
  draw(drawn: Drawn, width: number, height: number, free: number, colour: Colour): void {
    this.isShown = true;
    this.size = [width, height - free];
    const aspect = width / (height - free);
    if (this.layout !== drawn.layout) this.begin(drawn, aspect, colour);
    this.ropes.set(drawn, colour);
    this.net.set(drawn, colour);
    const { beside } = drawn;
    if (beside) {
      const other = { ...drawn, ...beside, frame: {} };
      this.others.set(other, colour);
      this.otherNet.set(other, colour);
    }
    this.others.drawn.visible = this.otherNet.threads.visible = beside !== undefined;
    this.renderer.setPixelRatio(devicePixelRatio || 1);
    this.renderer.setSize(width, height, false);
    this.renderer.setViewport(0, free, ...this.size);
    this.framed(aspect);
    this.floor?.position.setZ(drawn.floor);
    this.renderer.render(this.scene, this.camera);
  }

  private begin({ layout, position }: Drawn, aspect: number, colour: Colour): void {
    this.layout = layout;
    const [low, high] = boxOf(position);
    const [a, b] = [new Vector3(...low), new Vector3(...high)];
    this.radius = Math.max(0.5 * a.distanceTo(b), 1e-6) / Math.min(1, aspect);
    this.controls.target.copy(a).add(b).multiplyScalar(0.5);
    const side = 2.4 * Math.max(b.x - a.x, b.y - a.y);
    const marks = ticks(0, side, 12);
    this.spacing = marks[1] - marks[0];
    const count = 2 * Math.ceil(side / this.spacing / 2);
    if (this.floor) this.scene.remove(this.floor);
    this.floor = new GridHelper(count * this.spacing, count, new Color(colour("--grid")), new Color(colour("--grid")));
    this.floor.rotation.x = Math.PI / 2;
    const round = (value: number) => Math.round(value / this.spacing) * this.spacing;
    const { x, y } = this.controls.target;
    this.floor.position.set(round(x), round(y), a.z);
    this.scene.add(this.floor);
    this.look("Perspective");
  }

  private framed(aspect: number): void {
    const { radius, parallel, perspective } = this;
    const away = this.camera.position.distanceTo(this.controls.target);
    for (const camera of [perspective, parallel]) {
      camera.near = Math.max(away - 20 * radius, 0.01 * radius);
      camera.far = away + 20 * radius;
    }
    perspective.aspect = aspect;
    [parallel.top, parallel.bottom, parallel.right, parallel.left] = [
      radius,
      -radius,
      radius * aspect,
      -radius * aspect,
    ];
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  /** Where a place in space is in the picture, in pixels. */
  pixel(place: [number, number, number]): [number, number] {
    const [width, height] = this.size;
    const { x, y } = new Vector3(...place).project(this.camera);
    return [(0.5 + 0.5 * x) * width, (0.5 - 0.5 * y) * height];
  }

  /** Where the axes point to in the picture, as [name, right, up], and how wide the squares of the floor are. */
  axes(): { ways: [string, number, number][]; floor: string } {
    const seen = new Vector3();
    const ways = ["x", "y", "z"].map((name, a): [string, number, number] => {
      seen.set(+(a === 0), +(a === 1), +(a === 2)).transformDirection(this.camera.matrixWorldInverse);
      return [name, seen.x, seen.y];
    });
    return { ways, floor: `squares of ${written(this.spacing, "m")}` };
  }
}

/** Segments of lines, as wide as they are in the plane. */
class Ropes {
  drawn = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: 3.5, vertexColors: true }));
  private places = new Float32Array(0);
  private tints = new Float32Array(0);

  set({ layout, position, frame, colour: quantity, shown }: Drawn, colour: Colour): void {
    const runs = layout.nodes.filter(([name, , count]) =>
      layout.links.find(([l, , n]) => l === name && n === count - 1),
    );
    const total = runs.reduce((sum, [, , count]) => sum + count - 1, 0);
    this.drawn.visible = total > 0;
    if (!total) return;
    const isNew = this.places.length !== 6 * total;
    if (isNew) [this.places, this.tints] = [new Float32Array(6 * total), new Float32Array(6 * total)];
    const table = rgb(steps(colour("--dark") === "1"));
    const faint = new Color(colour("--beside")).toArray();
    let at = 0;
    for (const [name, first, count] of runs) {
      const value = valuesAlong(shown ? quantity : null, frame, layout, name);
      for (let i = 0; i < count - 1; i++, at += 6) {
        this.places.set(position.subarray(3 * (first + i), 3 * (first + i) + 6), at);
        const now = shown ? value(i) / shown.size : Number.NaN;
        const tint = shown && Number.isFinite(now) ? table[stepOf(now, shown.low, shown.high)] : faint;
        this.tints.set(tint, at);
        this.tints.set(tint, at + 3);
      }
    }
    const { geometry } = this.drawn;
    if (isNew) {
      geometry.setPositions(this.places);
      geometry.setColors(this.tints);
      this.drawn.frustumCulled = false;
      return;
    }
    // The buffers of the geometry hold the same arrays.
    geometry.attributes.instanceStart.needsUpdate = true;
    geometry.attributes.instanceColorStart.needsUpdate = true;
  }
}

/** Triangles of nets and membranes, coloured by tension, and their edges. */
class Net {
  surface = new Mesh(
    new BufferGeometry(),
    new MeshBasicMaterial({
      vertexColors: true,
      side: DoubleSide,
      transparent: true,
      opacity: 0.72,
      depthWrite: false,
    }),
  );
  threads = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.5 }));
  private layout?: Layout;

  constructor() {
    this.surface.frustumCulled = this.threads.frustumCulled = false;
  }

  set({ layout, position, frame, colour: quantity, shown }: Drawn, colour: Colour): void {
    const { cells } = layout;
    this.surface.visible = this.threads.visible = cells.length > 0;
    if (!cells.length) return;
    if (this.layout !== layout) {
      this.layout = layout;
      for (const { geometry } of [this.surface, this.threads]) geometry.dispose();
      this.surface.geometry.setAttribute("position", new BufferAttribute(new Float32Array(9 * cells.length), 3));
      this.surface.geometry.setAttribute("color", new BufferAttribute(new Float32Array(9 * cells.length), 3));
      this.threads.geometry.setAttribute("position", new BufferAttribute(new Float32Array(position.length), 3));
      this.threads.geometry.setIndex(cells.flatMap(([a, b, c]) => [a, b, b, c, c, a]));
    }
    this.threads.material.color.set(colour(frame.position ? "--faint" : "--beside"));
    this.threads.geometry.attributes.position.array.set(position);
    this.threads.geometry.attributes.position.needsUpdate = true;
    const values = quantity?.of === "cell" ? frame[quantity.name] : undefined;
    this.surface.visible = values !== undefined; // next to lines with colours only its threads
    if (!values || !shown) return;
    const table = rgb(steps(colour("--dark") === "1"));
    const { position: places, color: tints } = this.surface.geometry.attributes;
    cells.forEach((cell, k) => {
      const tint = table[stepOf(values[k] / shown.size, shown.low, shown.high)];
      cell.forEach((node, corner) => {
        places.array.set(position.subarray(3 * node, 3 * node + 3), 9 * k + 3 * corner);
        tints.array.set(tint, 9 * k + 3 * corner);
      });
    });
    places.needsUpdate = tints.needsUpdate = true;
  }
}

function rgb(names: string[]): number[][] {
  return names.map((name) => new Color(name).toArray());
}

"""Films of a result: links coloured by tension, loads as arrows with their paths, the scale of time stated."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.markers import CARETUP
from numpy.typing import NDArray

from ropewalk.errors import Refused
from ropewalk.results import style
from ropewalk.results.axis_units import show_units
from ropewalk.results.contact_film import ContactStage, is_filmed_here
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.drawn import drawn_position
from ropewalk.results.drawn_bodies import drawn_bodies
from ropewalk.results.files import ResultError
from ropewalk.results.frame import Array
from ropewalk.results.meter import Meter
from ropewalk.results.nets import is_spatial
from ropewalk.results.page import INCHES, read_size
from ropewalk.results.space_film import SpaceStage
from ropewalk.results.statistics import lines
from ropewalk.results.ties import tied, ties
from ropewalk.results.views import set_scale

if TYPE_CHECKING:
    import xarray as xr

Image = NDArray[np.uint8]
Progress = Callable[[float], None]

SUFFIXES = (".gif", ".mp4")
WIDTH = 960  # pixels
HEIGHTS = (360, 720)  # pixels, as the shape needs
LEAST, MOST = 160, 4096  # pixels: sides of a film
FILM_DPI = 100
FRAMES, FRAMES_FOLLOWING = 151, 401
LINKS = 1500  # most links drawn of one line
DELAYS = (40, 50, 60, 80, 100, 120, 150, 200)  # ms between pictures; GIF counts in 10 ms, 40 ms look fluent
ARROW = 0.2  # length of the arrow for the largest force, in heights of the picture


@dataclass(frozen=True)
class Tempo:
    """Which frames are shown, for how long, and what that means for the scale of time."""

    frames: NDArray[np.intp]
    delay: int  # ms
    label: str


def film(
    dataset: xr.Dataset,
    path: str | Path,
    *,
    frames: int | None = None,
    size: str | None = None,
    units: DisplayUnits | None = None,
    progress: Progress | None = None,
) -> None:
    """Write a film: GIF by Pillow, MP4 if imageio-ffmpeg is installed.

    Pantographs are followed along their line; what leaves the x-z plane, and nets, are filmed in three dimensions.

    Args:
        dataset: a result with at least two frames.
        path: where to write; the suffix decides.
        frames: most pictures in the film (default: 151, or 401 that follow a pantograph).
        size: width and height in pixels, as "1280x720" (default: 960 wide, as high as needed).
        units: that forces and tensions are shown in (default: of engineering, by their size).
        progress: is told the fraction done.

    Raises:
        Refused: (a ValueError) `size` cannot be read, or not be filmed.
        ResultError: unknown suffix, too few frames, the file cannot be written, or MP4 without imageio-ffmpeg.
    """
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise ResultError(f"{path}: a film ends in {' or '.join(SUFFIXES)}")
    if dataset.sizes[path_name(dataset)] < 2:
        raise ResultError("a film needs at least two frames; draw a figure instead")
    write = _write_gif if path.suffix.lower() == ".gif" else _mp4_writer()
    if follows := is_filmed_here(dataset):
        timing = tempo(dataset, frames or FRAMES_FOLLOWING)
    else:
        timing = tempo(dataset, frames or FRAMES)
    stage: Stage | ContactStage | SpaceStage
    pixels, units = _pixels(size), units or DisplayUnits.read(None)
    with style.scaled(1.0 if pixels is None else min(pixels[0] / WIDTH, pixels[1] / HEIGHTS[0])):
        if follows:
            stage = ContactStage(dataset, timing.frames, timing.label, pixels, units)
        elif is_spatial(dataset):
            stage = SpaceStage(dataset, timing.frames, timing.label, pixels, units)
        else:
            stage = Stage(dataset, timing, pixels, units)
    try:
        write(path, stage, timing.delay, progress or (lambda done: None))
    except BaseException as problem:
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)  # half a film cannot be played
        if isinstance(problem, OSError):
            raise ResultError(f"{path}: cannot be written ({problem})") from problem
        raise


def _pixels(size: str | None) -> tuple[int, int] | None:
    """Width and height in pixels, both even, as video wants them."""
    if size is None:
        return None
    width, height, unit = read_size(size, "px")
    scale = 1.0 if unit == "px" else INCHES[unit] * FILM_DPI
    sides = tuple(round(side * scale / 2.0) * 2 for side in (width, height))
    if not all(LEAST <= side <= MOST for side in sides):
        raise Refused(f"a film of {sides[0]} x {sides[1]} pixels cannot be made", f"stay within {LEAST} to {MOST}")
    return sides[0], sides[1]


def tempo(dataset: xr.Dataset, most: int = FRAMES) -> Tempo:
    """Choose evenly spaced frames and a delay that gives a round scale of time, if there is one.

    Args:
        dataset: a result with at least two frames.
        most: most frames to show.
    """
    name = path_name(dataset)
    path = dataset[name].values
    stride = -(-(len(path) - 1) // max(most - 1, 1))
    step = float(np.median(np.diff(path))) * stride
    instants = np.arange(path[0], path[-1] + 0.5 * step, step)[:most]
    right = np.clip(np.searchsorted(path, instants), 1, len(path) - 1)
    chosen = np.where(instants - path[right - 1] <= path[right] - instants, right - 1, right)
    if name != "time":
        return Tempo(chosen, DELAYS[0], "quasi-static path of the load, no scale of time")
    ratios = {delay: step / (delay / 1000) for delay in DELAYS}
    real = (delay for delay, ratio in ratios.items() if abs(ratio - 1.0) < 1e-6)
    simple = (delay for delay, ratio in ratios.items() if _simple(ratio))
    delay = next(real, next(simple, DELAYS[0]))
    return Tempo(chosen, delay, _timing_text(ratios[delay]))


def _simple(ratio: float) -> str:
    """A ratio such as 1/4 or 2 as text, or nothing if it is not so simple."""
    fraction = Fraction(ratio).limit_denominator(1000)
    larger = max(fraction.numerator, fraction.denominator)
    while larger % 10 == 0:
        larger //= 10
    exact = abs(float(fraction) - ratio) < 1e-6 * ratio and min(fraction.numerator, fraction.denominator) == 1
    return str(fraction) if exact and larger in (1, 2, 4, 5, 25) else ""


def _timing_text(ratio: float) -> str:
    if abs(ratio - 1.0) < 1e-6:
        return "real speed"
    text = _simple(ratio) or f"{ratio:.3g}"
    return f"{text} of real speed" if ratio < 1.0 else f"{text} times real speed"


class Stage:
    """The picture, laid out once; for each frame only what moves is drawn again.

    Args:
        dataset: a result.
        timing: the frames to show.
        pixels: width and height, if they are given.
        units: that forces and tensions are shown in.
    """

    def __init__(
        self,
        dataset: xr.Dataset,
        timing: Tempo,
        pixels: tuple[int, int] | None = None,
        units: DisplayUnits | None = None,
    ) -> None:
        name = path_name(dataset)
        displayed = dataset.isel({name: timing.frames})
        self._path = displayed[name].values
        position = drawn_position(displayed)[..., [0, -1]]
        self._lines = [_Curve.of(displayed, dataset, line, position) for line in lines(dataset)]
        self._spots: Array = displayed["contact_position"].values[..., [0, -1]]
        self._bodies: Array = drawn_bodies(displayed)[..., [0, -1]]
        self._pairs = ties(dataset)
        self._forces: Array = displayed["contact_force"].values[..., [0, -1]]
        seen = [position, self._bodies]
        width, height = pixels or (WIDTH, _height(np.concatenate([points.reshape(-1, 2) for points in seen])))
        self._figure = Figure(figsize=(width / FILM_DPI, height / FILM_DPI), dpi=FILM_DPI, layout="constrained")
        self._canvas = _canvas(self._figure)
        self._axes = self._figure.add_subplot()
        size = np.linalg.norm(self._forces, axis=2)
        self._unit = float(np.nanmax(size, initial=0.0)) or 1.0
        self._meter = Meter(dataset["load"].values.tolist(), size, units)
        self._clock_text = f"{name.replace('_', ' ')} {{:.{style.digits(self._path)}f}} {dataset[name].attrs['units']}"
        self._set_up(displayed, timing)
        show_units(self._figure, units or DisplayUnits.read(None))
        self._canvas.draw()  # the layout is settled here, and the ground that all pictures share
        self._figure.set_layout_engine("none")
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)

    def __len__(self) -> int:
        return len(self._path)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        width, height = self._canvas.get_width_height()
        return width, height

    def _set_up(self, displayed: xr.Dataset, timing: Tempo) -> None:
        ax = self._axes
        low, high, beyond = style.colour_range(np.concatenate([c.tension.ravel() for c in self._lines]))
        options: dict[str, Any] = {
            "cmap": style.colours(style.TENSION),
            "norm": Normalize(low, high),
            "animated": True,
        }
        self._links: list[Any] = [
            ax.add_collection(
                LineCollection([], linewidths=style.sized(3.0), capstyle="round", **options), autolim=False
            )
            for _ in self._lines
        ]
        bar = self._figure.colorbar(self._links[0], ax=ax, fraction=0.035, pad=0.01, extend=beyond)
        bar.set_label("tension (N)", fontsize=style.LABEL, color=style.INK)
        bar.ax.tick_params(labelsize=style.TICK, colors=style.INK)
        bar.outline.set_visible(False)
        for curve in self._lines:
            ends = np.ptp(curve.points[:, [0, -1]], axis=0).max()
            if ends <= 1e-9 * np.ptp(curve.points):  # supports that stand still
                foot: dict[str, Any] = {"linestyle": "none", "marker": CARETUP, "markersize": style.sized(9)}
                ax.plot(*curve.points[0, [0, -1]].T, color=style.INK, clip_on=False, **foot)
        loads = displayed.sizes["contact"]
        self._traces = [
            ax.plot([], [], color=style.INK, lw=style.THIN, linestyle=(0, (1, 1.2)), animated=True)[0]
            for _ in range(loads)
        ]
        empty = np.full(max(loads, 1), np.nan)
        arrow: dict[str, Any] = {
            "pivot": "tip",
            "angles": "uv",
            "scale_units": "height",
            "scale": 1.0 / ARROW,
        }
        size: dict[str, Any] = {"width": 0.005, "headwidth": 4.0, "headlength": 4.5, "headaxislength": 4.0}
        arrow |= {"color": style.INK, "animated": True, "zorder": 5}
        self._arrows = ax.quiver(empty, empty, empty, empty, **arrow, **size)
        dot: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": style.sized(7), "zorder": 6}
        (self._dots,) = ax.plot([], [], color=style.INK, markeredgecolor="white", animated=True, **dot)
        body: dict[str, Any] = {"linestyle": "none", "marker": "s", "markersize": style.sized(8), "zorder": 6}
        (self._masses,) = ax.plot([], [], color=style.BLUE, markeredgecolor="white", animated=True, **body)
        self._ties: Any = ax.add_collection(
            LineCollection([], colors=[style.BLUE], linewidths=style.LINE, animated=True), autolim=False
        )
        note: dict[str, Any] = {
            "transform": ax.transAxes,
            "va": "top",
            "fontsize": style.LABEL,
            "color": style.INK,
            "zorder": 7,
            "bbox": {"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.8},
        }
        self._clock = ax.text(0.985, 0.965, "", ha="right", family="monospace", animated=True, **note)
        factor = set_scale(
            ax, displayed["position"], [self._spots.reshape(-1, 2), self._bodies.reshape(-1, 2)], space=ARROW
        )
        height = "z (m)" if factor == 1.0 else f"z (m), drawn {factor:g} times as high"
        style.dress(ax, str(displayed.attrs.get("title", "")), "x (m)", height)
        ax.set_title(timing.label, loc="right", fontsize=style.NOTE, color=style.FAINT)

    def picture(self, k: int) -> Image:
        """Draw the k-th frame shown, an array (height, width, 3)."""
        self._canvas.restore_region(self._ground)
        self._move(k)
        for artist in (
            *self._links,
            *self._traces,
            self._arrows,
            self._ties,
            self._dots,
            self._masses,
            self._clock,
        ):
            self._axes.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()

    def _move(self, k: int) -> None:
        self._clock.set_text("\n".join((self._clock_text.format(self._path[k]), self._meter.label(k))).strip())
        for links, curve in zip(self._links, self._lines, strict=True):
            points = curve.points[k]
            links.set_segments(np.stack([points[:-1], points[1:]], axis=1))
            links.set_array(curve.tension[k])
        for j, trace in enumerate(self._traces):
            trace.set_data(self._spots[: k + 1, j, 0], self._spots[: k + 1, j, 1])
        self._masses.set_data(self._bodies[k, :, 0], self._bodies[k, :, 1])
        self._ties.set_segments(tied(self._bodies[k], self._spots[k], self._pairs))
        if self._traces:
            spots, force = self._spots[k], self._forces[k] / self._unit
            self._dots.set_data(spots[:, 0], spots[:, 1])
            self._arrows.set_offsets(np.nan_to_num(spots))
            self._arrows.set_UVC(*np.ma.masked_invalid(force).T)


@dataclass(frozen=True)
class _Curve:
    """The drawn points of a line: points (frame, node, 2) in m, tension (frame, node - 1) in N."""

    points: Array
    tension: Array

    @classmethod
    def of(cls, displayed: xr.Dataset, dataset: xr.Dataset, line: str, position: Array) -> _Curve:
        nodes = np.flatnonzero(dataset["line"].values == line)
        links = np.flatnonzero(dataset["link_line"].values == line)
        kept = style.thinned(len(nodes), LINKS + 1)
        return cls(position[:, nodes[kept]], displayed["tension"].isel(link=links[kept[:-1]]).values)


def _canvas(figure: Figure) -> Any:
    return FigureCanvasAgg(figure)  # its methods carry no types


def _height(points: Array) -> int:
    """Height of the picture in pixels for shapes (frame, node, 2) at a true scale, within limits."""
    flat = points.reshape(-1, 2)
    width, height = np.ptp(flat[np.isfinite(flat).all(axis=1)], axis=0)
    wanted = 70 + 0.85 * WIDTH * height / max(width, 1e-9) / (1 - 2.2 * ARROW)
    return int(np.clip(wanted, *HEIGHTS)) // 2 * 2  # video wants even numbers


def _write_gif(path: Path, stage: Stage | ContactStage | SpaceStage, delay: int, progress: Progress) -> None:
    """Write a GIF with one palette for all pictures, taken from a few of them."""
    from PIL import Image as pillow

    samples = [stage.picture(k) for k in style.thinned(len(stage), 5)]
    palette = pillow.fromarray(np.concatenate(samples)).quantize(256, method=pillow.Quantize.MEDIANCUT)
    shades = np.array(palette.getpalette(), dtype=np.uint8).reshape(-1, 3)
    white = int(np.argmax(shades.sum(axis=1, dtype=int)))
    shades[white] = 255
    palette.putpalette(shades.tobytes())

    def images() -> Iterator[Any]:
        for k in range(len(stage)):
            picture = stage.picture(k)
            full = pillow.fromarray(picture)
            image = full.quantize(palette=palette, dither=pillow.Dither.NONE)
            ground = full.convert("L").point([0] * 255 + [255])  # far quicker than by NumPy
            image.paste(white, mask=ground)  # the nearest colour is found roughly only: white would turn grey
            yield image
            progress((k + 1) / len(stage))

    rest = images()
    next(rest).save(path, "GIF", save_all=True, append_images=rest, duration=delay, loop=0, optimize=False)


def _mp4_writer() -> Callable[[Path, Stage | ContactStage | SpaceStage, int, Progress], None]:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise ResultError(
            "MP4 needs the package imageio-ffmpeg (pip install 'ropewalk[film]'); or write a .gif instead"
        ) from None

    def write(path: Path, stage: Stage | ContactStage | SpaceStage, delay: int, progress: Progress) -> None:
        options: dict[str, Any] = {"fps": 1000 / delay, "macro_block_size": 2, "quality": 8}
        stream = imageio_ffmpeg.write_frames(str(path), stage.size, **options)
        stream.send(None)
        try:
            for k in range(len(stage)):
                stream.send(np.ascontiguousarray(stage.picture(k)))
                progress((k + 1) / len(stage))
        finally:
            stream.close()

    return write

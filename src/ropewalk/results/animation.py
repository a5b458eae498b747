"""Films of a result as GIF or MP4."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.errors import Refused
from ropewalk.results import style
from ropewalk.results.contact_figure import is_of_overhead_line
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.files import ResultError
from ropewalk.results.stage import DPI, WIDTH, Stage
from ropewalk.results.style import INCHES, read_size
from ropewalk.results.tempo import FRAMES, FRAMES_FOLLOWING, tempo

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[float], None]

SUFFIXES = (".gif", ".mp4")
LEAST, MOST = 160, 4096  # pixels: sides of a film
USUAL = 360  # pixels: height at which letters have their usual size


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
        progress: is called with the fraction done.

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
    timing = tempo(dataset, frames or (FRAMES_FOLLOWING if is_of_overhead_line(dataset) else FRAMES))
    pixels = _pixels(size)
    with style.scaled(1.0 if pixels is None else min(pixels[0] / WIDTH, pixels[1] / USUAL)):
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
    scale = 1.0 if unit == "px" else INCHES[unit] * DPI
    sides = tuple(round(side * scale / 2.0) * 2 for side in (width, height))
    if not all(LEAST <= side <= MOST for side in sides):
        raise Refused(f"a film of {sides[0]} x {sides[1]} pixels cannot be made", f"stay within {LEAST} to {MOST}")
    return sides[0], sides[1]


def _write_gif(path: Path, stage: Stage, delay: int, progress: Progress) -> None:
    """Write a GIF with one palette for all pictures, taken from a few of them."""
    from PIL import Image as pillow

    samples = [stage.picture(k) for k in style.thinned(len(stage), 5)]
    palette = pillow.fromarray(np.concatenate(samples)).quantize(128, method=pillow.Quantize.MEDIANCUT)
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


def _mp4_writer() -> Callable[[Path, Stage, int, Progress], None]:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise ResultError(
            "MP4 needs the package imageio-ffmpeg (pip install 'ropewalk[film]'); or write a .gif instead"
        ) from None

    def write(path: Path, stage: Stage, delay: int, progress: Progress) -> None:
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

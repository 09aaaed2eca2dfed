# SPDX-License-Identifier: Apache-2.0
"""A simulated hand at work."""
from __future__ import annotations

import os
import pathlib
import shutil
import tempfile
import weakref
from collections.abc import Callable, Sequence
from typing import Any, Optional, Union

import numpy.typing as npt

from . import _core
from ._method import Method

_Path = Union[str, "os.PathLike[str]"]


class Run:
    """What came of a run.

    Attributes
    ----------
    summary : dict
        As summary.json of `handpiece run`: state_hash, removed_mm3, peak_force_n, ...
    samples : dict of arrays (n,) or (n, k)
        Every tick: tick, time_s, position_mm (3), orientation (4: w x y z), velocity_mm_s (3), force_n (3), torque_nmm (3),
        depth_mm, true_position_mm (3), proxy_position_mm (3), proxy_orientation (4), applied_force_n (3),
        contact_area_mm2, contact_point_mm (3), contact_normal (3), tissue, flags, pedal, speed_rpm, load_torque_nmm,
        feed_mm_s, removed_mm3 (by TISSUES), work_us. Views, read-only, of one block that any of them keeps alive.
    out : pathlib.Path
        The folder with what it wrote; without `out` one that goes when this object does.
    """

    def __init__(self, summary: dict[str, Any], samples: dict[str, npt.NDArray[Any]], out: pathlib.Path,
                 temporary: bool) -> None:
        self.summary, self.samples, self.out = summary, samples, out
        if temporary:
            weakref.finalize(self, shutil.rmtree, out, ignore_errors=True)

    @property
    def state_hash(self) -> str:
        """Of the cut tooth, as `handpiece run` and `handpiece replay` tell it; "" where nothing was to be cut."""
        return str(self.summary.get("state_hash", ""))

    @property
    def session(self) -> Optional[pathlib.Path]:
        """The recording, for Session, replay and score; None where nothing was to be cut."""
        path = self.out / "session.h5"
        return path if path.exists() else None

    def __repr__(self) -> str:
        return f"<handpiece.Run: {self.summary['motion']}, {self.summary['duration_s']:.3f} s>"


def run(
    tooth: Union["_core.Case", _Path],
    motion: Union[str, _Path, npt.ArrayLike] = "drop",
    seed: int = 1,
    *,
    out: Optional[_Path] = None,
    bur: _Path = "330",
    method: Union[str, Method] = "field",
    voxel_mm: float = 0.05,
    cache: bool = True,
    surfaces: Optional[bool] = None,
    rate_hz: float = 1000.0,
    duration_s: float = 0.0,
    device_model: str = "simulated",
    hand: Optional[str] = None,
    force: str = "proxy",
    stiffness: float = 1.0,
    damping: float = 1.0,
    slide_friction: float = 1.0,
    speed_mm_s: Optional[float] = None,
    load_n: float = 1.0,
    depth_mm: float = 0.0,
    length_mm: float = 0.0,
    at_mm: Sequence[float] = (0.0, 0.0),
    delay_ms: float = 0.0,
    friction_n: float = 0.26,
    pedal: Optional[float] = None,
    full_removal: bool = False,
    drive: str = "turbine",
    ability: str = "",
    abilities: str = "",
    tissues: str = "",
    isthmus_mm: float = 1.2,
    height_mm: float = 2.5,
    pulp_guard_mm: float = 0.5,
    dwell_s: float = 4.0,
    tremor_um: float = 0.0,
    code: str = "",
    undo_at_s: Sequence[float] = (),
    redo_at_s: Sequence[float] = (),
    reset_at_s: Sequence[float] = (),
    progress: Optional[Callable[[float], Any]] = None,
) -> Run:
    """A simulated hand moves the bur, the loop feels the tooth, and cuts it: `handpiece run`, with its names.

    Parameters
    ----------
    tooth : Case or path
        A case, a mesh file, or an attempt that goes on where it was.
    motion : str, path or array (n, 8)
        One of MOTIONS, a CSV file, or rows of t [s], x, y, z of the tip [mm], qw, qx, qy, qz.
    seed : int
        Of the tremor.
    out : path, optional
        Folder for all that `handpiece run` writes; without it a temporary one.
    bur : str or path
        As Bur takes it.
    method : str or Method
        "field", "hull", or one of your own, for what only touches; a cut is felt by "field".
    voxel_mm, cache
        As in prepare.
    surfaces : bool, optional
        Of a cut: also cut.stl and cut/, which takes longer than the cut. If None: where `out` is given.
    rate_hz, duration_s
        Ticks a second; seconds, 0: as long as the motion.
    device_model, hand, force, stiffness, damping, slide_friction, speed_mm_s, load_n, depth_mm, length_mm, at_mm, delay_ms, friction_n
        Device, hand and law of force; a cut's hand is rigid unless given.
    pedal, full_removal, drive, ability, abilities, tissues, isthmus_mm, height_mm, pulp_guard_mm, dwell_s, tremor_um
        Of a cut. `pedal`, 0 to 1, makes any motion one.
    code, undo_at_s, redo_at_s, reset_at_s
        Kept in the session; when strokes are taken back [s].
    progress : callable, optional
        Hears the fraction done; False from it cancels.

    Returns
    -------
    Run

    Raises
    ------
    Error
        Names there are not, values out of range, a tooth that cannot be felt, cancelled.
    TypeError, ValueError
        A value of the wrong kind; a motion that is no array (n, 8) of finite numbers.

    Notes
    -----
    Without Python's lock, but for a method of your own. The same inputs give the same samples and the same tooth, bit for
    bit; work_us is measured. Ctrl-C ends it; session.h5 in `out` then holds what was done. docs/cli.md says what each
    name is, docs/physics.md by which laws.
    """
    options = dict(locals())
    for name in ("out", "method", "cache", "surfaces", "progress"):
        del options[name]
    options["bur"] = os.fsdecode(bur)
    options["at_mm"], options["undo_at_s"] = list(at_mm), list(undo_at_s)
    options["redo_at_s"], options["reset_at_s"] = list(redo_at_s), list(reset_at_s)
    shapes = out is not None if surfaces is None else surfaces
    place = pathlib.Path(tempfile.mkdtemp(prefix="handpiece-") if out is None else os.fsdecode(out))
    try:
        if isinstance(tooth, _core.Case):
            path = tooth.path
            if path is None:
                path = os.path.join(place, "case")
                place.mkdir(parents=True, exist_ok=True)
                tooth.write(path)
            options["tooth"] = path
        else:
            options["tooth"] = os.fsdecode(tooth)
        summary, samples = _core.run_hand(options, method, str(place), cache, shapes, progress)
    except BaseException:
        if out is None:
            shutil.rmtree(place, ignore_errors=True)
        raise
    return Run(summary, samples, place, out is None)

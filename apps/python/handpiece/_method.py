# SPDX-License-Identifier: Apache-2.0
"""A contact method of one's own."""
from __future__ import annotations

from typing import Any, Union

import numpy as np
import numpy.typing as npt

Answer = Union[float, tuple[float, npt.ArrayLike], tuple[float, npt.ArrayLike, npt.ArrayLike]]


class Method:
    """What Contact and run take beside "field" and "hull": derive from it and write depth.

    It is asked on one thread at a time, with Python's lock. What it raises comes out of the call that asked.

    Attributes
    ----------
    name : str
        As results tell it.
    """

    name = "own"

    def depth(self, pose: npt.NDArray[np.float64]) -> Answer:
        """How deep the bur is in the tooth, or how far from it.

        Parameters
        ----------
        pose : array (7,) of float64
            Bur in tooth: x, y, z of the tip [mm], qw, qx, qy, qz.

        Returns
        -------
        depth_mm, or (depth_mm, normal), or (depth_mm, normal, point_mm)
            Depth positive when overlapping, minus the distance when apart; the unit normal out of the tooth, which run
            needs; the point of the tooth that decides.
        """
        raise NotImplementedError(f"{type(self).__name__} has no depth")


def rotation(pose: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """The rotation matrix (3, 3) of a pose (7,): its columns are the bur's axes in the tooth's frame."""
    w, x, y, z = (float(q) for q in pose[3:7])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])

# SPDX-License-Identifier: Apache-2.0
"""How much of the crown's picture is hidden, from two pictures of the same eye: with the handpiece and without."""
from . import eye

# Of a channel of 255: glass that lets the tooth be seen changes it by less.
HIDES = 70
EVERY = 3  # pixels


def differs(a, b, at):
    return max(abs(a[at + k] - b[at + k]) for k in range(3)) > HIDES


def hidden_share(with_it, without, hand):
    """RGB bytes of the picture each; counts over the crown's box on it. 0 where that is not seen."""
    width, height = hand["viewport"]
    box = eye.crown_seen(hand)
    if box is None or len(with_it) != 3 * width * height or len(without) != len(with_it):
        return 0.0
    left, top, right, bottom = (int(x) for x in box)
    seen = hidden = 0
    for y in range(max(0, top), min(height, bottom), EVERY):
        for x in range(max(0, left), min(width, right), EVERY):
            seen += 1
            hidden += differs(with_it, without, 3 * (y * width + x))
    return hidden / seen if seen else 0.0

"""Crossings of grid lines joined into boundaries: which of them belong together inside a cell of the grid.

A square of four neighbouring cells has crossings round its border. They divide the border into arcs that are stable and
arcs that are not. Either the unstable arcs are apart, or those of one kind are one region, which a look between them
decides.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import NamedTuple, TypeVar

from floquet.kind import Kind

Node = TypeVar("Node", bound=Hashable)


class Corner(NamedTuple):
    """A crossing on the way round a square: its node, the kind of its region, and whether that begins here."""

    node: Hashable
    kind: Kind
    begins: bool


def joined(
    corners: Sequence[Corner], connected: Callable[[Kind, Sequence[Hashable]], bool]
) -> list[tuple[Hashable, Hashable]]:
    """Return which crossings round a square are joined by a boundary.

    ``corners`` are in the order in which they are met. Regions begin and end in turn. ``connected`` tells whether the
    regions of a kind that end in some crossings are one region inside the square.
    """
    if not corners:
        return []
    first = next(i for i, corner in enumerate(corners) if corner.begins)
    turned = [*corners[first:], *corners[:first]]
    arcs = list(zip(turned[::2], turned[1::2], strict=True))
    if len(arcs) == 1:
        return [(arcs[0][0].node, arcs[0][1].node)]
    kinds = [{begin.kind, end.kind} for begin, end in arcs]
    alike = next((kind for i, one in enumerate(kinds) for other in kinds[:i] for kind in one & other), None)
    through = [i for i, kind in enumerate(kinds) if alike in kind]
    if alike is None or not connected(alike, [corner.node for i in through for corner in arcs[i]]):
        through = []
    found = [(begin.node, end.node) for i, (begin, end) in enumerate(arcs) if i not in through]
    for i, k in zip(through, [*through[1:], *through[:1]], strict=True):
        found.append((arcs[i][1].node, arcs[k][0].node))
    return found


def lines(pairs: Sequence[tuple[Node, Node]]) -> list[tuple[list[Node], bool]]:
    """Return the lines that pairs of neighbours make, each node at most two, and whether each is closed."""
    neighbours: dict[Node, list[Node]] = {}
    for one, other in pairs:
        neighbours.setdefault(one, []).append(other)
        neighbours.setdefault(other, []).append(one)
    left = dict.fromkeys([*(node for node, near in neighbours.items() if len(near) == 1), *neighbours])
    found = []
    while left:
        line = [next(iter(left))]
        del left[line[0]]
        while (following := next((node for node in neighbours[line[-1]] if node in left), None)) is not None:
            line.append(following)
            del left[following]
        found.append((line, len(line) > 2 and line[0] in neighbours[line[-1]]))
    return found

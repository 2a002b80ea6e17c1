"""Lines, text and symbols at given places of an SVG drawing, on schemdraw."""

import re
from html import escape
from typing import Any

import schemdraw
from schemdraw import elements
from schemdraw.segments import Segment, SegmentCircle, SegmentText

PITCH = 0.6  # from one row to the next, in units of 36 points
SIZE, SMALL = 10.0, 8.0  # of the text, in points
WIDTH = 0.155  # of a letter of SIZE, at most on average

Place = tuple[float, float]


class Sheet:
    """Coordinates in units, y upwards. Lines connect where one ends on the other, not where they cross."""

    def __init__(self) -> None:
        self._drawing = schemdraw.Drawing(canvas="svg", show=False)
        self._drawing.config(fontsize=SIZE, lw=1.2, bgcolor="white", margin=0.4)
        self._own = elements.Element()
        self._drawing.add(self._own)

    def line(self, *places: Place, bold: bool = False) -> None:
        self._own.segments.append(Segment(list(places), lw=3.0 if bold else 1.2))

    def box(self, low: Place, high: Place, dashed: bool = False) -> None:
        corners = [low, (low[0], high[1]), high, (high[0], low[1]), low]
        self._own.segments.append(Segment(corners, lw=1.2, ls="--" if dashed else None))

    def dot(self, at: Place, is_open: bool = False) -> None:
        self._own.segments.append(SegmentCircle(at, 0.07, fill="white" if is_open else "black", zorder=4))

    def text(self, at: Place, text: str, align: str = "left", size: float = SIZE, up: bool = False) -> None:
        """``align``: left, center or right; ``up``: the text stands on ``at``, else its middle is there."""
        style: dict[str, Any] = {"align": (align, "bottom" if up else "center"), "fontsize": size}
        self._own.segments.append(SegmentText(at, text, **style))

    def part(
        self,
        kind: str,
        at: Place,
        to: Place | None = None,
        label: str = "",
        anchor: str = "",
        flip: bool = False,
    ) -> Any:
        """A symbol of schemdraw, ``label`` to its left or above it; ``anchor``: its point at ``at``."""
        symbol = getattr(elements, kind)().at(at)
        symbol = symbol.anchor(anchor) if anchor else symbol
        symbol = symbol.flip() if flip else symbol
        symbol = symbol.theta(0) if to is None else symbol.to(to)  # else as the one before
        if to is not None:
            if label and at[0] == to[0]:
                self.text((at[0] - 0.42, (at[1] + to[1]) / 2), label, "right")
            elif label:
                self.text(
                    ((at[0] + to[0]) / 2, at[1] + (0.62 if "Var" in kind else 0.3)), label, "center", up=True
                )
        self._drawing.add(symbol)
        return symbol

    def ground(self, at: Place) -> None:
        self.part("Ground", at)

    def supply(self, at: Place, label: str) -> None:
        self.part("Vdd", at)
        self.text((at[0], at[1] + 0.45), label, "center", up=True)

    def amplifier(self, at: Place) -> None:
        """A small triangle that points to the right and stands for one amplifier; ``at``: its left end."""
        x, y = at
        self._own.segments.append(
            Segment([(x, y + 0.25), (x + 0.45, y), (x, y - 0.25), (x, y + 0.25)], lw=1.2)
        )

    def svg(self, title: str) -> bytes:
        """The file, with each style written once."""
        text = self._drawing.get_imagedata("svg").decode("utf-8")
        head, body = re.split("(?<=>)", text, maxsplit=1)
        styles = dict.fromkeys(re.findall(r' style="([^"]*)"', body))
        for k, style in enumerate(styles):
            body = body.replace(f' style="{style}"', f' class="msn{k}"')
        rules = "".join(f".msn{k}{{{style}}}" for k, style in enumerate(styles)).replace(
            "stroke-dasharray:-;", ""
        )
        head = head.replace(">", f' role="img"><title>{escape(title)}</title><style>{rules}</style>')
        return (head + body + "\n").encode("utf-8")

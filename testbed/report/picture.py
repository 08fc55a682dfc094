"""A drawn figure as a part of a page: no file, no link."""

import re
from base64 import b64decode, b64encode
from dataclasses import dataclass
from io import BytesIO
from typing import Literal

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

DPI = 150


@dataclass(frozen=True)
class Picture:
    """An image that carries its own data.

    Attributes:
        source: data URI.
        alt: what it shows, for those who do not see it.
        caption: below it.
    """

    source: str
    alt: str
    caption: str

    @property
    def data(self) -> bytes:
        """The image itself, for a file of its own."""
        return b64decode(self.source.partition(",")[2])


def picture(figure: Figure, alt: str, caption: str, form: Literal["svg", "png"] = "png") -> Picture:
    """A figure as a picture.

    Args:
        figure: drawn.
        alt: what it shows.
        caption: below it.
        form: lines few enough for ``svg``, or pixels.
    """
    FigureCanvasAgg(figure)
    target = BytesIO()
    metadata = {"Date": None} if form == "svg" else None
    figure.savefig(target, format=form, dpi=DPI, metadata=metadata)
    data = _with_plain_ids(target.getvalue()) if form == "svg" else target.getvalue()
    kind = "image/svg+xml" if form == "svg" else "image/png"
    return Picture(f"data:{kind};base64,{b64encode(data).decode('ascii')}", alt, caption)


def _with_plain_ids(svg: bytes) -> bytes:
    """The drawing with its parts numbered: matplotlib names them by a hash of unrounded coordinates."""
    for number, name in enumerate(dict.fromkeys(re.findall(rb'id="([a-z][0-9a-f]{10})"', svg)), start=1):
        svg = svg.replace(name, b"part%d" % number)
    return svg

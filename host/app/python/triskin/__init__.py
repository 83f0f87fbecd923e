# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of robot skin as numpy arrays (docs/library.md).

Names carry units: _mm, _s, _us, _n (newton), _kpa, _counts (of the converters, below rest). Places and normals are in the
frame of the design's mesh, of a robot in the frame of its base."""
import asyncio as _asyncio

from ._core import BadInput, DeviceFailed, Recording, Skin, __version__, open, read, simulate
from ._frames import Frames, frames, write_frames

__all__ = ["BadInput", "DeviceFailed", "Frames", "Recording", "Skin", "__version__", "frames", "open", "read", "simulate",
           "write_frames"]

for _name in (BadInput, DeviceFailed, Recording, Skin, open, read, simulate):
    _name.__module__ = __name__


def _blocks(self, period_s=0.1):
    """Yields the samples of each `period_s` seconds as read() returns them, in real time and without end; leave it with
    break. It starts the stream if need be."""
    while True:
        yield self.read(period_s)


async def _blocks_async(self, period_s=0.1):
    """The same for asyncio: while the samples come, other tasks run."""
    while True:
        yield await _asyncio.to_thread(self.read, period_s)


def _to_dataframe(self, taxels="change_counts"):
    """A pandas.DataFrame with a row a sample: time_s (since 1970), number (of the module, as labels say it), node, sample,
    valid (bit t), and for each taxel t a column change_counts_t (below rest; more is more pressure), or with
    taxels="value" value_t (counts of the converter)."""
    import pandas

    if taxels not in ("change_counts", "value"):
        raise BadInput(f"taxels={taxels!r}: there are change_counts and value")
    s = self.samples
    table = self.change if taxels == "change_counts" else s["value"]
    columns = {"time_s": s["time_s"], "number": self.numbers[s["module"]], "node": s["node"], "sample": s["number"],
               "valid": s["valid"]}
    columns.update({f"{taxels}_{t}": table[:, t] for t in range(table.shape[1])})
    return pandas.DataFrame(columns)


for _method, _as in ((_blocks, "blocks"), (_blocks_async, "blocks_async")):
    _method.__name__ = _as
    _method.__qualname__ = f"Skin.{_as}"
    setattr(Skin, _as, _method)
Skin.__iter__ = lambda self: self.blocks()
Skin.__aiter__ = lambda self: self.blocks_async()
_to_dataframe.__name__, _to_dataframe.__qualname__ = "to_dataframe", "Recording.to_dataframe"
Recording.to_dataframe = _to_dataframe

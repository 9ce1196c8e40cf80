"""Relay: an image passed on, the node that engines are timed with."""

from __future__ import annotations

from visint.arrays import Array, Image
from visint.module import Context, Module, Params, Ports

__all__ = ["Relay", "RelayPorts"]


class RelayPorts(Ports):
    """An image, and the same one."""

    image: Image[Array, "H W"]


class Relay(Module[Params, RelayPorts, RelayPorts]):
    """Passes an image on as it is: what a graph of these costs is what the engine costs."""

    name = "relay"

    def run(self, inputs: RelayPorts, ctx: Context) -> RelayPorts:
        """The image itself."""
        return RelayPorts(image=inputs.image)

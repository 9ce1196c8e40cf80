"""Peers: other people's stereo matchers, each run in a fresh process of an environment of their own."""

from __future__ import annotations

from visint_lab.peers.running import NAMES, Cost, PeerRun, available, run_peer

__all__ = ["NAMES", "Cost", "PeerRun", "available", "run_peer"]

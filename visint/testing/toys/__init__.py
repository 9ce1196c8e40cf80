"""Toy modules: loops, levels, the hub and the engine are tested with these, without any vision.

Their ids are ``toy.<name>`` once :mod:`visint.testing.plugin` is installed under the entry point ``toy``.
"""

from visint.testing.toys.cues import BoundaryCue, Cue, DisparityCue, Photometric
from visint.testing.toys.hub import Blend, BlendDisparity, Cohere, Joint
from visint.testing.toys.images import Edges, Focal, Picture, Smooth, Stack
from visint.testing.toys.offenders import Fail, Scribble, Wrong
from visint.testing.toys.scalars import (
    Add,
    Constant,
    Counter,
    Delay,
    Diverge,
    React,
    Scale,
    Threshold,
)
from visint.testing.toys.witnesses import Level, Measure, Noise, Sleep, Turn, Warn

__all__ = [
    "TOYS",
    "Add",
    "Blend",
    "BlendDisparity",
    "BoundaryCue",
    "Cohere",
    "Constant",
    "Counter",
    "Cue",
    "Delay",
    "DisparityCue",
    "Diverge",
    "Edges",
    "Fail",
    "Focal",
    "Joint",
    "Level",
    "Measure",
    "Noise",
    "Photometric",
    "Picture",
    "React",
    "Scale",
    "Scribble",
    "Sleep",
    "Smooth",
    "Stack",
    "Threshold",
    "Turn",
    "Warn",
    "Wrong",
]

TOYS = (
    *(Add, Constant, Counter, Delay, Diverge, React, Scale, Threshold),
    *(Level, Measure, Noise, Sleep, Turn, Warn),
    *(Edges, Focal, Picture, Smooth, Stack),
    *(BoundaryCue, Cue, DisparityCue, Photometric),
    *(Blend, BlendDisparity, Cohere, Joint),
    *(Fail, Scribble, Wrong),
)
"""Every toy module."""

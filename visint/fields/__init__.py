"""Field kinds, evidence and geometry: the words in which vision modules talk to each other."""

from visint.fields.boundary_kind import BoundaryKind
from visint.fields.camera import Camera
from visint.fields.evidence import (
    BoundariesEvidence,
    DepthEvidence,
    DisparityEvidence,
    Evidence,
    IncidenceEvidence,
    NormalsEvidence,
    ReliefEvidence,
    SlopesEvidence,
    known,
)
from visint.fields.kinds import KINDS, FieldKind, down, up
from visint.fields.light import Light

__all__ = [
    "KINDS",
    "BoundariesEvidence",
    "BoundaryKind",
    "Camera",
    "DepthEvidence",
    "DisparityEvidence",
    "Evidence",
    "FieldKind",
    "IncidenceEvidence",
    "Light",
    "NormalsEvidence",
    "ReliefEvidence",
    "SlopesEvidence",
    "down",
    "known",
    "up",
]

"""Metrics: how far a reconstruction lies from the truth. One file a family."""

MODULES = ()

"""Rendering of scenes with exact truth."""

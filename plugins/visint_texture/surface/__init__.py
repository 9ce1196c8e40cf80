"""Surfaces that explain a field of moments: one plane, or a smooth relief held at a reference site."""

"""Coherence: whether what a pixel's neighbours predict for it agrees, with each other and with the map."""

"""Rays and the surfaces they meet."""

"""Brightness before any model: its noise, its means inside regions, its fine contrast."""

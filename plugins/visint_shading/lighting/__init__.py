"""Where the light comes from: directions at each pixel, and an estimate where none is given."""

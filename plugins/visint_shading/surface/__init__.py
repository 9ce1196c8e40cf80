"""The surface as the map has it: how it is turned, and turned until its brightness fits."""

"""Learning on training scenes: candidates' signs and errors, the choice fitted to them, parameters."""

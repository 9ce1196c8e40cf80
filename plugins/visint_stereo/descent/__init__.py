"""The parts of the 1992 matcher: attribute images, noise, an update of both fields, what they are worth."""

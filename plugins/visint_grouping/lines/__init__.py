"""Lines as pixels: thinned, traced, extended, bent at corners, and walls to diffusion."""

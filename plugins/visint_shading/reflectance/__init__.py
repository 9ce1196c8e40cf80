"""How surfaces reflect: albedo a region, and whether the model holds there at all."""

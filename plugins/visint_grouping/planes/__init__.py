"""The parts of region planes: a plane for each region, votes, visibility, and which plane explains most."""

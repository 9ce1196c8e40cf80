"""What a change of view does to second moments, and what that tells of slant and tilt."""

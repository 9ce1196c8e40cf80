"""Where matches lead: the second view seen through a disparity."""

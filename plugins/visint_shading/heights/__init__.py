"""Heights from the brightest points on, after Oliensis and Dupuis."""

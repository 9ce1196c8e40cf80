"""Superquadrics: shapes of six sizes and roundnesses that stand for the parts of objects."""

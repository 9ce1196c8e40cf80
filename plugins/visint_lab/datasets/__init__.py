"""Data sets: pairs with truth from folders on disk, through visint's own readers."""

"""The parts of semi-global matching: costs, winners, consistency, filling, search range, reliability."""

"""The joint estimate: one energy over all evidence, solved by a multigrid that respects cuts."""

"""Trials: systems and peers on pairs, held against the truth, their controls and the published figures."""

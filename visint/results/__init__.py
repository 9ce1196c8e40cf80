"""What a run gives: outputs with confidence and evidence, the record behind them, and files of it."""

from visint.results.premises import Premise
from visint.results.provenance import Source
from visint.results.records import Measure, Record, Stop, Timing, Turn, Warned
from visint.results.result import Result, gather

__all__ = ["Measure", "Premise", "Record", "Result", "Source", "Stop", "Timing", "Turn", "Warned", "gather"]

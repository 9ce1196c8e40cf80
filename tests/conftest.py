"""Settings of every test: property tests without time limits, and the same examples in each run.

``pytest --hypothesis-profile=search`` looks for new examples instead.
"""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("visint", deadline=None, derandomize=True)
settings.register_profile("search", deadline=None, max_examples=1000)
settings.load_profile("visint")

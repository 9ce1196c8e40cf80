"""For those who write modules: the contract as tests, toy modules, sample inputs, fake installations.

``visint.testing.contract``    :class:`ModuleContract`, to be subclassed; ``visint.testing.samples`` feeds it.
``visint.testing.strategies``  hypothesis strategies for arrays, evidence and cameras.
``visint.testing.installed``   a fake installed distribution.
``visint.testing.toys``        toy modules, and ``visint.testing.plugin`` that brings them.

Neither pytest nor hypothesis is needed to import any of it, ``strategies`` apart.
"""

from __future__ import annotations

from visint.testing.contract import ModuleContract, sentences
from visint.testing.installed import installed
from visint.testing.samples import sample_inputs

__all__ = ["ModuleContract", "installed", "sample_inputs", "sentences"]

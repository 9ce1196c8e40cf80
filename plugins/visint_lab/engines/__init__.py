"""Engines: this one, bare Python and other people's, on the same chain and the same loop.

One file an engine, ``on_<name>.py``: it says how the chain and the loop are spelled there, and nothing else.
Each runs in a fresh process (``python on_dask.py``) and prints what ``stopwatch.py`` measured;
``contest.py`` starts them one after the other.
"""

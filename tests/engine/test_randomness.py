"""Chance and turns: for modules that say so, from the seed and the place in the graph, never from names."""

from __future__ import annotations

import numpy as np
import pytest

from visint.errors import ModuleError
from visint.module import Module, Params, Ports
from visint.testing.toys.scalars import Value

NOISE = """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 2}, turns: {inside: levels, times: 3}}
nodes:
  one: {uses: toy.constant}
  two: {uses: toy.constant, with: {value: 2.0}}
  noise: {uses: toy.noise, loop: turns, in: {value: one.value}}
  other: {uses: toy.noise, loop: turns, in: {value: two.value}}
  note: {uses: toy.measure, loop: turns, in: {value: noise.value}}
  note2: {uses: toy.measure, loop: turns, in: {value: other.value}}
outputs: {a: note.value, b: note2.value}
"""


class Nothing(Ports):
    pass


class Sneaky(Module[Params, Nothing, Value]):
    """Asks for the turn without having said so."""

    name = "sneaky"

    def run(self, inputs, ctx):
        return Value(value=ctx.turn)


class Gambler(Module[Params, Nothing, Value]):
    """Throws dice without having said so."""

    name = "gambler"

    def run(self, inputs, ctx):
        return Value(value=ctx.rng.random())


@pytest.mark.parametrize(("uses", "what"), [("own.sneaky", "ctx.turn"), ("own.gambler", "ctx.rng")])
def test_only_per_turn_modules_may_ask(stage, uses, what):
    """A module that may be lifted must not know the turn: it is told what to write."""
    stage.modules(own=[Sneaky, Gambler])
    with pytest.raises(ModuleError, match=rf"VI403 node 'one', {uses}.*{what}(.|\n)*per_turn = True"):
        stage.run(f"nodes: {{one: {{uses: {uses}}}}}\noutputs: {{one: one.value}}")


def numbers(stage, text=NOISE, **options):
    result = stage.run(text, {"left": np.zeros((8, 8), np.float32)}, **options)
    found = {}
    for measure in result.measures:
        found.setdefault(measure.node, []).append(measure.value)
    return found


def test_equal_seeds_give_equal_numbers(stage):
    assert numbers(stage, seed=4) == numbers(stage, seed=4)


def test_another_seed_gives_other_numbers(stage):
    one, two = numbers(stage, seed=4), numbers(stage, seed=5)
    assert not set(one["note"]) & set(two["note"])
    assert not set(one["note2"]) & set(two["note2"])


def test_levels_turns_and_places_differ(stage):
    """2 levels × 3 turns of two nodes: twelve different deviations."""
    found = numbers(stage)
    deviations = [x - 1 for x in found["note"]] + [x - 2 for x in found["note2"]]
    assert len(set(np.round(deviations, 12))) == 12


def test_names_change_nothing(stage):
    """Nodes, loops and inputs by other names, in another order: the very numbers."""
    renamed = """
inputs: {picture: Image}
loops: {rounds: {inside: pyramid, times: 3}, pyramid: {over: pyramid, levels: 2}}
nodes:
  b2: {uses: toy.measure, loop: rounds, in: {value: z.value}}
  z: {uses: toy.noise, loop: rounds, in: {value: q.value}}
  q: {uses: toy.constant, with: {value: 2.0}}
  p: {uses: toy.constant}
  b1: {uses: toy.measure, loop: rounds, in: {value: a.value}}
  a: {uses: toy.noise, loop: rounds, in: {value: p.value}}
outputs: {x: b2.value, y: b1.value}
"""
    one = numbers(stage, seed=9)
    result = stage.run(renamed, {"picture": np.zeros((8, 8), np.float32)}, seed=9)
    assert [m.value for m in result.measures if m.node == "b1"] == one["note"]
    assert [m.value for m in result.measures if m.node == "b2"] == one["note2"]


def test_the_name_in_an_end_condition_changes_nothing(stage):
    """A node's name stands in `until`, too: its numbers are the same by any name."""
    text = """
loops: {{turns: {{times: 3, until: {{change_of: {name}.value, below: 1.0e-9}}}}}}
nodes: {{{name}: {{uses: toy.noise, loop: turns, feedback: {{value: {{from: {name}.value, start: 0}}}}}}}}
outputs: {{x: {name}.value}}
"""
    assert stage.run(text.format(name="a"))["x"] == stage.run(text.format(name="b"))["x"]


def test_other_nodes_change_nothing(stage):
    """A node that feeds it nothing, read or unread, does not move the numbers of another."""
    more = NOISE.replace("outputs:", "  idle: {uses: toy.noise, loop: turns}\noutputs:")
    found = numbers(stage, more)
    found.pop("idle", None)
    assert found == numbers(stage)


def test_what_feeds_it_counts(stage):
    """Another parameter upstream is another place in the graph: other numbers."""
    other = NOISE.replace("one: {uses: toy.constant}", "one: {uses: toy.constant, with: {value: 1.5}}")
    one, two = numbers(stage), numbers(stage, other)
    assert not set(np.round(np.array(one["note"]) - 1, 9)) & set(np.round(np.array(two["note"]) - 1.5, 9))
    assert one["note2"] == two["note2"]


def test_a_seed_of_any_size_is_taken(stage):
    for seed in (0, 2**40, 2**70):
        numbers(stage, seed=seed)

"""Graph files and graphs: read, bind, check, build in code."""

from visint.graph.alter import alter
from visint.graph.builder import Builder
from visint.graph.graph import Graph
from visint.graph.load import load, parse_graph
from visint.graph.schema import json_schema

__all__ = ["Builder", "Graph", "alter", "json_schema", "load", "parse_graph"]

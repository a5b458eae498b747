"""The scenario file: reading (every problem at once), writing, its schema, a first example.

The one place that maps names to declarations and files to models.
"""

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model.writing import brief, dump, save, tree_of
from ropewalk.scenario.loading import load, loads, varying
from ropewalk.scenario.schema import json_schema
from ropewalk.scenario.template import template

__all__ = [
    "Problem",
    "ScenarioError",
    "brief",
    "dump",
    "json_schema",
    "load",
    "loads",
    "save",
    "template",
    "tree_of",
    "varying",
]

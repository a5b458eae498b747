"""The name of `ropewalk.external` up to version 0.1: scenario files that name adapters there keep working."""

from warnings import warn

from ropewalk.external import __path__ as __path__

warn("ropewalk.foreign is called ropewalk.external now", DeprecationWarning, stacklevel=2)

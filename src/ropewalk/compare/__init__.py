"""Is a simpler model good enough here? The hierarchy of models from the linear theory to full feedback, compared."""

from ropewalk.compare.hierarchy import distances, model_hierarchy
from ropewalk.compare.quantities import QUANTITIES
from ropewalk.compare.result import ModelHierarchy
from ropewalk.compare.simpler_models import MODELS

__all__ = ["MODELS", "QUANTITIES", "ModelHierarchy", "distances", "model_hierarchy"]

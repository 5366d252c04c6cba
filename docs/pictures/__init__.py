"""Pictures of what a model learned that only the documentation shows: dictionary and hierarchy."""

from pictures.dictionary_picture import draw_dictionary
from pictures.hierarchy_picture import draw_hierarchy

__all__ = ["draw_dictionary", "draw_hierarchy"]

"""Shape motifs: dictionary of segments, decomposition of objects, hierarchies of motifs, stimuli."""

from shapeconcepts.motifs.decomposition import Decomposition, decompose
from shapeconcepts.motifs.dictionary import SegmentDictionary
from shapeconcepts.motifs.ensemble import MotifHierarchyEnsemble
from shapeconcepts.motifs.explanation import Explanation, FiredMotif, SimilarPrototype
from shapeconcepts.motifs.hierarchy import MotifHierarchies

__all__ = [
    "Decomposition",
    "Explanation",
    "FiredMotif",
    "MotifHierarchies",
    "MotifHierarchyEnsemble",
    "SegmentDictionary",
    "SimilarPrototype",
    "decompose",
]

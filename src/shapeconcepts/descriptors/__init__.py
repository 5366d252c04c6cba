"""Descriptors: histograms of segments that add up over sets of segments."""

from shapeconcepts.descriptors.curvature import Curvature, compute_principal_curvatures
from shapeconcepts.descriptors.described_object import DescribedObject, DescribedOcclusion, describe
from shapeconcepts.descriptors.described_scans import describe_scan, describe_scans, scans_in
from shapeconcepts.descriptors.fpfh import FPFH, compute_fpfh
from shapeconcepts.descriptors.joint import Joint
from shapeconcepts.descriptors.point_distances import PointDistances
from shapeconcepts.descriptors.protocol import Description, Descriptor
from shapeconcepts.descriptors.registry import get_descriptor
from shapeconcepts.descriptors.surflet import Surflet

__all__ = [
    "FPFH",
    "Curvature",
    "DescribedObject",
    "DescribedOcclusion",
    "Description",
    "Descriptor",
    "Joint",
    "PointDistances",
    "Surflet",
    "compute_fpfh",
    "compute_principal_curvatures",
    "describe",
    "describe_scan",
    "describe_scans",
    "get_descriptor",
    "scans_in",
]

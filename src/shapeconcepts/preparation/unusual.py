"""What in a cloud is unusual for a scan of one object from one place, in metres."""

from __future__ import annotations

from shapeconcepts.geometry.extent import robust_extent
from shapeconcepts.preparation.voxel_grid import VoxelGrid
from shapeconcepts.sources.units import TAKEN_AS_METRES

# Metres. Smaller and larger objects are mostly in other units.
USUAL_EXTENT = (0.005, 5.0)
UNITS = "its coordinates may not be in metres, which units tells (--units mm)"
ALL_SIDES = "expected is what a sensor sees from one place, only what is visible from one counts"
# Of scans thinned to 100 points, 98 % are a single segment, of those of 500 half.
FEWEST_POINTS = 100
TOO_FEW = f"too few to tell its surfaces apart, expected are at least {FEWEST_POINTS}"


def unusual(grid: VoxelGrid, is_complete: bool, known: tuple[str, ...] = ()) -> tuple[str, ...]:
    """What to say of a cloud, see `Scan.notices`.

    Parameters
    ----------
    grid : VoxelGrid
    is_complete : bool
        Whether it was seen from all sides, see `is_seen_from_all_sides`.
    known : tuple of str
        What its reader said already.
    """
    notices = []
    extent = robust_extent(grid.points)
    is_said = any(notice.endswith(TAKEN_AS_METRES) for notice in known)
    if len(grid.points) > 1 and not USUAL_EXTENT[0] <= extent <= USUAL_EXTENT[1] and not is_said:
        notices.append(f"is {extent:.3g} m across: {UNITS}")
    if (n_points := len(grid.point_to_voxel)) < FEWEST_POINTS:
        notices.append(f"has {n_points} points: {TOO_FEW}")
    if is_complete:
        notices.append(f"is seen from all sides: {ALL_SIDES}")
    return tuple(notices)

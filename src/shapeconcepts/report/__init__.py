"""Pictures and reports."""

from shapeconcepts.report.picture import contact_sheet, draw_points, draw_segments

__all__ = ["contact_sheet", "draw_points", "draw_segments"]

"""The report of a model: one HTML file that opens without a network."""

from shapeconcepts.report.html.page import write_report
from shapeconcepts.report.html.scan_preview import ScanPreview, preview

__all__ = ["ScanPreview", "preview", "write_report"]

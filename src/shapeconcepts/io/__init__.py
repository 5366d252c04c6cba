"""Files of scans: one module for each format that is read or written."""

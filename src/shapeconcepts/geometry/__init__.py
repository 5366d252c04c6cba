"""Geometry of points: neighbours within a radius, a frame that moves along, normals."""

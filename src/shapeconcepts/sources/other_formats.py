"""What lies beside scans, or in their place, and cannot be read as one: said, not passed over."""

from __future__ import annotations

# Formats of clouds, meshes and recordings, and what they can be turned into scans with.
_CLOUDS = "save it as .ply or .pcd, for example with CloudCompare or PDAL"
_MESHES = "save it as .obj, .ply, .stl or .glb, for example with Blender"
_RECORDINGS = "export its clouds or depth images first"
_ROS_RECORDINGS = "`shapeconcepts extract` finds the objects in it"
_OTHERS = {
    **dict.fromkeys((".las", ".laz", ".e57", ".ptx", ".pcap", ".fls", ".rcp"), _CLOUDS),
    **dict.fromkeys(
        (".gltf", ".fbx", ".dae", ".3ds", ".3mf", ".blend", ".wrl", ".x3d", ".usd", ".usdz"), _MESHES
    ),
    **dict.fromkeys((".step", ".stp", ".iges", ".igs"), _MESHES.replace("Blender", "FreeCAD")),
    **dict.fromkeys((".bag", ".mcap", ".db3"), _ROS_RECORDINGS),
    **dict.fromkeys((".oni", ".klg"), _RECORDINGS),
}
_POINTERS = {
    b"version https://git-lfs.github.com/spec/": "is a Git LFS pointer in place of the file: git lfs pull",
    b"/annex/objects/": "is a git-annex pointer in place of the file: git annex get",
}


def refusal_of_format(suffix: str) -> str:
    """Why a file with this suffix, in lower case, is not read though it may hold scans; else empty."""
    return f"the format {suffix} is not read: {_OTHERS[suffix]}" if suffix in _OTHERS else ""


def pointer_in(data: bytes) -> str:
    """What a file is that only points to its content, which somebody has to fetch; else empty."""
    return next((reason for start, reason in _POINTERS.items() if data.startswith(start)), "")

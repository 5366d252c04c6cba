"""The fields of a sample, as FiftyOne's `FiftyOneDataset` lists them."""

from __future__ import annotations

from typing import Any


def _field(
    name: str,
    kind: str,
    *,
    document: str | None = None,
    parts: str | None = None,
    fields: tuple[dict[str, Any], ...] = (),
    stored_as: str | None = None,
    description: str | None = None,
) -> dict[str, Any]:
    core = "fiftyone.core."
    return {
        "name": name,
        "ftype": f"{core}fields.{kind}Field",
        "embedded_doc_type": document and core + document,
        "subfield": parts and f"{core}fields.{parts}Field",
        "fields": list(fields),
        "db_field": stored_as or name,
        "description": description,
        "info": None,
    }


_LABEL = (
    _field("id", "ObjectId", stored_as="_id"),
    _field("tags", "List", parts="String"),
    _field("label", "String"),
)
_CLASSIFICATION = (*_LABEL, _field("confidence", "Float"), _field("logits", "Vector"))
_DETECTION = (
    *_LABEL,
    _field("attributes", "Dict", parts="EmbeddedDocument", document="labels.Attribute"),
    _field("bounding_box", "List", parts="Float"),
    _field("mask", "Array"),
    _field("mask_path", "String"),
    _field("confidence", "Float"),
    _field("index", "Int"),
)
_DETECTIONS = _field(
    "detections", "List", parts="EmbeddedDocument", document="labels.Detection", fields=_DETECTION
)

SAMPLE_FIELDS = [
    _field("id", "ObjectId", stored_as="_id"),
    _field("filepath", "String"),
    _field("tags", "List", parts="String"),
    _field("metadata", "EmbeddedDocument", document="metadata.Metadata"),
    _field("_media_type", "String"),
    _field("_rand", "Float"),
    _field("_dataset_id", "ObjectId"),
    _field("created_at", "DateTime"),
    _field("last_modified_at", "DateTime"),
    _field("concept", "EmbeddedDocument", document="labels.Classification", fields=_CLASSIFICATION),
    _field("box", "EmbeddedDocument", document="labels.Detections", fields=(_DETECTIONS,)),
    _field("scan", "String", description="name of the scan in the model"),
    _field("folder_label", "String", description="that the scan came with; nothing was learned from it"),
    _field("concept_number", "Int", description="-1 for none"),
    _field("concept_key", "Int", description="identity of the concept through updates; -1 for none"),
    _field("response", "Float", description="of its concept; smaller is more alike"),
    _field("p_value", "Float", description="that something known would be as unlike all other scans"),
    _field("is_medoid", "Boolean", description="whether it is the most typical scan of its concept"),
    _field("rank", "Int", description="by the distance from the medoid, which is 0"),
]

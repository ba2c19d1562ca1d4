"""Solids as one 3MF file: both parts in place in one object, their materials named.

Source: 3MF Core Specification 1.3. The archive is the same, byte for byte, for the same content.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from flexscale.fabricate.solids import Solid

NAMESPACE = "urn:flexscale:fabricate"
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_RELATION = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_MODEL = "3D/3dmodel.model"
_FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # the earliest date that an archive can hold
_PARTS = {
    "[Content_Types].xml": f"""<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="{_PACKAGE}/content-types">
 <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
 <Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
""",
    "_rels/.rels": f"""<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="{_PACKAGE}/relationships">
 <Relationship Target="/{_MODEL}" Id="rel0" Type="{_RELATION}"/>
</Relationships>
""",
}


@dataclass(frozen=True)
class PrintMaterial:
    """Name of a material, and the color ("#RRGGBB") it is shown in."""

    name: str
    color: str


def threemf_bytes(
    parts: Sequence[tuple[Solid, PrintMaterial]], title: str, metadata: Mapping[str, str]
) -> bytes:
    """Contents of a 3MF file.

    Parameters
    ----------
    parts : solids with their materials.
    title : of the object.
    metadata : further entries, in the namespace `NAMESPACE`.
    """
    texts = {**_PARTS, _MODEL: "\n".join(_model(parts, title, metadata)) + "\n"}
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in texts.items():
            archive.writestr(zipfile.ZipInfo(name, _FIRST_DAY), text, zipfile.ZIP_DEFLATED, 3)
    return file.getvalue()


def _model(
    parts: Sequence[tuple[Solid, PrintMaterial]], title: str, metadata: Mapping[str, str]
) -> list[str]:
    """Lines of the model: materials are object 1, the solids 2 and on, then what holds them."""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}" xmlns:fs="{NAMESPACE}">',
        f' <metadata name="Title">{escape(title)}</metadata>',
        ' <metadata name="Application">FlexScale</metadata>',
    ]
    lines += [
        f' <metadata name="fs:{name}">{escape(text)}</metadata>' for name, text in metadata.items()
    ]
    lines += [" <resources>", '  <basematerials id="1">']
    lines += [
        f'   <base name={quoteattr(material.name)} displaycolor="{material.color}"/>'
        for _, material in parts
    ]
    lines += ["  </basematerials>"]
    for number, (solid, _) in enumerate(parts):
        lines += [
            f'  <object id="{number + 2}" type="model" name={quoteattr(solid.name)} '
            f'pid="1" pindex="{number}"><mesh>',
            *_mesh(solid),
            "  </mesh></object>",
        ]
    last = len(parts) + 2
    lines += [f'  <object id="{last}" type="model" name={quoteattr(title)}><components>']
    lines += [f'   <component objectid="{number + 2}"/>' for number in range(len(parts))]
    return [
        *lines,
        "  </components></object>",
        " </resources>",
        f' <build><item objectid="{last}"/></build>',
        "</model>",
    ]


def _mesh(solid: Solid) -> list[str]:
    # numpy's str of a 32-bit number is the shortest text that gives it back: as in the STL files.
    vertices = tuple(solid.vertices.astype(str).ravel().tolist())
    faces = tuple(solid.faces.ravel().tolist())
    return [
        "   <vertices>",
        '<vertex x="%s" y="%s" z="%s"/>\n' * len(solid.vertices) % vertices,
        "   </vertices><triangles>",
        '<triangle v1="%d" v2="%d" v3="%d"/>\n' * len(solid.faces) % faces,
        "   </triangles>",
    ]

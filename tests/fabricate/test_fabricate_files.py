"""Files of printable sheets: what they hold, where they come from, and that they are whole."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import flexscale as fs
from flexscale.cli.fabricate_sheet import cell_dataset
from flexscale.errors import BadInputError
from flexscale.fabricate import Disc, Layout, PrintableSheet, Rectangle, printable_sheet
from flexscale.fabricate import files as fabricate_files
from flexscale.fabricate.files import ENDINGS, pattern_digest, sheet_name, write_sheet
from flexscale.fabricate.threemf import NAMESPACE
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from tests.fabricate.printable_checks import read_stl

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
STEM = "square-rectangle-30x20"


@pytest.fixture(scope="module")
def sheet() -> PrintableSheet:
    return printable_sheet(fs.named_pattern("square"), Rectangle(30.0, 20.0))


def model_of(data: bytes) -> ElementTree.Element:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
        assert {"[Content_Types].xml", "_rels/.rels"} < set(archive.namelist())
        return ElementTree.fromstring(archive.read("3D/3dmodel.model"))


def test_record_describes_the_files_beside_it(sheet: PrintableSheet, tmp_path: Path) -> None:
    dataset = {"id": "cell:0123456789ab", "recipe_digest": "01" * 32}
    paths = write_sheet(sheet, tmp_path, dataset)
    ends = ["-substrate.stl", "-scales.stl", ".txt", ".3mf", ".png", ".json"]
    assert [path.name for path in paths] == [STEM + end for end in ends]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(STEM + end for end in ends)
    record = json.loads(paths[-1].read_text())
    for path in paths[:-1]:
        data = path.read_bytes()
        assert record["files"][path.name]["sha256"] == hashlib.sha256(data).hexdigest()
    assert record["dataset"] == "cell:0123456789ab"
    assert fs.Pattern.from_config(record["pattern"]) == sheet.pattern
    figures = record["figures"]
    assert figures["volumes_mm3"]["scales"] == pytest.approx(sheet.expected_volumes()["scales"])
    mass = (
        1.27e-3 * figures["volumes_mm3"]["scales"] + 1.19e-3 * figures["volumes_mm3"]["substrate"]
    )
    assert figures["masses_g"]["total"] == pytest.approx(mass)
    assert figures["print_size_mm"] == pytest.approx([42.0, 20.0, 6.0], abs=1e-3)
    assert figures["layers"] == 60
    assert "42 x 20 x 6 mm, 60 layers" in (tmp_path / f"{STEM}.txt").read_text()
    with Image.open(tmp_path / f"{STEM}.png") as picture:
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 50


def test_3mf_holds_both_parts_with_their_materials(sheet: PrintableSheet, tmp_path: Path) -> None:
    paths = write_sheet(sheet, tmp_path)
    model = model_of((tmp_path / f"{STEM}.3mf").read_bytes())
    assert model.get("unit") == "millimeter"
    bases = [base.get("name") for base in model.iter(f"{CORE}base")]
    assert bases == ["TPU", "PETG"]
    meshes = [item for item in model.iter(f"{CORE}object") if item.find(f"{CORE}mesh") is not None]
    assert [(item.get("name"), item.get("pindex")) for item in meshes] == [
        ("substrate", "0"),
        ("scales", "1"),
    ]
    for item, path in zip(meshes, paths[:2], strict=True):
        corners = [[float(v.get(k)) for k in "xyz"] for v in item.iter(f"{CORE}vertex")]
        faces = [[int(t.get(f"v{k}")) for k in (1, 2, 3)] for t in item.iter(f"{CORE}triangle")]
        vertices, triangles = read_stl(path.read_bytes())
        told = np.array(corners, dtype=np.float32)[np.array(faces)]
        assert np.array_equal(told, vertices[triangles].astype(np.float32))
    components = [item.get("objectid") for item in model.iter(f"{CORE}component")]
    assert components == [item.get("id") for item in meshes]
    metadata = {item.get("name"): item.text for item in model.iter(f"{CORE}metadata")}
    assert metadata["fs:pattern_digest"] == pattern_digest(sheet.pattern)
    assert json.loads(metadata["fs:pattern"])["family"] == "IH76"
    assert f'xmlns:fs="{NAMESPACE}"'.encode() in zipfile.ZipFile(tmp_path / f"{STEM}.3mf").read(
        "3D/3dmodel.model"
    )


def test_equal_sheets_have_equal_files(sheet: PrintableSheet, tmp_path: Path) -> None:
    again = printable_sheet(fs.named_pattern("square"), Rectangle(30.0, 20.0))
    for number, one in enumerate((sheet, again)):
        (tmp_path / str(number)).mkdir()
        write_sheet(one, tmp_path / str(number))
    for path in (tmp_path / "0").iterdir():
        assert path.read_bytes() == (tmp_path / "1" / path.name).read_bytes()


def test_what_is_interrupted_has_no_record(
    sheet: PrintableSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_sheet(sheet, tmp_path)
    whole = fabricate_files.write_atomically
    written: list[str] = []

    def stops_in_the_third(path: Path, write: object) -> None:
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(path.name)
        whole(path, write)

    monkeypatch.setattr(fabricate_files, "write_atomically", stops_in_the_third)
    with pytest.raises(KeyboardInterrupt):
        write_sheet(sheet, tmp_path, replace=True)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert f"{STEM}.json" not in left
    assert not [name for name in left if name.endswith(".part")]
    for name in (f"{STEM}-substrate.stl", f"{STEM}-scales.stl"):
        read_stl((tmp_path / name).read_bytes())


def test_a_full_disk_is_told(
    sheet: PrintableSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, write: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(fabricate_files, "write_atomically", full)
    with pytest.raises(BadInputError, match=f"{STEM} cannot be written to .*: No space left"):
        write_sheet(sheet, tmp_path)


def test_files_that_are_there_are_not_written_over(sheet: PrintableSheet, tmp_path: Path) -> None:
    (tmp_path / f"{STEM}-scales.stl").write_text("of an earlier sheet")
    with pytest.raises(BadInputError, match=f"{STEM}-scales.stl is there already: name another"):
        write_sheet(sheet, tmp_path)
    assert [path.read_text() for path in tmp_path.iterdir()] == ["of an earlier sheet"]
    paths = write_sheet(sheet, tmp_path, replace=True)
    assert {path.name for path in paths} == {f"{STEM}{ending}" for ending in ENDINGS}
    with pytest.raises(BadInputError, match="is there already, and 5 more that would be written"):
        write_sheet(sheet, tmp_path)


def test_a_missing_folder_is_refused(sheet: PrintableSheet, tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="There is no folder"):
        write_sheet(sheet, tmp_path / "nowhere")


def test_files_are_named_after_pattern_shape_and_direction() -> None:
    pattern = fs.named_pattern("square").with_(name="4.8.8")
    turned = Layout(direction=12.5)
    assert sheet_name(pattern, Disc(20.0), turned) == "4.8.8-disc-20-12.5deg"


@pytest.mark.parametrize("name", [entry.name for entry in fs.named_patterns()])
def test_sheets_carry_the_identity_of_the_datasets_of_their_pattern(name: str) -> None:
    content = {"patterns": {name: {"named": name}}, "native": "shell", "mesh": {"along": 0.7}}
    experiment = parse_experiment(content, "file.yaml")
    job = build_plan(experiment).jobs[0]
    pattern = experiment.build_patterns()[name]
    told = cell_dataset(pattern, experiment.mesh)
    assert told["recipe_digest"] == job.recipe.digest()
    assert told["id"] == f"cell:{told['recipe_digest'][:12]}"
    assert pattern_digest(pattern) == pattern_digest(fs.named_pattern(name))
    assert pattern_digest(pattern) != pattern_digest(pattern.with_(gap=0.5))
    other = cell_dataset(pattern, fs.MeshOptions())
    assert other["recipe_digest"] != told["recipe_digest"]

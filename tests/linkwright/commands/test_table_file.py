"""Tables as files: the same figures in every kind, and nothing in a cell that the kind would take for its own."""

import re

import pandas as pd
import pytest

import linkwright as lw
from linkwright.core.arm.actuators import USER_ACTUATORS, load_actuators, shipped_actuators
from linkwright.core.sections import Tube
from linkwright.core.units.quantities import InputError
from linkwright.output.table_file import write_table
from tests.linkwright.samples import arm_of

TABLE = pd.DataFrame({"part_name": ["50 % & more_$#{}~^\\", "a|b"], "mass_kg": [1.25, float("nan")]})


def test_markdown_has_as_many_cells_as_heads(tmp_path):
    write_table(TABLE, tmp_path / "a.md")
    lines = (tmp_path / "a.md").read_text(encoding="utf-8").splitlines()
    assert lines[1] == "| --- | ---: |"
    assert [len(re.findall(r"(?<!\\)\|", line)) for line in lines] == [3] * 4


def test_a_list_of_parts_is_the_same_in_every_kind(tmp_path):
    result = lw.export_arm(lw.Arm.of(arm_of((Tube(0.08, 0.005),), (0.4,))), to="bom")
    for name in ("a.csv", "a.parquet"):
        result.save(tmp_path / name)
    csv, parquet = pd.read_csv(tmp_path / "a.csv"), pd.read_parquet(tmp_path / "a.parquet")
    assert list(csv.columns) == list(parquet.columns)
    figures = list(parquet.select_dtypes("number").columns)
    assert figures[:2] == ["length_mm", "mass_kg"]
    for name in figures:
        assert parquet[name].tolist() == pytest.approx(csv[name].tolist(), rel=1e-12, nan_ok=True)


def test_another_ending_is_one_line(tmp_path):
    with pytest.raises(InputError, match=r"\.csv, \.parquet, \.pq, \.md$"):
        write_table(TABLE, tmp_path / "a.doc")


@pytest.mark.parametrize(
    ("command", "names", "figure"),
    [
        (("materials",), ("steel-s355", "aluminium-6061-t6"), "density_kg_per_m3"),
        (("sections",), ("IPE 80", "CHS 60.3x4"), None),
        (("actuators",), ("RV-20E", "CSG-25-100-2UH"), "rated_torque_Nm"),
    ],
)
def test_catalogues_as_tables(command, names, figure, linkwright, bench):
    for ending in ("parquet", "md"):
        status, _, said = linkwright(*command, "export", *names, "--out", f"all.{ending}")
        assert status == 0, said
    table = pd.read_parquet(bench / "all.parquet")
    assert table["name"].tolist() == list(names)
    known = {"materials": lw.materials, "sections": lw.sections, "actuators": lw.actuators}[command[0]]
    if figure is not None:
        everything = known.table.set_index("name")
        assert table[figure].tolist() == [everything.loc[name, figure] for name in names]
    assert (bench / "all.md").read_text(encoding="utf-8").count("\n") == 4


def test_actuators_come_back_from_a_spreadsheet(linkwright, bench, monkeypatch):
    """Zones, prices and sources survive; a workbook is read like the text that it holds."""
    status, _, said = linkwright("actuators", "export", "CSG-25-100-2UH", "RV-20E", "--out", "drives.csv")
    assert status == 0, said
    rows = pd.read_csv(bench / "drives.csv", dtype=str)
    assert rows["stiffness"][0] == "31 kN*m/rad; 50 kN*m/rad; 57 kN*m/rad"
    rows["mass"] = ["1.6 kg", "4.8 kg"]
    rows.to_excel(bench / "drives.xlsx", index=False)
    monkeypatch.setenv(USER_ACTUATORS.variable, str(bench / "mine.yaml"))
    status, _, said = linkwright("actuators", "import", "drives.xlsx")
    assert status == 0, said
    shipped, own = shipped_actuators()["CSG-25-100-2UH"], load_actuators().find("CSG-25-100-2UH")
    assert own.mass == 1.6
    assert (own.stiffnesses, own.zone_torques) == (shipped.stiffnesses, shipped.zone_torques)
    assert (own.maker, own.gear, own.ratio, own.source) == (shipped.maker, shipped.gear, 100.0, shipped.source)
    rows["mass"] = ["heavy", "4.9 kg"]
    rows.to_csv(bench / "drives.csv", index=False)
    status, _, said = linkwright("actuators", "import", "--replace", "drives.csv")
    assert (status, said.count("\n")) == (2, 2)
    assert "CSG-25-100-2UH.mass" in said
    assert "1 of 2 actuators were not taken" in said
    assert [load_actuators().find(name).mass for name in ("CSG-25-100-2UH", "RV-20E")] == [1.6, 4.9]


@pytest.mark.slow
def test_the_papers_tables_as_markdown_and_parquet(linkwright, bench):
    for kind in ("parquet", "md"):
        status, _, said = linkwright("tables", "--csv", f"as-{kind}", "--as", kind)
        assert status == 0, said
        status, _, said = linkwright("tables", "--csv", f"as-{kind}", "--as", kind)
        assert status == 0, said
    assert linkwright("tables", "--csv", "as-md")[0] == 2
    assert linkwright("tables", "--csv", "as-csv")[0] == 0
    for key in ("clearance", "material"):
        csv, parquet = (
            pd.read_csv(bench / "as-csv" / f"{key}.csv"),
            pd.read_parquet(bench / f"as-parquet/{key}.parquet"),
        )
        pd.testing.assert_frame_equal(csv, parquet)
        assert (bench / f"as-md/{key}.md").read_text(encoding="utf-8").count("\n") == len(csv) + 2


def test_a_compensation_as_a_table(linkwright, bench):
    for name in ("table.csv", "table.parquet", "table.md"):
        status, _, said = linkwright("compensate", "arm.yaml", "--grid", "2", "--out", name)
        assert status == 0, said
    csv, parquet = pd.read_csv(bench / "table.csv"), pd.read_parquet(bench / "table.parquet")
    assert list(csv.columns) == list(parquet.columns)
    assert (bench / "table.md").read_text(encoding="utf-8").count("\n") == len(csv) + 2

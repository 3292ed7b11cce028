"""Tables as files: the same figures in every kind, and nothing in a cell that the kind would take for its own."""

import re

import pandas as pd
import pytest

import linkwright as lw
from linkwright.output.table_file import write_table
from sections import Tube
from tests.linkwright.samples import arm_of
from units.quantities import InputError

TABLE = pd.DataFrame({"part_name": ["50 % & more_$#{}~^\\", "a|b"], "mass_kg": [1.25, float("nan")]})


def test_latex_is_balanced_and_escaped(tmp_path):
    write_table(TABLE, tmp_path / "a.tex")
    text = (tmp_path / "a.tex").read_text(encoding="utf-8")
    assert r"\begin{tabular}{lr}" in text
    head, first, second = (line for line in text.splitlines() if line.endswith(r"\\"))
    assert head == r"part\_name & mass\_kg \\"
    assert first == r"50 \% \& more\_\$\#\{\}\textasciitilde{}\textasciicircum{}\textbackslash{} & 1.25 \\"
    assert second == r"a|b &  \\"
    assert all(len(re.findall(r"(?<!\\)&", line)) == 1 for line in (head, first, second))
    bare = re.sub(r"\\[{}]", "", text)
    assert bare.count("{") == bare.count("}")


def test_markdown_has_as_many_cells_as_heads(tmp_path):
    write_table(TABLE, tmp_path / "a.md")
    lines = (tmp_path / "a.md").read_text(encoding="utf-8").splitlines()
    assert lines[1] == "| --- | ---: |"
    assert [len(re.findall(r"(?<!\\)\|", line)) for line in lines] == [3] * 4


def test_a_list_of_parts_is_the_same_in_every_kind(tmp_path):
    found = lw.export_arm(lw.Arm.of(arm_of((Tube(0.08, 0.005),), (0.4,))), to="bom")
    for name in ("a.csv", "a.parquet"):
        found.save(tmp_path / name)
    csv, parquet = pd.read_csv(tmp_path / "a.csv"), pd.read_parquet(tmp_path / "a.parquet")
    assert list(csv.columns) == list(parquet.columns)
    figures = list(parquet.select_dtypes("number").columns)
    assert figures[:2] == ["length_mm", "mass_kg"]
    for name in figures:
        assert parquet[name].tolist() == pytest.approx(csv[name].tolist(), rel=1e-12, nan_ok=True)


def test_another_ending_is_one_line(tmp_path):
    with pytest.raises(InputError, match=r"\.csv, \.parquet, \.pq, \.md, \.tex"):
        write_table(TABLE, tmp_path / "a.doc")

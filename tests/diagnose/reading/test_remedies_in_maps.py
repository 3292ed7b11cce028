"""What a refusal says to write can be written where it says: into a file's own map, in the words of its columns."""

import re

import numpy as np
import pytest
import yaml

from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.units.quantities import InputError
from tests.diagnose.reading.test_foreign_files import ANGLES, TIPS, read

HEADER = "Eje 1 (grados),Eje 2 (grados),X medida (mm),Y medida (mm)"
MAPPED = {
    "q1_deg": "`Eje 1 (grados)`",
    "q2_deg": "`Eje 2 (grados)`",
    "x_mm": "`X medida (mm)`",
    "y_mm": "`Y medida (mm)`",
}


def table(*factors):
    """A recording whose columns are so many times what they should be."""
    rows = np.column_stack([np.degrees(ANGLES), 1e3 * TIPS]) * factors
    return "\n".join([HEADER, *(",".join(f"{cell:.9f}" for cell in row) for row in rows)])


def refused(folder, content, settings):
    with pytest.raises(InputError) as error:
        read(folder, content, settings)
    return error.value


@pytest.mark.parametrize(
    ("factors", "other", "expected"),
    [
        ((1, -1, 1, 1), {}, {"q2_deg": "-`Eje 2 (grados)`"}),
        ((1, -1, 1, 1), {"q2_deg": "2*`Eje 2 (grados)`/2 + 0"}, {"q2_deg": "-(2*`Eje 2 (grados)`/2 + 0)"}),
        ((1, 1, 1e-3, 1e-3), {}, {"x_mm": "1000*`X medida (mm)`", "y_mm": "1000*`Y medida (mm)`"}),
    ],
)
def test_the_lines_of_a_map_are_changed(tmp_path, factors, other, expected):
    """And read as they should be, once they are."""
    mapped = {**MAPPED, **other}
    error = refused(tmp_path, table(*factors), yaml.safe_dump({"columns": mapped}))
    assert [dict(remedy) for remedy in error.remedies] == [{"columns": expected}]
    of = " and ".join(expected)
    lines = [f'{ours}: "{formula}"' for ours, formula in expected.items()]
    change = f"change the line{'s' * (len(expected) > 1)} of {of} to {' and '.join(lines)}"
    assert f"in `columns` of recording.yaml {change}" in str(error)
    changed = mapped | yaml.safe_load("\n".join(lines))
    result = read(tmp_path, table(*factors), yaml.safe_dump({"columns": changed}))
    assert result.q == pytest.approx(ANGLES, abs=1e-6)
    assert result.tip == pytest.approx(TIPS, abs=1e-7)


@pytest.mark.parametrize("header", [HEADER, "Q1 (deg),Q2 (deg),X (mm),Y (mm)"])
def test_without_a_map_one_is_written(tmp_path, header):
    """Of headers that are taken for ours, or spelled otherwise: the sentence holds the whole of it."""
    content = table(1, -1, 1, 1).replace(HEADER, header)
    error = refused(tmp_path, content, "")
    written = re.search(r"write `(columns: \{.*\})` in recording.yaml", str(error))
    assert written is not None
    assert read(tmp_path, content, written[1]).q == pytest.approx(ANGLES, abs=1e-6)


def test_what_a_map_lacks_is_added_to_it(tmp_path):
    """A second `columns` would be refused."""
    content = table(1, -1, 1, 1).replace(HEADER, "q1_deg,q2_deg,X,Y")
    settings = "columns: {x_mm: X, y_mm: Y%s}"
    error = refused(tmp_path, content, settings % "")
    assert 'in `columns` of recording.yaml add q2_deg: "-q2_deg"' in str(error)
    assert read(tmp_path, content, settings % ", q2_deg: -q2_deg").q == pytest.approx(ANGLES, abs=1e-6)


def test_settings_beside_columns():
    headers = Headers({"q1": "q1_deg"}, {"q1_deg": "A"}, ("q1_deg",), "may.yaml")
    assert headers.write({"columns": {"q1_deg": "-q1_deg"}, "frame": "free"}) == (
        'in `columns` of may.yaml change the line of q1_deg to q1_deg: "-A" and write `frame: free` beside them'
    )
    assert headers.write({"frame": "free"}) == "write `frame: free` in recording.yaml"

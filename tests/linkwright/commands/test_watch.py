"""`linkwright watch`: a series on disk, screen, files and the Python face alike; wrong input in one line."""

import datetime
import json

import pytest

import linkwright as lw
from linkwright.core.diagnose.reading.write import recording_text, settings_text
from tests.diagnose.several.days import arm, day

FIRST = datetime.date(2026, 1, 5)


@pytest.fixture(scope="module")
def weeks(tmp_path_factory):
    """A folder with an arm and ten weekly recordings; drive 2 gives twice as much from the seventh on."""
    folder = tmp_path_factory.mktemp("weeks")
    lw.Arm.of(arm()).save(folder / "arm.yaml")
    for week in range(10):
        made = day(200 + week, poses=10, compliance={2: 30e-6 * (1 + (week >= 6))})
        file = folder / f"week-{week}.csv"
        file.write_text(recording_text(made, arm()), encoding="utf-8")
        date = FIRST + datetime.timedelta(weeks=week)
        file.with_suffix(".yaml").write_text(f"{settings_text(made)}date: {date.isoformat()}\n", encoding="utf-8")
    return folder


def test_a_drive_that_softened(linkwright, weeks, tmp_path):
    out, files = tmp_path / "out", [weeks / f"week-{week}.csv" for week in range(10)]
    given = ("watch", str(weeks / "arm.yaml"), *map(str, files), "--no-search", "--for", "joint_compliance")
    status, said, err = linkwright(*given, "--out", str(out), "--markdown", str(tmp_path / "said.md"))
    assert (status, err) == (0, "")
    result = lw.watch(weeks / "arm.yaml", files[::-1], for_=["joint_compliance"], search=False)
    assert (out / "result.json").read_text(encoding="utf-8") == result.to_json()
    content = json.loads(result.to_json())
    (alarm,) = content["alarms"]
    assert (alarm["effect"], alarm["at"], alarm["kind"]) == ("joint_compliance", [2], "step")
    assert (alarm["from"], alarm["to"]) == ("2026-02-09", "2026-02-16")
    assert alarm["ci95"][0] < 30e-6 < alarm["ci95"][1]
    assert alarm["unit"] == "rad/(N*m)"
    series = next(item for item in content["parameters"] if item["at"] == [2])
    first, last = series["values"][0], series["values"][-1]
    assert first["limits"][0] < first["value"] < first["limits"][1] < last["value"]
    words = " ".join(said.split())
    for each in ("Moved: compliance of the drives (joint 2)", "between 2026-02-09 and 2026-02-16", "false alarm"):
        assert each in words
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg") == len(content["parameters"]) + 1
    assert "What moved" in (tmp_path / "said.md").read_text(encoding="utf-8")
    assert result.moved
    assert list(result.alarms["kind"]) == ["step"]
    assert len(result.values) == 10 * (len(content["parameters"]) + 1)
    assert len(result.plot().data) == len(content["parameters"]) + 1
    assert len(repr(result)) < 250


def _changed(weeks, tmp_path, replaced):
    """The first three weeks with other settings for the last of them."""
    for week in range(3):
        for ending in ("csv", "yaml"):
            text = (weeks / f"week-{week}.{ending}").read_text(encoding="utf-8")
            if week == 2 and ending == "yaml":
                text = text.replace("date: 2026-01-19\n", replaced)
            (tmp_path / f"week-{week}.{ending}").write_text(text, encoding="utf-8")
    return [str(weeks / "arm.yaml"), *(str(tmp_path / f"week-{week}.csv") for week in range(3))]


@pytest.mark.parametrize(
    ("replaced", "said"),
    [
        ("", ("week-2.yaml", "date", "2026-05-16")),
        ("date: 2026-01-05\n", ("week-2.csv", "week-0.csv", "2026-01-05")),
        ("date: soon\n", ("week-2.yaml", "date", "soon")),
    ],
    ids=["no date", "a date twice", "no such date"],
)
def test_dates_that_tell_no_order(linkwright, weeks, tmp_path, replaced, said):
    status, _, err = linkwright("watch", *_changed(weeks, tmp_path, replaced))
    assert status == 2
    assert err.count("\n") == 1
    for item in said:
        assert item in err


def test_other_wrong_input(linkwright, weeks, tmp_path):
    """Recordings of several arms, too few of them, a copy of one, an effect that nobody knows."""
    copies = _changed(weeks, tmp_path, "date: 2026-01-19\n")
    (tmp_path / "week-1.csv").write_bytes((tmp_path / "week-2.csv").read_bytes())
    status, _, err = linkwright("watch", *copies)
    assert (status, err.count("\n")) == (2, 1)
    assert "hold the same readings twice (week-1.csv and week-2.csv)" in err
    given = _changed(weeks, tmp_path, "date: 2026-01-19\nunit: serial 8\n")
    first = tmp_path / "week-0.yaml"
    first.write_text(f"{first.read_text(encoding='utf-8')}unit: serial 7\n", encoding="utf-8")
    for arguments, words in (
        (given, "serial 7"),
        (given[:3], "3 recordings or more"),
        ([*given, "--for", "backlsh"], "backlash"),
        ([*given, "--without-effect", "backlsh"], "backlash"),
    ):
        status, _, err = linkwright("watch", *arguments)
        assert status == 2
        assert err.count("\n") == 1
        assert words in err

"""`observes:` of recording.yaml: what each row holds, and what cannot be."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Joint
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.plan.simulate import Plan, simulate
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.reading.write import recording_text, settings_text
from linkwright.core.units.quantities import InputError
from tests.diagnose.instruments.spatial_arm import RANGE, placed, spatial_arm
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

ALONG = slots_of("along")[0]
DISTANCE = slots_of("distance")[0]

Q = poses(24)
TIP = planar_tip(Q)
ANCHOR = np.array([0.5, -1.0])
DISTANCES = np.linalg.norm(TIP - ANCHOR, axis=1)


def _file(tmp_path, settings, columns):
    (tmp_path / "r.yaml").write_text(settings)
    return written(tmp_path / "r.csv", columns)


def _read(tmp_path, settings, columns, arm=None):
    return read_recording(_file(tmp_path, settings, columns), arm or planar_arm())


def _only(*names, **further):
    own = table(Q, TIP, **further)
    return {name: cells for name, cells in own.items() if name[0] == "q" or name in names or name in further}


def test_a_column_that_was_not_measured_may_be_absent_or_blank(tmp_path):
    absent = _read(tmp_path, "observes: position", _only("y_mm"))
    assert absent.slots.tolist() == [[1]] * 24
    assert absent.tip[:, 0] == pytest.approx(TIP[:, 1], abs=1e-9)

    blank = _read(tmp_path, "frame: known", table(Q, TIP) | {"x_mm": [""] * 24})
    assert blank.tip == pytest.approx(absent.tip)
    assert any("Only what was measured counts" in text for text in blank.warnings)


def test_blank_cells_here_and_there_cost_their_rows_as_ever(tmp_path):
    columns = table(Q, TIP)
    columns["x_mm"][5] = ""
    recording = _read(tmp_path, "frame: known", columns)

    assert recording.slots is None
    assert [item.row for item in recording.rejected] == [7]


def test_rows_that_hold_different_things_are_readings_of_one_number_each(tmp_path):
    columns = _only("x_mm", "y_mm", distance_mm=1e3 * DISTANCES)
    for row in range(24):
        for name in ("x_mm", "y_mm") if row % 2 else ("distance_mm",):
            columns[name][row] = ""
    recording = _read(tmp_path, "observes: [position, distance]\nanchor: [500 mm, -1 m]", columns)

    assert recording.instrument.anchor == (0.5, -1.0, 0.0)
    assert recording.tip.shape == (36, 1)
    assert sorted(set(recording.row[recording.slots[:, 0] == DISTANCE].tolist())) == list(range(3, 26, 2))
    one = recording.row == 4
    assert recording.slots[one, 0].tolist() == [0, 1]
    assert recording.tip[one, 0] == pytest.approx(TIP[2], abs=1e-9)


def test_everything_measured_is_a_recording_as_ever(tmp_path):
    assert _read(tmp_path, "observes: position", table(Q, TIP)).slots is None


def test_heights_and_distances_are_strangers_where_nobody_says_that_they_are_observed(tmp_path):
    recording = _read(tmp_path, "frame: known", _only("x_mm", "y_mm", distance_mm=1e3 * DISTANCES))

    assert recording.slots is None
    assert recording.other["distance_mm"] == pytest.approx(1e3 * DISTANCES, abs=1e-6)


@pytest.mark.parametrize(
    ("settings", "columns", "words"),
    [
        ("observes: positon", _only("x_mm"), r"observes: 'positon' is not one of .*did you mean 'position'"),
        ("observes: [along, along]\ndirection: [0, 1, 0]", _only("x_mm"), "names along twice"),
        ("observes: along", _only(along_mm=TIP[:, 1]), r"direction: is missing"),
        ("observes: along\ndirection: [0, 0, 0]", _only(along_mm=TIP[:, 1]), r"\[0, 0, 0\] has no length"),
        ("direction: [0, 0, 1]", _only("x_mm", "y_mm"), "goes with `observes: along`"),
        ("observes: along\ndirection: [0, 1, 0]", _only("x_mm", "y_mm"), r"along: is missing.*along_mm or along_m"),
        ("observes: distance", _only(distance_mm=DISTANCES), r"anchor: is missing.*anchor: free"),
        ("observes: distance\nanchor: [1, 0, 0]", _only(distance_mm=DISTANCES), r"anchor\[1\]"),
        ("observes: distance\nanchor: free", _only(distance_mm=-1e3 * DISTANCES), "distance_mm: is negative in most"),
        ("observes: distance\nanchor: [500 mm, -1 m]", _only(distance_mm=DISTANCES), "numbers were 1000 times larger"),
        ("observes: distance\nanchor: [5 m, 1 m]", _only(distance_mm=1e3 * DISTANCES), "the middle reading is"),
        ("observes: same_point", _only("x_mm"), "point: is missing: a column of labels"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, settings, columns, words):
    with pytest.raises(InputError, match=words) as caught:
        _read(tmp_path, settings, columns)
    assert "\n" not in str(caught.value)


def test_an_anchor_that_every_reading_could_satisfy(tmp_path):
    q = np.repeat(Q[:2], 6, axis=0)
    distances = np.linalg.norm(planar_tip(q) - ANCHOR, axis=1)
    columns = {k: v for k, v in table(q, planar_tip(q), distance_mm=1e3 * distances).items() if k[0] not in "xy"}

    with pytest.raises(InputError, match="anchor: is free, and distances from 2 places"):
        _read(tmp_path, "observes: distance\nanchor: free", columns)


def _touching(label, text, rows=24):
    own = {name: cells for name, cells in table(Q, TIP).items() if name[0] == "q"}
    return {name: cells[:rows] for name, cells in (own | {label: text}).items()}


@pytest.mark.parametrize(
    ("kind", "columns", "words"),
    [
        ("same_point", _touching("point", ["a"] * 23 + ["lonely"]), r"point: 'lonely' has 1 row only \(row 25\)"),
        ("plane", _touching("plane", ["a"] * 22 + ["b"] * 2), r"plane: 'b' has 2 rows only .*3 postures or more"),
        ("[same_point, plane]", _touching("point", ["a"] * 24) | {"plane": ["b"] * 24}, "row 2 names a point and a"),
    ],
)
def test_labels_that_tell_nothing(tmp_path, kind, columns, words):
    with pytest.raises(InputError, match=words):
        _read(tmp_path, f"observes: {kind}", columns)


def test_a_plane_that_is_touched_on_a_line(tmp_path):
    """All joints still but a slide at the end, which goes straight."""
    arm = spatial_arm()
    arm = replace(arm, joints=(*arm.joints[:-1], Joint(type="prismatic", axis=(1.0, 0.0, 0.0), range=(0.0, 0.5))))
    q = np.zeros((8, 5))
    q[:, 4] = np.linspace(0.0, 0.4, 8)
    columns = {f"q{k + 1}_deg": [f"{np.degrees(x):.6f}" for x in q[:, k]] for k in range(4)}
    columns |= {"q5_mm": [f"{1e3 * x:.5f}" for x in q[:, 4]], "plane": ["plate"] * 8}

    with pytest.raises(InputError, match="plane: 'plate' is touched on a line only"):
        _read(tmp_path, "observes: plane", columns, arm)


@pytest.mark.parametrize(("kind", "slots"), [("same_point", (5, 6, 7)), ("plane", (8,))])
def test_simulated_touches_touch_and_are_read_back(tmp_path, kind, slots):
    arm = spatial_arm()
    plan = Plan(poses=24, repeats=2, sides="one", noise=20e-6, slots=slots, instrument=Instrument((kind,)))
    made = simulate(arm, plan).recording
    (tmp_path / "s.csv").write_text(recording_text(made, arm))
    (tmp_path / "s.yaml").write_text(settings_text(made))
    again = read_recording(tmp_path / "s.csv", arm)

    assert made.size >= 24
    assert again.touches.tolist() == made.touches.tolist()
    tip = placed(made.q)[0]
    for label in range(len(made.instrument.labels)):
        own = tip[made.touches == label]
        off = own - own.mean(axis=0)
        if kind == "plane":
            off = off @ np.linalg.svd(off)[2][-1][:, None]
        assert 5e-6 < np.sqrt(np.mean(off**2)) < 30e-6
        assert np.ptp(made.q[made.touches == label], axis=0).max() > 0.3


def test_a_single_row_far_off_is_set_aside(tmp_path):
    far = DISTANCES.copy()
    far[4] += 0.05
    recording = _read(tmp_path, "observes: distance\nanchor: [500 mm, -1 m]", _only(distance_mm=1e3 * far))

    assert [item.row for item in recording.rejected] == [6]


@pytest.mark.parametrize(
    ("slots", "instrument"),
    [((2,), {}), ((ALONG,), {"direction": (0.0, 0.6, 0.8)}), ((DISTANCE,), {"anchor": (0.2, 1.1, 0.4)})],
)
def test_what_is_simulated_is_read_back_as_it_was(tmp_path, slots, instrument):
    arm, kind = spatial_arm(), {2: "position", ALONG: "along", DISTANCE: "distance"}[slots[0]]
    plan = Plan(poses=9, repeats=2, noise=0.0, slots=slots, instrument=Instrument((kind,), **instrument))
    made = simulate(arm, plan).recording
    (tmp_path / "s.csv").write_text(recording_text(made, arm))
    (tmp_path / "s.yaml").write_text(settings_text(made))
    again = read_recording(tmp_path / "s.csv", arm)

    assert np.abs(made.q).max() <= RANGE
    assert again.instrument.kinds == (kind,)
    assert again.tip == pytest.approx(made.tip, abs=1e-8)
    tip = placed(made.q)[0]
    read = {2: tip[:, 2], ALONG: tip @ [0.0, 0.6, 0.8], DISTANCE: np.linalg.norm(tip - [0.2, 1.1, 0.4], axis=1)}
    assert made.tip[:, 0] == pytest.approx(read[slots[0]], abs=1e-12)


def _levelled(**changed):
    """What a level on link 2 of the arm in the plane reads, in deg, by the sum of two angles, 90 deg askew."""
    tilts = np.degrees(Q[:, 0] + Q[:, 1]) - 90.0
    return _only(**({"tilt_x_deg": tilts} | changed))


_ON_LINK = "observes: tilt\ntilt_link: 2\nsigma: 20 urad"


def test_a_level_is_read_as_what_it_rises_by(tmp_path):
    recording = _read(tmp_path, _ON_LINK, _levelled())

    assert recording.tip[:, 0] == pytest.approx(-np.cos(Q[:, 0] + Q[:, 1]), abs=2e-8)
    assert recording.sigma == pytest.approx(20e-6)
    assert recording.instrument.tilt_link == 2
    again = written_again(tmp_path, recording)
    assert again.tip == pytest.approx(recording.tip, abs=2e-8)
    assert _read(tmp_path, _ON_LINK.replace("20 urad", "15 um"), _levelled()).sigma == pytest.approx(15e-6)


def written_again(tmp_path, recording):
    (tmp_path / "again.csv").write_text(recording_text(recording, planar_arm()))
    (tmp_path / "again.yaml").write_text(settings_text(recording))
    return read_recording(tmp_path / "again.csv", planar_arm())


@pytest.mark.parametrize(
    ("settings", "columns", "words"),
    [
        ("observes: tilt", _levelled(), "tilt_link: is missing; write where the level stands: `tilt_link: base`"),
        ("observes: tilt\ntilt_link: tip", _levelled(), "tilt_link: 'tip' is no link"),
        ("observes: tilt\ntilt_link: 7", _levelled(), "tilt_link: is 7, but 'test arm' has 3 links"),
        ("tilt_link: 2", _levelled(), "goes with `observes: tilt`"),
        (_ON_LINK, _only(), "tilt_x: is missing, which `observes: tilt`"),
        (_ON_LINK.replace("2\n", "1\n"), _levelled(), "check `tilt_link: 1`, the unit in the header and signs"),
        (_ON_LINK, _levelled(tilt_x_deg=np.cos(np.arange(24.0)) * 60.0), "the middle tilt is"),
    ],
)
def test_a_level_that_cannot_be_right(tmp_path, settings, columns, words):
    with pytest.raises(InputError, match=words):
        _read(tmp_path, settings, columns)


def _bars(label, along):
    """Pairs of postures, each as the two ends of a bar of just that length."""
    apart = 1e3 * np.linalg.norm(TIP[0::2] - TIP[1::2], axis=1)
    columns = _only()
    columns["bar"] = [f"{number // 2 + 1}" for number in range(24)] if label is None else label
    ends = np.column_stack([np.zeros(12), apart]).reshape(-1) if along is None else along
    return columns | {"bar_mm": [f"{end:.7f}" for end in ends]}


def test_ends_of_bars_are_read_and_written_again(tmp_path):
    recording = _read(tmp_path, "observes: bar", _bars(None, None))

    assert recording.bar_at[:2] == pytest.approx([0.0, np.linalg.norm(TIP[0] - TIP[1])], abs=1e-8)
    assert recording.instrument.labels == tuple(sorted(str(number) for number in range(1, 13)))
    assert recording.touches[0] == recording.touches[1] != recording.touches[2]
    again = written_again(tmp_path, recording)
    assert again.bar_at == pytest.approx(recording.bar_at, abs=2e-8)
    assert (again.touches == recording.touches).all()


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        (_bars(None, np.zeros(24)), r"bar_mm: '1' is touched at 0 mm only \(rows 2 to 3\): it tells no distance"),
        ({k: v for k, v in _bars(None, None).items() if k != "bar_mm"}, "bar_mm: is missing: where along its bar"),
        (_bars(["a"] * 23 + ["b"], None), "bar: 'b' has 1 row only"),
        (
            _bars(None, np.array(_bars(None, None)["bar_mm"], dtype=float) / 1e3),
            "bar_mm: looks as if its numbers were 1000 times larger",
        ),
    ],
)
def test_bars_that_tell_nothing(tmp_path, columns, words):
    with pytest.raises(InputError, match=words):
        _read(tmp_path, "observes: bar", columns)


@pytest.mark.parametrize("settings", ["frame: known", "observes: position", "observes: along\ndirection: [0, 1, 0]"])
def test_a_log_of_torques_alone_is_told_what_it_lacks_whatever_it_is_called(tmp_path, settings):
    """Nobody is sent to `observes:` for it and back."""
    torques = {f"tau{joint}_Nm": np.linspace(1.0, 5.0, 24) for joint in (1, 2, 3)}
    with pytest.raises(InputError, match="tau1_Nm: has drives' torques and nothing of the tip") as caught:
        _read(tmp_path, settings, _only(**torques))
    assert "observes" not in str(caught.value)


def test_what_was_measured_is_asked_for_where_no_coordinate_is_there(tmp_path):
    with pytest.raises(InputError, match=r"x: is missing \(and y\).*`observes: along` \(distance, tilt, ...\)"):
        _read(tmp_path, "frame: known", _only())
    with pytest.raises(InputError, match=r"y: is missing.*`observes: position` in recording.yaml if it was"):
        _read(tmp_path, "frame: known", _only("x_mm"))

"""The second generator proved: its engine against first principles, its classes and halves, its causes, its scoring."""

# ruff: noqa: ARG005

import json
import math
from dataclasses import replace

import mujoco
import numpy as np
import pandas as pd
import pytest
import yaml

from benchmarks.blind.answers import Answer, load
from benchmarks.blind.generator.arms import draw_arm as first_arm
from benchmarks.blind.generator.beams import circle
from benchmarks.blind.generator.mechanics import Arm, Joint, Link, nominal_inputs, solve
from benchmarks.multibody.arms import draw_arm
from benchmarks.multibody.cases import kind_of, make_case
from benchmarks.multibody.causes import KINDS, Cause, Stage, draw_cause, possible
from benchmarks.multibody.commands import main
from benchmarks.multibody.doses import basis, change, geometry_columns, library_spans, sized
from benchmarks.multibody.engine import NotSettledError, jacobians, loads, machine, place, settle
from benchmarks.multibody.files import table_of, truth_of, write_case
from benchmarks.multibody.instrument import MISLABELLED, STILL, draw_mount, oracle_rms
from benchmarks.multibody.page import HEADING, section, trials, write_section
from benchmarks.multibody.score import score
from benchmarks.multibody.session import Plan, draw_session, played
from benchmarks.multibody.sizes import impossible
from benchmarks.multibody.unknowns.split import CLASSES, DEVELOPMENT, PROOF, WITHDRAWN, classes_of, drawn_split
from tests.benchmarks.judged import no_templates, nothing_judged

pytestmark = pytest.mark.slow


def test_generator_imports_nothing_that_is_judged():
    """Only the runner, which asks by the command line, touches the tool."""
    nothing_judged("multibody", asks={"run.py"})


# The engine


def bar(*, weight=0.0, length=1.0, nodes=5, drive=0.0, force=(0.0, 0.0, 0.0)):
    """A clamped bar of 20 mm under `force`, bending alone; its rest and EI."""
    section, modulus = circle(0.02, 0.3), 2e11
    link = Link(length, (1, 0, 0), weight, section, modulus)
    body = machine(Arm("bar", "bar", (Joint(False, (0, 0, 1), drive),), (link,), (0, -1, 0), 0.0, True), nodes)
    give = body.compliance.copy()
    for node in body.nodes[0]:
        give[list(node[:3])] = 0.0
    return settle(body, np.zeros(body.size), give, np.array(force)), modulus * section.inertia_in_plane, body


def test_cantilever_in_the_limit_of_small_loads():
    """F L^3/3EI and w L^4/8EI (Gere & Goodno), with the nodes that every case has."""
    rest, bending, _ = bar(force=(0.0, -1e-3, 0.0))
    assert rest.tip[1] == pytest.approx(-1e-3 / (3 * bending), rel=1e-7)
    rest, bending, _ = bar(weight=1e-3)
    assert rest.tip[1] == pytest.approx(-1e-3 / (8 * bending), rel=1e-7)
    rest, bending, body = bar(force=(0.0, -1e-3, 0.0), drive=1e-3)
    assert rest.coordinates[body.drive[0]] == pytest.approx(-1e-6, rel=1e-5)
    assert rest.tip[1] == pytest.approx(-1e-3 / (3 * bending) - 1e-6, rel=1e-5)


# Bisshopp & Drucker, Quart. Appl. Math. 3 (1945) 272, doi:10.1090/qam/13360; to five digits as tabulated by
# K. Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, Table I: P L^2/EI, deflection along and across, over L.
@pytest.mark.parametrize(("load", "along", "across"), [(1.0, 0.05643, 0.30172), (2.0, 0.16064, 0.49346)])
def test_elastica_is_approached_with_the_square_of_the_nodes(load, along, across):
    _, bending, _ = bar()
    off = []
    for nodes in (5, 10, 20):
        rest, _, _ = bar(force=(0.0, -load * bending, 0.0), nodes=nodes)
        assert 1.0 - rest.tip[0] == pytest.approx(along, rel=0.2 / nodes)
        off.append(-rest.tip[1] - across)
    assert abs(off[0]) < 0.005 * across  # with what every case has, thirty times beyond what any case bends by
    assert off[0] / off[1] == pytest.approx(4.0, abs=1.2)
    assert abs(off[2]) < 3e-4 * across


@pytest.mark.parametrize("family", ["planar_3r", "spatial_6r"])
def test_it_agrees_with_the_first_generator_to_nanometres(family):
    """Two discretisations of one physics: collocated rods there, bodies on springs here; sags of tenths of a mm."""
    rng = np.random.default_rng(3)
    arm, ranges = first_arm(family, "drives", rng)
    q = rng.uniform(np.array(ranges.low)[:, None], np.array(ranges.high)[:, None], (arm.count, 8))
    there = solve(arm, nominal_inputs(arm, q, np.full(8, 10.0), np.zeros((3, 8))), 6)
    body = machine(arm)
    for k in range(8):
        angles = np.zeros(body.size)
        angles[list(body.drive)] = q[:, k]
        rest = settle(body, angles, body.compliance, 10.0 * np.array(arm.gravity))
        assert rest.tip == pytest.approx(there.tip[:, k], abs=1e-8)
        assert rest.load[list(body.drive)] == pytest.approx(there.torque[:, k], abs=1e-4)


def test_rest_is_where_the_engine_itself_comes_to_rest():
    """The same arm let go with damping: MuJoCo's own springs and its own integrator end at the same place."""
    arm = Arm(
        "arm", "arm", (Joint(False, (0, 0, 1), 1e-3),) * 2, (Link(0.4, (1, 0, 0), 3.0),) * 2, (0, -9.81, 0), 0.0, True
    )
    body = machine(arm)
    angles = np.zeros(body.size)
    angles[list(body.drive)] = (0.3, -0.8)
    rest = settle(body, angles, body.compliance, np.zeros(3))
    model, data = body.model, body.data
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.timestep = 2e-3
    # what is to stand still is heavy, stiff and damped to its limit
    model.dof_armature[:], model.dof_damping[:], model.jnt_stiffness[:] = 1e6, 6e7, 1e9
    model.dof_armature[list(body.drive)], model.dof_damping[list(body.drive)] = 0.0, 20.0
    model.jnt_stiffness[list(body.drive)] = 1e3
    model.qpos_spring[:] = angles
    data.qpos[:], data.qvel[:] = angles, 0.0
    for _ in range(600):
        mujoco.mj_step(model, data)
    assert data.qpos[list(body.drive)] == pytest.approx(rest.coordinates[list(body.drive)], abs=1e-6)
    assert np.abs(rest.coordinates - angles).max() > 1e-3


def test_loads_are_the_derivative_of_the_work():
    """Virtual work on the seven axes: dW/dx = load for weight and a force at the tip, on every drive and slide."""
    arm, _ = draw_arm("seven_axes", np.random.default_rng(2))
    body = machine(arm)
    at, push = np.zeros(body.size), np.array([3.0, -5.0, 7.0])
    at[list(body.drive)] = np.linspace(-0.7, 0.9, arm.count)

    def work(x):
        place(body, x)
        weight = sum(m * p @ np.array(arm.gravity) for m, p in zip(body.model.body_mass, body.data.xipos, strict=True))
        return float(weight + push @ body.data.site_xpos[body.site("tip")])

    place(body, at)
    result = loads(body, push)
    for k in [*body.drive, *body.stretch, *body.seat[2], *body.tilt[3], *body.base, *body.tool]:
        step = np.zeros(body.size)
        step[k] = 1e-6
        assert result[k] == pytest.approx((work(at + step) - work(at - step)) / 2e-6, abs=1e-5)


def test_what_cannot_carry_its_load_is_said():
    with pytest.raises(NotSettledError, match="still moving"):
        bar(force=(-1e5, -1e4, 0.0))


# Causes and unknowns


def stage_of(family: str, design: str, seed: int = 1, mounts: int = 1) -> tuple[Stage, object]:
    rng = np.random.default_rng(seed)
    arm, ranges = draw_arm(family, rng)
    body, session = machine(arm), draw_session(design, arm, ranges, mounts, rng)
    return Stage(body, session, played(Plan(body, session))), ranges


@pytest.fixture(scope="module")
def planar():
    return stage_of("drives_3r", "full")[0]


def by_hand(stage: Stage):
    """Angles, directions and J_i = z x (p - o_i) of a stiff planar arm."""
    q = stage.session.q
    phi = np.cumsum(q, axis=0)
    along = [np.stack([np.cos(p), np.sin(p)]) for p in phi]
    ends = np.cumsum([k.length * u for k, u in zip(stage.machine.arm.links, along, strict=True)], axis=0)
    starts = [np.zeros_like(ends[0]), *ends[:-1]]
    return q, along, [np.stack([-(ends[-1] - s)[1], (ends[-1] - s)[0]]) for s in starts]


@pytest.mark.parametrize(
    ("effect", "at", "values", "expected"),
    [
        ("encoder_offset", 2, {"offset": 1e-5}, lambda s, q, u, j: 1e-5 * j[1]),
        ("encoder_scale", 3, {"scale": 1e-5}, lambda s, q, u, j: 1e-5 * q[2] * j[2]),
        ("joint_coupling", 3, {"coupling": 1e-5}, lambda s, q, u, j: 1e-5 * q[1] * j[2]),
        ("gear_transmission_error", 1, {"sine": 1e-5, "cosine": 2e-5, "order": 3.0},
         lambda s, q, u, j: (1e-5 * np.sin(3 * q[0]) + 2e-5 * np.cos(3 * q[0])) * j[0]),
        ("link_length", 2, {"length": 1e-5}, lambda s, q, u, j: 1e-5 * u[1]),
        ("tool_offset", 0, {"along": 1e-5, "across": 2e-5},
         lambda s, q, u, j: 1e-5 * u[2] + 2e-5 * np.stack([-u[2][1], u[2][0]])),
        ("joint_compliance", 2, {"compliance": 1e-7}, lambda s, q, u, j: 1e-7 * s.torque[1] * j[1]),
        ("friction_windup", 2, {"windup": 1e-5, "windup_per_load": 1e-7},
         lambda s, q, u, j: -s.session.side[1] * (1e-5 + 1e-7 * np.abs(s.torque[1])) * j[1]),
        ("backlash", 2, {"total": 2e-5, "held_below": 0.0}, lambda s, q, u, j: 1e-5 * np.sign(s.torque[1]) * j[1]),
        ("backlash", 3, {"total": 2e-5, "held_below": 1e9}, lambda s, q, u, j: -1e-5 * s.session.side[2] * j[2]),
        ("gearbox_thermal", 1, {"per_kelvin": 1e-6, "lag": 0.0},
         lambda s, q, u, j: 1e-6 * (s.session.temperature - 20.0) * j[0]),
        ("thermal_expansion", 2, {"expansion": 1e-5, "lag": 0.0},
         lambda s, q, u, j: 1e-5 * s.machine.arm.links[1].length * (s.session.temperature - 20.0) * u[1]),
    ],
)  # fmt: skip
def test_causes_have_the_signs_and_sizes_of_the_field(planar, effect, at, values, expected):
    """First-order patterns by plain trigonometry, to what a sag of two millimetres leaves of them."""
    cause = Cause(effect, (at,) if at else (), values, ())
    moved = change(planar, cause.write)[:2]
    wanted = expected(planar, *by_hand(planar))
    assert np.abs(moved - wanted).max() < 0.02 * np.abs(wanted).max()


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("payload", {"mass": 0.5}),
        ("link_mass", {"mass": 0.5}),
        ("base_tilt", {"about_z": 5e-3}),
        ("link_modulus", {"excess": -0.1}),
    ],
)
def test_loads_move_the_tip_as_a_file_with_them_would(planar, effect, values):
    """Each against the arm built with it: its file's payload, weight, gravity or modulus."""
    arm, session = planar.machine.arm, planar.session
    moved = change(planar, Cause(effect, (2,) if effect.startswith("link") else (), values, ()).write)
    links = list(arm.links)
    if effect == "payload":
        session = replace(session, payload=session.payload + 0.5)
    elif effect == "link_mass":
        links[1] = replace(links[1], line_mass=links[1].line_mass + 0.5 / links[1].length)
    elif effect == "link_modulus":
        links[1] = replace(links[1], elastic_modulus=links[1].elastic_modulus * 0.9)
    else:
        arm = replace(arm, gravity=(-9.81 * 5e-3, -9.81, 0.0))
    body = machine(replace(arm, links=tuple(links)))
    there = played(Plan(body, session)).reading - planar.tips.reading
    assert np.abs(moved).max() > 1e-5
    assert moved == pytest.approx(there, abs=2e-9)


def test_every_cause_can_be_drawn_and_moves_the_tip():
    rng = np.random.default_rng(5)
    left = set(KINDS)
    for family, design in (("drives_3r", "full"), ("spatial_3r", "payloads")):
        stage, _ = stage_of(family, design)
        for effect in [name for name in sorted(left) if possible(name, stage)]:
            cause = draw_cause(effect, stage, rng)
            once, twice = change(stage, cause.write), change(stage, cause.dosed(2.0).write)
            assert np.abs(once).max() > 1e-7, effect
            if effect not in ("clearance", "backlash"):  # near no load these decide anew
                assert np.abs(twice).max() > 1.5 * np.abs(once).max(), effect
            left.discard(effect)
    assert not left


def test_unknown_classes_are_split_by_class_as_recorded():
    names = [item.name for item in CLASSES]
    assert len(set(names)) == len(names) >= 24
    assert drawn_split() == (DEVELOPMENT, PROOF)
    assert not set(DEVELOPMENT) & set(PROOF)
    drawn = [class_.name for class_ in (*classes_of("development"), *classes_of("proof"))]
    assert sorted((*drawn, *WITHDRAWN)) == sorted(names)


@pytest.mark.parametrize("family", ["spatial_3r", "spatial_6r", "seven_axes"])
@pytest.mark.parametrize("seed", [1, 2])
def test_what_is_withdrawn_is_the_next_axis_askew_and_aside(family, seed):
    """A tilt that turns with its axis stays with the link behind it; one that turns twice as fast does not."""
    stage, _ = stage_of(family, "full", seed=seed)
    body, rng = stage.machine, np.random.default_rng(seed)
    withdrawn = next(item for item in CLASSES if item.name in WITHDRAWN).draw(stage, rng)
    (joint,) = withdrawn.joints
    moved = change(stage, lambda plan: withdrawn.act(plan, 1.0)).reshape(-1)
    columns = [*body.tilt[joint], *body.seat[joint]]  # of the joint after it, counted from nought
    askew = np.stack([rest.jacobian[:, columns] for rest in stage.tips.rests], axis=1).reshape(-1, len(columns))
    left = moved - askew @ np.linalg.lstsq(askew, moved, rcond=None)[0]
    assert np.linalg.norm(left) < 2e-3 * np.linalg.norm(moved)
    spans, geometry = library_spans(stage), basis(geometry_columns(stage))
    assert sized(withdrawn, stage, 3e-5, spans, geometry) is None


def test_no_unknown_class_has_a_template_in_what_is_judged():
    """Neither an effect of the library nor a form of the tool bears the name of a class of the proof half, and no file
    that is judged speaks of one."""
    no_templates(PROOF)


@pytest.mark.parametrize("each", CLASSES, ids=lambda item: item.name)
def test_every_unknown_class_acts(each):
    """At twice the size it moves the tip farther, and it says where it sits."""
    stage, _ = stage_of("spatial_6r" if "wrist" in each.needs else "spatial_3r", "full", seed=4)
    rng = np.random.default_rng(6)
    unknown = each.draw(stage, rng)
    once = change(stage, lambda plan: unknown.act(plan, 1.0))
    twice = change(stage, lambda plan: unknown.act(plan, 2.0))
    assert np.abs(once).max() > 1e-6
    assert np.abs(twice).max() > 1.3 * np.abs(once).max()
    assert unknown.depends_on
    assert all(1 <= i <= 6 for i in unknown.joints)
    assert unknown.since is None or 0.0 <= unknown.since < unknown.until <= stage.session.time[-1]


# The instrument, cases, files


def test_oracle_fits_frame_and_target_and_nothing_else():
    """White noise keeps its size but for what six (nine) fitted numbers take; a frame that is known keeps all."""
    rng = np.random.default_rng(0)
    true = rng.uniform(-1.0, 1.0, (3, 400))
    noise = 1e-5 * rng.standard_normal(true.shape)
    turns = np.stack([draw_mount(False, rng).turn for _ in range(400)], axis=2)
    shifted = noise + np.array([[1e-3], [0.0], [2e-3]]) + 1e-3 * np.stack([-true[1], true[0], np.zeros(400)])
    shifted += np.einsum("abk,b->ak", turns, np.array([1e-3, 0.0, 0.0]))
    mounts = np.zeros(400)
    size = 1e-5 * math.sqrt(3.0)
    assert oracle_rms(true, true + noise, mounts, frame_free=False, tool_turns=None) == pytest.approx(size, rel=0.05)
    assert oracle_rms(true, true + shifted, mounts, frame_free=True, tool_turns=turns) == pytest.approx(size, rel=0.05)
    assert oracle_rms(true, true + shifted, mounts, frame_free=True, tool_turns=None) > 5 * size


def test_a_mount_is_a_rigid_motion_and_of_the_plane_in_the_plane():
    rng = np.random.default_rng(3)
    for planar in (True, False):
        mount = draw_mount(planar, rng)
        assert mount.turn @ mount.turn.T == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(mount.turn) == pytest.approx(1.0)
        assert bool(mount.turn[2, 2] == 1.0 and mount.shift[2] == 0.0) == planar
    assert STILL.turn == pytest.approx(np.eye(3))


def test_kinds_come_in_their_shares():
    kinds = [kind_of(index) for index in range(600)]
    count = {kind: sum(1 for k, _ in kinds if k == kind) for kind in {k for k, _ in kinds}}
    assert count == {"null": 150, "many": 150, "power": 120, "unknown": 90, "pair": 60, "mislabelled": 30}
    for kind, number in count.items():
        assert sorted(n for k, n in kinds if k == kind) == list(range(number))


@pytest.mark.parametrize("wrong", list(MISLABELLED))
def test_mislabelled_columns_differ_from_the_true_ones(wrong):
    case = make_case("x", (11, 0, 14), "development", "mislabelled", list(MISLABELLED).index(wrong))
    table = table_of(case)
    other = MISLABELLED[case.wrong.mislabelled[0]](table, case.wrong.mislabelled[1])
    assert case.wrong.mislabelled[0] == wrong
    assert set(other.columns) == set(table.columns)
    assert not other[list(table.columns)].equals(table)


def test_a_case_is_the_same_from_its_seed_and_tells_the_tool_nothing(tmp_path):
    """Files to the last byte; every mounting has its recording, and the truth stands apart."""
    texts = []
    for folder in ("one", "two"):
        case = make_case("00001", (5, 0, 1), "development", "many", 0)
        texts.append(write_case(case, tmp_path / folder))
    assert texts[0] == texts[1]
    truth = json.loads(texts[0])
    assert 5 <= len(truth["effects"]) <= 10
    assert 1 <= sum(e["large"] for e in truth["effects"]) <= 2
    assert all(e["snr"] < 1.01 for e in truth["effects"] if not e["large"])
    files = sorted((tmp_path / "one" / "cases" / "00001").iterdir())
    for path in files:
        assert path.read_bytes() == (tmp_path / "two" / "cases" / "00001" / path.name).read_bytes()
        assert "multibody" not in path.read_text(encoding="utf-8")
    tables = [pd.read_csv(path) for path in files if path.suffix == ".csv"]
    assert sum(len(table) for table in tables) == truth["rows"]
    assert len(tables) == truth["mounts"]
    settings = [
        yaml.safe_load(p.read_text(encoding="utf-8"))
        for p in files
        if p.name.startswith("recording") and p.suffix == ".yaml"
    ]
    assert all(item["frame"] == truth["frame"] for item in settings)
    assert len(settings) == len(tables)


# The score


def said(case, verdict, *entries, where=None, **more):
    results = {"verdict": verdict, "missing": list(entries), "where": where or {}, **more}
    return Answer(case, 0, 1.0, results)


def entry(effect, at, parameters=None, alternatives=()):
    return {"effect": effect, "at": at, "parameters": parameters or {}, "alternatives": list(alternatives)}


def truth(case, kind, *effects, unknown=None, **more):
    about = {
        "arm": "seven_axes",
        "design": "full",
        "rows": 100,
        "frame": "free",
        "tool": "known",
        "mounts": 1,
        "seed": [3, 0],
        "duration_s": 9e3,
    }
    file = {
        "link_mass_kg": [3.0, 2.0],
        "payload_kg": 1.0,
        "drive_compliance": [1e-6, 1e-6],
        "link_length_m": [1.0, 1.0],
    }
    rest = {"vice": "plain", "dose": 0.5, "oracle_rms_mm": 0.02, "mislabelled": None, "file": file}
    return {"case": case, "kind": kind, "effects": list(effects), "unknown": unknown, **about, **rest, **more}


def true(effect, at, snr=3.0, large=True, **parameters):
    values = {k: {"value": v, "unit": u} for k, (v, u) in parameters.items()}
    return {"effect": effect, "at": at, "snr": snr, "large": large, "parameters": values}


def test_scores_by_hand():
    """Six cases, every figure counted on the fingers."""
    there = {"class": "wind", "joints": [2], "depends_on": ["position", "q2"], "since_s": 5000.0, "until_s": None}
    compliance = {"compliance_2": {"value": 1.1e-6, "unit": "rad/(N*m)", "ci95": [0.9e-6, 1.3e-6]}}
    truths = [
        truth("a", "null"),
        truth("b", "null", vice="wander"),
        truth(
            "c",
            "many",
            true("joint_compliance", [2], compliance_2=(1e-6, "rad/(N*m)")),
            true("payload", [], 0.3, False),
        ),
        truth("d", "pair", true("backlash", [1]), true("friction_windup", [1])),
        truth("e", "unknown", unknown=there),
        truth("f", "unknown", unknown=there | {"joints": [1]}),
        truth("g", "mislabelled", mislabelled="grams under kilograms"),
    ]
    answers = {
        "a": said("a", "none"),
        "b": said("b", "named", entry("frame_drift", [])),
        "c": said(
            "c", "named", entry("joint_compliance", [2], compliance), entry("payload", []), written_arm_rms_mm=0.021
        ),
        "d": said(
            "d",
            "alias_class",
            entry("backlash", [1], {"total_1": {"value": -1.0, "unit": "mrad"}}, [["friction_windup", [1]]]),
        ),
        "e": said("e", "unknown", where={"joint": 2, "since_s": 5100.0, "depends_on": ["q2", "time"]}),
        "f": said("f", "named", entry("encoder_offset", [2])),
        "g": Answer("g", 2, 0.1, None),
    }
    result = score(truths, answers, "disclosed", "abc")
    reached = {t.what: t.reached for t in result.targets}

    def share(what):
        return reached[what].count, reached[what].total

    assert share("false alarms on nulls") == (1, 2)
    assert share("large causes named, from 0.9 on") == (3, 3)
    assert share("of those the cause's own name comes first") == (2, 3)
    assert share("names that are of no cause") == (2, 5)
    assert share("unknown classes called unknown") == (1, 2)
    assert share("unknown classes given a name") == (1, 2)
    assert share("answers with an impossible size") == (1, 4)
    assert share("95 % intervals that hold the truth") == (1, 1)
    assert share("mislabelled columns given a cause's name") == (0, 1)
    assert reached["written file's RMS over the oracle's"].median == pytest.approx(1.05)
    assert [t.met for t in result.targets] == [False, True, False, False, False, False, False, True, False, True]
    assert result.bias.median == pytest.approx(0.1)
    assert (result.false_discoveries.count, result.false_discoveries.total) == (2, 5)
    where = dict(result.localised)
    # b points nowhere; c at 2; d at 1; e at 2; f at 2 where it is 1
    assert (where["joint"].hits, where["joint"].claimed, where["joint"].true) == (3, 4, 4)
    assert (where["time"].hits, where["time"].claimed, where["time"].true) == (1, 1, 2)
    assert (where["region"].hits, where["region"].claimed, where["region"].true) == (1, 2, 4)
    assert where["joint"].f1 == pytest.approx(6 / 8)
    assert [line[0] for line in result.misses] == ["b", "f"]
    assert not result.failed
    assert dict(result.tables)["of these, said to be of time, where the tracker wanders"][0][1].count == 1
    assert "cannot be negative" in result.impossible[0]
    text = section(result)
    assert text.startswith(HEADING)
    assert "7 cases of the development half**, seed 3 (" in text
    assert "None of them has two mountings" in text
    assert "mislabelled: refused 1" in text
    assert "by effect" not in text
    assert "**MISSED** 50.0 % (1/2" in text


def test_what_a_size_is_said_to_hold_is_no_name_and_has_a_table_of_its_own():
    truths = [truth("a", "pair", true("backlash", [1]), true("friction_windup", [1]))]
    truths += [truth("b", "pair", true("backlash", [2]), true("friction_windup", [1]))]
    windup = {"windup_1": {"value": 0.2, "unit": "mrad", "may_hold": "backlash"}}
    per_load = {"windup_per_load_1": {"value": 5e-6, "unit": "rad/(N*m)", "may_hold": None}}
    answers = {case: said(case, "named", entry("friction_windup", [1], windup | per_load)) for case in "ab"}
    result = score(truths, answers, "disclosed")
    named = next(t.reached for t in result.targets if t.what == "large causes named, from 0.9 on")
    held = dict(result.tables)["large causes named, or said to be in a size of what is named"][0][1]
    assert (named.count, named.total) == (2, 4)
    assert (held.count, held.total) == (3, 4)  # b's is of another joint


def test_impossible_sizes_are_those_that_no_machine_has():
    file = truth("a", "null")["file"]

    def why(effect, at, name, value, unit):
        return bool(impossible(entry(effect, at, {name: {"value": value, "unit": unit}}), file))

    assert why("joint_compliance", [1], "compliance_1", -2e-6, "rad/(N*m)")
    assert not why("joint_compliance", [1], "compliance_1", -5e-7, "rad/(N*m)")  # softer in the file than in truth
    assert why("payload", [], "mass", -3.5, "kg")
    assert not why("payload", [], "mass", -2.5, "kg")
    assert why("link_mass", [1], "mass_1", -3.0, "kg")
    assert not why("link_mass", [1], "mass_1", -2.9, "kg")
    assert why("link_modulus", [1], "excess_1", -0.95, "1")
    assert not why("link_modulus", [1], "excess_1", 0.5, "1")
    assert why("instrument_scale", [], "scale", 0.02, "1")
    assert not why("encoder_offset", [1], "offset_1", 3.0, "mrad")
    assert why("link_mass", [1], "mass_1", 11.5, "kg")  # 2 * 3 kg and 5 kg of cables
    assert not why("link_mass", [1], "mass_1", 10.5, "kg")
    everywhere = {"mass": {"value": -2.5, "unit": "kg", "at": [1, 2]}}
    assert len(impossible(entry("link_mass", [1, 2], everywhere), file)) == 1  # too much for the second alone


def test_the_page_tells_which_class_of_the_proof_half_has_a_form():
    there = {"class": "bumper", "joints": [2], "depends_on": ["q2"], "since_s": None, "until_s": None}
    truths = [
        truth("a", "unknown", unknown=there),
        truth("b", "unknown", unknown=there | {"class": "gas_spring"}),
        truth("c", "unknown", unknown=there | {"class": "product_of_joints"}),
    ]
    answers = {"a": said("a", "unknown"), "b": said("b", "none"), "c": said("c", "unknown")}
    words = " ".join(section(score(truths, answers, "sealed")).split())
    assert "`product_of_joints`, is no proof any more" in words
    assert "Of the other 2 classes 1 of 2 cases are called unknown; given a name: 0" in words
    assert "no proof any more" not in section(score(truths, answers, "disclosed"))


def test_the_page_of_a_later_trial_tells_of_those_before():
    truths = [truth("a", "null"), truth("b", "null")]
    answers = {item["case"]: said(item["case"], "none") for item in truths}
    names = ("| first |", "| second |", "| third |", "| fourth |", "| fifth |", "| sixth |")
    _, opened = trials()
    last = min(opened) + 1  # whatever its number, it is opened after those
    assert last not in opened
    for index, seed in enumerate([*opened, last]):
        page = section(score([item | {"seed": [seed, 0]} for item in truths], answers, "sealed"))
        assert [name for name in names if name in page] == list(names[:index])
        assert ("Earlier trials, each a new draw" in page) is bool(index)
    later = [item | {"seed": [last, 0]} for item in truths]
    assert "| first |" not in section(score(later, answers, "disclosed"))


def test_the_page_keeps_its_other_parts_and_the_section_is_replaced(tmp_path):
    page = tmp_path / "proof.md"
    page.write_text("# The proof\n\nWords.\n", encoding="utf-8")
    first = score([truth("a", "null")], {"a": said("a", "none")}, "disclosed")
    second = score([truth("a", "null")], {"a": said("a", "unknown")}, "disclosed")
    write_section(page, first)
    write_section(page, second)
    text = page.read_text(encoding="utf-8")
    assert text.startswith("# The proof\n\nWords.\n\n" + HEADING)
    assert text.count(HEADING) == 1
    assert text.endswith(section(second))
    assert section(first) != section(second)


def test_made_asked_and_scored_by_the_commands(tmp_path, capsys):
    """A case through all three commands: sound arm, nothing said, the section written; what is sealed stays."""
    cases, answers, page = tmp_path / "cases", tmp_path / "answers", tmp_path / "proof.md"
    making = ["make", "--cases", "1", "--seed", "7", "--half", "development", "--out", str(cases), "--jobs", "1"]
    assert main(making) == 0
    assert main(making) == 2
    assert "is sealed already" in capsys.readouterr().err
    assert main(["score", str(cases), "--answers", str(answers)]) == 2
    assert main(["run", str(cases), "--answers", str(answers), "--jobs", "1"]) == 0
    assert (
        main(["score", str(cases), "--answers", str(answers), "--page", str(page), "--json", str(tmp_path / "s.json")])
        == 0
    )
    truths, given, half, _ = load(cases, answers)
    assert (half, truths[0]["kind"], given["00000"].verdict) == ("disclosed", "null", "none")
    assert "1 cases of the development half" in page.read_text(encoding="utf-8")
    assert json.loads((tmp_path / "s.json").read_text(encoding="utf-8"))["failed"] == []


def test_a_truth_names_every_size_with_a_unit():
    """Every parameter of every cause as an arm file has it: what has no unit is a number, a phase or an order."""
    for number in range(3):
        result = truth_of(make_case("x", (9, 0, number), "development", "many", number))
        for effect in result["effects"]:
            for name, value in effect["parameters"].items():
                plain = name.rstrip("0123456789").rstrip("_")
                assert value["unit"] or plain in {"scale", "coupling", "excess", "order"}, name


def test_jacobians_are_differences():
    arm, _ = draw_arm("spatial_6r", np.random.default_rng(1))
    body = machine(arm)
    at = np.zeros(body.size)
    at[list(body.drive)] = 0.3
    place(body, at)
    moves, _ = jacobians(body, body.site("tip"))
    for k in (*body.drive, *body.tool, *body.nodes[1][2]):
        step = np.zeros(body.size)
        step[k] = 1e-6
        place(body, at + step)
        ahead = body.data.site_xpos[body.site("tip")].copy()
        place(body, at - step)
        assert moves[:, k] == pytest.approx((ahead - body.data.site_xpos[body.site("tip")]) / 2e-6, abs=1e-8)

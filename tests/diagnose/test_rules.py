"""The rules of the diagnosis: each says what it is, nothing goes by without them, none jumps with one more reading."""

import ast
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, replace
from types import SimpleNamespace

import numpy as np
import pytest

from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.rules.rule import rules_in
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.diagnose.search.naming import _against_forms, margin_of_forms, worth_of_one_more
from linkwright.core.diagnose.search.subsets import Subset
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.core_cases import made_arm, recorded, with_effects
from tests.test_house import CORE

DIAGNOSE = CORE / "diagnose"

# Numbers at the top of a module that are no rules: mathematics, units, rounding, iterations, draws, beginnings, lengths
# of texts, and what floats can hold the powers of.
NO_RULES = {
    "answer/detectable.py": {"POWER"},
    "answer/gaussian_process.py": {"_MOST", "_STEPS"},
    "answer/guard/lack_of_fit.py": {"_DRAWS", "_ONE_SIDED"},
    "answer/guard/scatter.py": {"_AT_ONCE", "_DRAWS"},
    "answer/iso_figures.py": {"LEAST_VISITS", "_LEAST", "_LONGER"},  # whether a figure is shown
    "answer/locate.py": {"_DRAWS"},
    "answer/next_poses.py": {"_TRIED, _TAKEN"},  # how many are tried, and told
    "answer/sentences.py": {"_MANY_PARAMETERS", "MANY_FINDINGS"},
    "answer/unknown.py": {"_FORMS, _NEAR"},  # how many are told
    "compare/places.py": {"_CELLS"},  # of a table
    "fitting/identified_origins.py": {"NEAR", "_TOLD"},
    "fitting/geometry.py": {"_REWEIGHTED", "_STEPS"},
    "fitting/held_out.py": {"_FOLDS", "_MOST_PARTS", "_TOLD"},
    "fitting/origins.py": {
        "_FOUND",
        "_HALVINGS",
        "_LONGEST_TURN",
        "_MOST_STARTS",
        "_READINGS",
        "_SETTLED",
        "_STEPS",
        "_TOLD",
        "_TUKEY",
    },
    "first_look/library.py": {"_QUARTER", "_SIDES", "_SIGNS"},
    "first_look/log.py": {"_DEGREE", "_FINER", "_NEXT"},
    "first_look/weights.py": {"_TOLD"},
    "first_look/recording.py": {"_LATE"},
    "first_look/search.py": {"_SIZED, _ALIKE"},  # how far a search looks, here and below
    "first_look/tips.py": {
        "_ALIKE",
        "_BEAM",
        "_DEEP",
        "_FINER",
        "_LIKELY",
        "_MOST_RATIO, _MOST_SAG",
        "_POSES",
        "_SETTLES, _ROUNDS",
        "_STEPS, _ZOOM_STEPS, _ZOOMS, _FAMILIES",
        "_TOGETHER",
    },
    "first_look/torques.py": {"_BEST, _SAMPLES", "_ROUNDS, _AT_ONCE", "_LEAST"},
    "first_look/units.py": {"_LENGTHS", "_MILLIONS", "_LENGTH_SIZES", "_ANGLE_SIZES", "IN_A_ROW"},
    "fitting/room/active_bounds.py": {"_ALIKE"},  # what rounding leaves
    "fitting/room/small_causes.py": {"_PRODUCTS", "_SEEN", "_STEPS"},  # directions that tell nothing; a search's steps
    "fitting/room/unnamed.py": {"_STEPS", "_TINY"},
    "fitting/joint/intervals.py": {"_SCAN", "_TINY"},
    "fitting/joint/shapes.py": {"_REACH", "_SWEEPS", "_TINY"},
    "fitting/joint/sizes.py": {"_NEWTON", "_ROUNDING", "_SETTLED", "_SHARES", "_TOGETHER"},
    "fitting/room/collinearity.py": {"_ALIKE"},  # of two patterns that are one, what rounding leaves
    "fitting/prepare.py": {"_PASSES, _ROUGH"},
    "fitting/relinearize.py": {"_SETTLED"},
    "fitting/shared_masses.py": {"_SETTLED", "_TURNS"},
    "fitting/terms.py": {"DIFFERENCE"},
    "fitting/loads/by_drives.py": {"CARRIED, PUSHED", "LEVEL", "_ROUNDING", "_TURNS, _SETTLED"},
    "fitting/thresholds.py": {"_ALIKE", "_AT_ONCE", "_REACH", "_LOOKED_AT", "_FURTHEST"},  # how a staircase is searched
    # what is asked of instruments
    "steps/instrument_contract.py": {"_POSES", "_EXACT", "_STEP, _LINEAR, _SMALLEST", "_UNIT"},
    "instruments/camera.py": {"_STEPS, _FOUND", "_LONGEST", "_EXACT"},
    "instruments/kinds/draw_wire.py": {"_ZERO"},  # what is simulated
    "instruments/kinds/laser_line.py": {"_GRAZING", "_NOWHERE", "_OFF, _ASKEW", "_STEPS"},
    "instruments/kinds/tilt.py": {"_ASKEW", "_BETTER", "_LONGEST", "_START_STEPS"},
    "instruments/look.py": {"SCALES"},
    "instruments/touching.py": {"_ABOUT, _AROUND", "_INNER", "_LONGEST, _MISSED", "_NEAR, _EXACT", "_POSTURES"},
    "residual/torque.py": {"_TOLD"},
    "instruments/view.py": {"_STEPS, _START_STEPS, _START_ROWS", "_BETTER", "_FOUND"},
    "judge/for_file.py": {"_USUAL"},  # the width of a prior
    "motion/causes/swinging.py": {"_POSTURES"},
    "motion/findings.py": {"_NOTHING"},  # rounding
    "motion/judged.py": {"_SETTLED", "_STEPS", "_WORSE"},
    "motion/diagnosis.py": {"_ALIKE", "_ROTORS"},  # one wave or two
    # how far and how finely delays and widths are sought
    "motion/encoders/between.py": {"_EXACT", "_LONGEST", "_NUDGE", "_STEP", "_WIDTHS"},
    "motion/encoders/serial.py": {"_LEAST"},  # keeps a division finite
    "motion/events/changed.py": {"SURE", "_PARTS", "_ROUNDS"},  # a normal distribution's; how a search goes
    "motion/events/found.py": {"_DRAWS", "_FELT", "_MOST", "_PARTS", "_ROUNDS"},
    "motion/events/placed.py": {"_AT_ONCE", "_BARELY", "_INSTANTS", "_ROUNDS", "SETTLED", "_TAIL"},
    "motion/events/push.py": {"PUSH", "_FORCE"},  # a usual size
    "motion/model/candidates.py": {"_BETWEEN", "_MOST_VARIANTS", "_PROBED"},  # what a scan is for
    "motion/model/groups.py": {"SHARPER"},
    "motion/model/steps.py": {"_ROUNDING"},
    "motion/model/chance.py": {"DRAWS"},
    # half of chi-squared; what is tried; no prior; Akaike's nat
    "motion/model/evidence.py": {"LIKELY", "SCALES", "_FREE", "_MULTIPLES", "_SPARING"},
    "motion/model/feasible.py": {
        "_ENOUGH",
        "_GAP",
        "_INSIDE",
        "_ROUNDING",
        "_SETTLED",
        "_SHORT",
        "_SHRINKS",
        "_STEPS",
        "_UNSEEN",
    },
    "motion/model/identify.py": {"_FOLDS", "_MOST_ROUNDS", "_ROUNDS", "_SETTLED"},
    "motion/model/noise.py": {"_PASSES"},
    "motion/model/ripple.py": {"DRAWS", "_EACH", "_PERIODS", "_QUICK, _SLOW"},  # parts of the low-pass
    "motion/model/search.py": {"_MOST", "_MOST_FOR_ONE", "_PROMISING"},  # how far a search looks
    "motion/preparation.py": {
        "STRETCH",
        "_ENOUGH",
        "_HELD",
        "_LET_THROUGH",
        "_MOST",
        "_PIECE",
        "_UNTOUCHED",
        "_WORKING_RATE",
    },
    "motion/reading/read.py": {"_HEAD"},
    "motion/rollout/rollout.py": {"_MOST"},
    "motion/rollout/simulator.py": {"STEP", "_LOCKED", "_ROWS", "_SAME", "_SLOWEST"},  # how it goes, and rounding
    "motion/rollout/windows.py": {"_ROUNDS"},
    "motion/sentences.py": {"_SAID"},
    "motion/simulate.py": {"_NOISE"},
    "motion/unknown.py": {"_BINS"},
    "motion/uses/expected.py": {"RATE", "_CLOCK", "_NOISE"},
    "motion/uses/plan.py": {"_HARMONICS", "_STARTS, _STEPS", "_WRITTEN"},
    "motion/uses/traces.py": {"_DRAWN"},
    "motion/uses/trajectory.py": {
        "HARMONICS",
        "_ACCELERATION",
        "_LOOKED",
        "_MARGIN",
        "_NEAREST, _ABOUT, _DRAWS",
        "_RAMP",
        "_SHRUNK, _TIMES",
        "_SPEED, _SLIDING",
    },
    "motion/weighed.py": {"_OF_DRIVE, _OF_LOAD"},
    "motion/written.py": {"_DIGITS"},
    "patterns/forces.py": {"_CORES", "_GRID", "_STARTS, _STEPS"},
    "patterns/form.py": {"BY_ANOTHER", "FORCE_IN_TIME", "IN_PART", "OF_JOINT", "PULL", "REGION"},  # shapes of forms
    "patterns/forms.py": {"_ENDS", "_MANY_VISITS", "_MOMENTS, _PERIODS, _REGIONS", "_STRETCHES, _WIDEST"},
    "patterns/library.py": {"_ALIKE", "_STEP"},
    "patterns/pool.py": {"GONE", "VISIBLE", "_AT_ONCE", "_BLOCK", "_NEARLY", "_RANK", "_TOLD"},
    "patterns/unknown_weights.py": {"_ROUNDING", "_SAG", "_SPANNED"},
    "plan/design.py": {"_CLOSEST", "_SETTLED"},
    "plan/order.py": {"_RETURNS, _BESIDE"},  # what is planned: it judges nothing
    "plan/promise.py": {"NEVER"},
    "plan/tried.py": {"_TOUCHES", "_CORNERS", "_WRITTEN_ANGLE, _WRITTEN_LENGTH"},
    "plan/written.py": {"_CLOCK"},
    "judge/predict.py": {"_HAIR"},
    "reading/columns.py": {"_SHORT"},  # how a number is written
    "reading/files.py": {"_LARGEST_PARQUET"},
    "reading/foreign/bags.py": {"_MOST"},  # of a picture
    "reading/foreign/clock.py": {"_UNITS", "_SINCE_1970", "_SHORTEST, _LONGEST"},  # sizes of units
    "columns/doubts.py": {"_MOST"},  # how often a file is read
    "reading/foreign/lerobot.py": {"_PAUSE"},
    "reading/foreign/proposal.py": {"_METRES", "_TURN"},  # sizes of units
    "reading/formula.py": {"_LONGEST, _DEEPEST"},
    "reading/named_columns.py": {"_LARGEST"},
    "reading/read.py": {"_LEVEL", "_ROUNDED", "_ROUNDED_TIP"},
    "reading/read_back.py": {"_LARGE", "_ROUNDED"},  # what decimals and floats hold
    "reading/table.py": {"_FEWEST_COLUMNS", "_LOOKED_AT", "_MOST_TITLES", "_SIDES"},
    "residual/alignment.py": {"_STEPS"},
    "residual/free_origins.py": {"_AXES"},
    "residual/noise.py": {"_FINEST"},
    "residual/visits.py": {"_STEPS, _EVEN"},
    "residual/observe.py": {"_AT_ONCE", "_TOOL_PASSES, _TOOL_FOUND"},
    "residual/orientation.py": {"_HALF_TURN"},
    "instruments/placement.py": {"UNDETERMINED", "_STEPS", "_TUKEY"},
    "residual/robust_scale.py": {"HUBER", "_MOST", "_QN", "_SMALL"},
    "residual/masses_from_torques.py": {"_ALIKE", "_NOTHING"},
    "search/calibrate.py": {"FEW_DRAWS", "_AT_ONCE", "_CHUNK", "_GONE", "_REACHED, _FAR", "_WORK"},
    "search/coupling.py": {"_ROUNDS"},
    "search/geometry.py": {"_ROUNDING"},  # of two that are one, what rounding leaves
    "search/labels.py": {"_LEVELS, _SIDES, _TAKEN, _SEARCHED"},  # how many are tried
    "search/naming.py": {"_THOROUGH_DRAWS"},
    "search/large_motions.py": {"ROUNDS"},
    "search/mass_consistency.py": {"_SEARCHES"},
    "search/exchanges.py": {"ROUNDING", "_LOOKED_AT", "_MOST"},  # how many are looked at and told
    "search/set_aside.py": {"_DRAWS"},
    "search/pairs.py": {"_AT_ONCE", "_RIDGE", "_SMALL"},  # what is multiplied by hand
    "search/subsets.py": {"_KEPT, _IN_TRIPLES", "_RIDGE"},
    "several/recordings.py": {"_PAUSE"},
    "watch/course.py": {"FEWEST", "_LOCATED", "_SWEEPS"},
    "watch/estimates.py": {"_RIDGE"},
    "watch/watch.py": {"SOON", "_POOLED"},
    "watch/evidence.py": {"TESTS", "_LEAST_SCALE", "_MEDIAN", "_NOTHING"},
    "result.py": {"HALF"},  # what "most" means in a sentence
    "plan/simulate.py": {
        "_BETWEEN_READINGS, _BETWEEN_VISITS",
        "_OUTLIERS",
        "_BASE_TARGET",
        "_DEEP, _TARGET",
        "_AWAY, _ON_TOOL",
    },
}

COUNTED = ("readings", "visits", "poses", "observations", "degrees of freedom", "pairs of readings")
"""Units of what grows with the recording."""


def sources() -> Iterator[tuple[str, str]]:
    """The diagnosis' modules but for the rules themselves, each with its text."""
    for path in sorted(DIAGNOSE.rglob("*.py")):
        name = path.relative_to(DIAGNOSE).as_posix()
        if not name.startswith("rules/"):
            yield name, path.read_text(encoding="utf-8")


def bare_numbers(source: str) -> set[str]:
    """Names at the top of a module whose value holds a number."""
    results: set[str] = set()
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign):
            targets, value = node.targets, node.value
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets, value = [node.target], node.value
        else:
            continue
        numbers = (item.value for item in ast.walk(value) if isinstance(item, ast.Constant))
        if any(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers):
            results.add(", ".join(ast.unparse(target).strip("()") for target in targets))
    return results


def test_every_threshold_is_a_rule():
    """A number that decides anything stands among the rules, with its unit, reason and source."""
    results = {name: bare for name, source in sources() if (bare := bare_numbers(source))}
    assert results == NO_RULES


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("_LEVEL = 0.05", {"_LEVEL"}),
        ("FEW: int = 3", {"FEW"}),
        ("_A, _B = 1, 2.0", {"_A, _B"}),
        ("_WAVES = MappingProxyType({2: 6})", {"_WAVES"}),
        ("NAMES = ('x', 'y')\nON = True\ndef f():\n    few = 3", set()),
    ],
)
def test_bare_numbers_are_found(source, names):
    """The check above checked."""
    assert bare_numbers(source) == names


# Numbers that a comparison inside a function may hold: rounding, and what only keeps a computation going.
NOT_DECIDED = {
    "answer/sentences.py": {0.1},  # a nuisance's share of a direction that is not told: which names are listed
    "fitting/noise_left.py": {1e-3},  # a median of nought where most readings are alike
    "first_look/rows.py": {1e-3},  # a joint's coordinate that moves at all
    "patterns/forms.py": {0.01},  # points that coincide
    "reading/read_back.py": {10.0},  # the base of decimals
    "residual/robust_scale.py": {1e11, 1e-4},  # digits of a float
}


def compared_numbers(source: str) -> set[float]:
    """Fractions in comparisons, but for nought, one, a half, two, and what is as small as rounding."""
    return {
        item.value
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Compare)
        for item in ast.walk(node)
        if isinstance(item, ast.Constant) and isinstance(item.value, float)
        if item.value not in (0.0, 1.0, 0.5, 2.0) and item.value > 1e-6
    }


def test_no_comparison_holds_a_threshold_of_its_own():
    """What a function compares with is a rule."""
    assert {name: result for name, source in sources() if (result := compared_numbers(source))} == NOT_DECIDED


def test_compared_numbers_are_found():
    """The check above checked."""
    assert compared_numbers("def f(x, y):\n    return x < 0.3 * y or x > 1e-9 or y == 1.0 or x + 0.7") == {0.3}


def takes_rules(sources: dict[str, str]) -> set[str]:
    """Functions that take `rules` and have a default for them."""
    return {
        node.name
        for source in sources.values()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef)
        for argument, default in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
        if argument.arg == "rules" and default is not None
    }


def left_to_default(sources: dict[str, str]) -> list[str]:
    """Calls of such functions that do not hand the rules on."""
    names = takes_rules(sources)
    return [
        f"{name}:{node.lineno} {called}"
        for name, source in sources.items()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Call)
        and (called := ast.unparse(node.func).rpartition(".")[2]) in names
        and all(keyword.arg != "rules" for keyword in node.keywords)
    ]


def test_rules_reach_everything_that_asks_them():
    """Within the diagnosis nobody falls back to the rules as shipped; the simulator judges nothing."""
    assert left_to_default({name: source for name, source in sources() if name != "plan/simulate.py"}) == []


def test_rules_left_to_default_are_found():
    """The check above checked."""
    module = "def qn(x, *, rules=RULES): ...\ndef f(rules):\n    return qn(1, rules=rules), robust.qn(2)\n"
    assert left_to_default({"a.py": module}) == ["a.py:3 qn"]


def test_every_rule_says_what_it_is():
    """Unit, reason and source; what counts readings says why it may change with one more."""
    rules = list(rules_in(RULES))
    assert len(rules) > 150
    assert [rule.path for rule in rules if not (rule.unit and rule.reason.endswith(".") and rule.source)] == []
    assert [rule.path for rule in rules if rule.unit in COUNTED and not rule.rows] == []


def test_rules_are_frozen():
    with pytest.raises(FrozenInstanceError):
        RULES.search.margin = 5.0  # pyright: ignore[reportAttributeAccessIssue]


def steps(value, counts):
    """The largest share by which a rule's effect changes from one count to the next."""
    values = np.array([value(count) for count in counts.tolist()])
    return float(np.max(np.abs(np.diff(values)) / values[1:]))


def test_one_more_observation_changes_next_to_nothing():
    """No jump anywhere, where there was one at 3,000."""
    assert steps(lambda count: worth_of_one_more(RULES.search, count), np.arange(500, 20_000)) < 0.005


def test_steps_are_seen():
    """The measure above checked."""
    assert steps(lambda count: 0.01 if count < 3000 else 0.004, np.arange(2990, 3010)) > 1.0


def test_the_margin_of_forms_never_turns_negative():
    """Nor does it grow with the findings."""
    margins = [margin_of_forms(RULES.search, findings) for findings in range(40)]
    assert margins == sorted(margins, reverse=True)
    assert margins[0] == RULES.search.margin
    assert min(margins) >= 0.0


@pytest.mark.parametrize("findings", [3, 4, 8])
def test_a_form_that_fits_worse_never_replaces_named_physics(findings):
    """The form's criterion is worse by five, however many findings there are."""
    form = findings
    own, of_form = -100.0, -95.0
    test = SimpleNamespace(p_value=1e-6, best=-1)
    namer = SimpleNamespace(
        library=np.array([True] * findings + [False]),
        rules=RULES.search,
        prepared=SimpleNamespace(vector=np.ones(4)),
        seek_pull=lambda _: None,
        criterion_of=lambda _: own,
        criterion=SimpleNamespace(count=50),
        best=lambda *_: {1: Subset((form,), 1.0, of_form)},
        test=lambda _: (test, test),
        test_of_forms=lambda _: test,
    )
    members = tuple(range(findings))
    assert _against_forms(namer, members, (0.001,) * findings) == (members, (), (0.001,) * findings)  # pyright: ignore[reportArgumentType]


@pytest.fixture(scope="module")
def offset():
    """An arm whose second encoder is off, and its recording."""
    arm = made_arm()
    return arm, recorded(with_effects(arm, ("encoder_offset", (2,), {"offset": 3e-4})))


def test_a_changed_rule_is_obeyed(offset):
    """For a whole diagnosis: no recording suffices that should hold more visits than it does."""
    arm, recording = offset
    more = Rules(search=replace(RULES.search, least_visits=10_000))
    assert diagnose(arm, recording, Options(rules=more)).verdict == "insufficient_data"


@pytest.mark.slow
def test_a_sterner_rule_is_obeyed(offset):
    """No finding is confirmed that held-out readings should need eleven times over."""
    arm, recording = offset
    stern = Rules(answer=replace(RULES.answer, refuted=-10.0))
    assert diagnose(arm, recording, Options(rules=stern)).findings == ()

"""Which entries of the library a recording can be asked about at all."""

import numpy as np
import pytest

from linkwright.core.diagnose.patterns.library import candidates
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.costs import slow_but
from tests.diagnose.arm_of_drives import arm_of_drives, read
from tests.diagnose.core_cases import recorded, with_effects
from tests.diagnose.made_diagnosis import made_arm

STILL = 0.3
"""rad; where a joint stands, or the middle of its travel."""


def sought(effect, travel):
    """The joints (from 1) at which an effect is sought where joint 2 travels so far (rad), the others 3 rad."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-1.5, 1.5, (60, 3))
    q[:, 1] = STILL + travel * np.linspace(-0.5, 0.5, 60)
    recording = read(q, np.zeros((60, 2)), rng)
    observed = observe(arm_of_drives(), recording)
    return {item.at[0] + 1 for item, _ in candidates(observed) if item.effect == effect}


@pytest.mark.parametrize(
    ("effect", "least"), [("encoder_eccentricity", 1.0), ("counterbalance", 0.05)], ids=["eccentricity", "balance"]
)
def test_what_asks_for_travel_is_sought_where_there_is_some(effect, least):
    """Over less than a radian a wave of one turn is a straight line; where a joint stands, its balancing spring only
    repeats what the joints before it do."""
    assert sought(effect, 0.98 * least) == {1, 3}
    assert sought(effect, 1.02 * least) == {1, 2, 3}
    assert sought(effect, 0.0) == {1, 3}


def test_what_asks_for_no_travel_is_sought_at_a_joint_that_stands():
    """An offset is an offset, and a drive gives, wherever the joint is."""
    assert sought("encoder_offset", 0.0) == {1, 2, 3}


def test_windup_is_tried_with_and_without_growth_by_the_load():
    """Coulomb friction alone is the exact alias of backlash that friction holds; with growth it is none."""
    observed = observe(made_arm(), recorded(made_arm(), poses=20, sides="both"))
    sizes = {item.sizes for item, _ in candidates(observed) if item.effect == "friction_windup" and item.at == (1,)}
    assert sizes == {("windup", "windup_per_load"), ("windup",)}


@pytest.mark.parametrize("seed", slow_but(range(4), 0))
def test_what_friction_holds_is_declared_to_be_either(seed):
    """Whatever growth with the load chance would fit, a negative one as well."""
    arm = made_arm()
    true = with_effects(arm, ("friction_windup", (2,), {"windup": 1e-4}))
    result = diagnose(arm, recorded(true, poses=20, sides="both", seed=seed))
    assert result.verdict == "alias_class"
    first = result.findings[0]
    names = {(first.effect, first.at), *((alternative.effect, alternative.at) for alternative in first.alternatives)}
    assert {("friction_windup", (2,)), ("backlash", (2,))} <= names

"""Physics of one's own: an oval encoder disc, whose angle error comes twice a turn."""

import linkwright as lw


def twists(state, settings):
    """What turns at each joint that the effect acts at."""
    size = settings.values.get("amplitude", 0.0)
    for index, joint in enumerate(state.joints):
        if settings.acts_at(index):
            yield from lw.drive_motion(state, index, size * lw.numeric.sin(2.0 * joint.coordinate))


lw.effects.register(
    lw.Effect(
        id="oval_disc",
        title="an oval encoder disc",
        formula="sum J_i a sin 2 q_i",
        place="joint",
        cause="angle errors",
        needs="wide travel",
        aliases=("encoder_eccentricity",),
        source="geometry of an ellipse",
        parameters=(lw.Parameter("amplitude", "angle", "amplitude", -1e-2, 1e-2, (1e-5, 1e-3), "makers", role="size"),),
        twists=twists,
        linear=True,
    )
)
arm = lw.read_arm("examples/bench-arm/arm.yaml")
found = lw.evaluate(arm.replace("effects", [{"effect": "oval_disc", "at": 1, "amplitude": "1 mrad"}]))
print(f"{lw.evaluate(arm).max_error_mm:.3f} mm without, {found.max_error_mm:.3f} mm with it")
figure = found.plot()

"""Which poses to record, so that a soft drive and backlash are seen as small as can be: planned, and at random."""

import linkwright as lw

arm = lw.read_arm("examples/hidden-backlash/arm.yaml")
plan = lw.plan(arm, poses=12, for_=["joint_compliance", "backlash"], payloads=["0 kg", "3 kg"])
print(f"{len(plan.visits)} visits")
figure = plan.plot()

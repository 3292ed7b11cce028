"""Evaluate an arm, sweep a length, optimise, diagnose a recording, and ask what the corrected arm is worth."""

from pathlib import Path

import linkwright as lw

EXAMPLES = Path(__file__).resolve().parents[1]

arm = lw.read_arm(EXAMPLES / "welding-arm" / "arm.yaml")
print(lw.evaluate(arm))
print(lw.evaluate(arm).by_effect.to_string(index=False))

for length in ("380 mm", "400 mm", "420 mm"):
    print(length, round(lw.evaluate(arm.replace("chain[1].link.length", length)).max_error_mm, 4), "mm")

problem = lw.Problem(
    arm,
    minimize="max_error",
    workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
    subject_to={"mass": "<= 30 kg", "section_size": ["20 mm", "150 mm"]},
    choose={"section": ["circle"], "same": ["size"]},
)
best = lw.optimize(problem)
print(best)
print(best.links.to_string(index=False))

real = lw.read_arm(EXAMPLES / "hidden-backlash" / "arm.yaml")
dia = lw.diagnose(real, lw.read_recording(EXAMPLES / "hidden-backlash" / "recording.csv", real))
print(dia)
for each in (real, dia.corrected):
    print(lw.predict(each, EXAMPLES / "hidden-backlash" / "recording.csv"))

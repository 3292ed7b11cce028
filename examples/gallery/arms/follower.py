"""A wrist that a parallelogram keeps level follows the two joints before it. What does that cost at the tip?"""

import plotly.graph_objects as go

import linkwright as lw

tube = {"length": "350 mm", "section": {"shape": "tube", "diameter": "40 mm", "thickness": "3 mm"}}
tube |= {"material": "aluminium-6082-t6"}
drive = {"stiffness": "20 kN*m/rad", "backlash": "0.3 mrad"}
shoulder = (lw.Joint(range=["-30 deg", "90 deg"], **drive), lw.Link(**tube))
elbow = (lw.Joint(range=["-120 deg", "0 deg"], **drive), lw.Link(**tube))
hand = lw.Link(length="120 mm", rigid=True, mass="0.8 kg")
arms = {
    "a rod keeps it level": lw.Joint(follows="-(q1 + q2)", stiffness="20 kN*m/rad", backlash="0.3 mrad"),
    "a drive of its own": lw.Joint(range=["-90 deg", "90 deg"], **drive),
}
figure = go.Figure(layout={"barmode": "stack", "yaxis_title": "worst error in mm"})
parts = {}
for name, wrist in arms.items():
    found = lw.evaluate(lw.Arm([shoulder, elbow, (wrist, hand)], payload={"mass": "2 kg"}))
    parts[name] = found.by_effect.set_index("effect")["error_mm"]
    print(f"{name}: {found.max_error_mm:.3f} mm")
for effect in parts["a drive of its own"].index:
    figure.add_bar(x=list(parts), y=[each.get(effect, 0.0) for each in parts.values()], name=effect)

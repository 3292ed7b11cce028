"""An arm in space, to be turned: what its tip reaches, its worst poses, and how its loads bend it there."""

import linkwright as lw

tube = {"section": {"shape": "tube", "diameter": "60 mm", "thickness": "2 mm"}, "material": "aluminium-6082-t6"}
drive = {"stiffness": "9 kN*m/rad", "backlash": "0.3 mrad"}
chain = [
    (lw.Joint(range=["-150 deg", "150 deg"], **drive), lw.Link(length="250 mm", direction=[0, 0, 1], **tube)),
    (lw.Joint(axis="y", range=["-90 deg", "45 deg"], **drive), lw.Link(length="400 mm", **tube)),
    (lw.Joint(axis="y", range=["0 deg", "120 deg"], **drive), lw.Link(length="350 mm", **tube)),
]
found = lw.evaluate(lw.Arm(chain, gravity=["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"], payload={"mass": "3 kg"}))
figure = lw.show(found)
print(figure.layout.title.text)
figure.update_layout(scene_camera_eye={"x": 0.9, "y": 0.9, "z": 0.4})

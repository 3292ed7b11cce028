"""An arm of three joints for MuJoCo, whose second one may have a `gear` that gives."""

THREE = """<mujoco model="three"><compiler angle="radian"/><option timestep="{step}" gravity="0 0 -9.81"/><worldbody>
<body pos="0 0 .3"><joint name="j1" axis="0 0 1" range="-3 3"/>
<inertial pos="0 .02 -.03" mass="5" diaginertia=".03 .03 .02"/>
<body pos="0 0 .1"><joint name="j2" axis="0 1 0" range="-3 3"/>{gear}
<inertial pos=".2 0 0" mass="4" diaginertia=".01 .07 .07"/>
<body pos=".45 0 0"><joint name="j3" axis="0 1 0" range="-3 3"/>
<inertial pos=".18 .01 0" mass="2.2" diaginertia=".004 .035 .035"/><site name="tool" pos=".4 0 0"/>
</body></body></body>{end}</worldbody></mujoco>"""
NAMES = ("j1", "j2", "j3")

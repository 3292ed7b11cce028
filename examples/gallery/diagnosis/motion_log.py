"""No tip at all, only joint angles and torques against time: which friction, rotor and load has the model left out?"""

import linkwright as lw

robot = lw.read_arm("examples/motion-log/robot.urdf")
dia = lw.diagnose(robot, lw.read_log("examples/motion-log/log.csv", robot))
print(dia)
figure = dia.plot()

"""Blind proof of the diagnosis of motion logs: arms that a controller moves in MuJoCo, with causes that are concealed.

Nothing here comes from the packages that are judged: MuJoCo moves the arm, what it has no word for acts as torques in
the loop, so that the controller reacts to it, and the log is what a drive and a logger make of the motion.
"""

"""What anybody would fit by least squares, as a rival to the tool: calibration of tips, identification of torques.

An implementation of its own, by numpy and scipy alone. It shares no code with what is judged: it reads arm files and
URDF itself, and has a forward kinematics and a rigid regressor of its own.
"""

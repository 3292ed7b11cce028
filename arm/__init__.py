"""The model of an arm: kinematics, statics, dynamics, and the position error of its tip."""

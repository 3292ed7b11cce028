"""Robots as other people's files describe them: read from URDF, written as URDF and MJCF."""

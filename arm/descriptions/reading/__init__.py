"""Descriptions of other programs, read into one tree of links and joints."""

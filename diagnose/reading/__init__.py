"""Recordings read and written: tables, columns, settings, formulas of columns."""

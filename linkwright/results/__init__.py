"""Each result described once (`document.py` says in what terms); screen, report and Markdown render it.

A new result is a module with `describe(result)` and its line in `describe.py`.
"""

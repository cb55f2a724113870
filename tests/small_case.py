"""A case file of a plate so small that a command draws it in seconds."""

TITLE = "A small plate"
SMALL_CASE = f"""
title = "{TITLE}"
regions = [[1, 1], [1, 2]]
[plate]
axial_terms = 2
lateral_terms = 3
[chart]
Omega = [15.0, 28.0]
eps = 0.2
points = [12, 6]
"""

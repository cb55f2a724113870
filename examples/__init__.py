"""The gallery: stability charts that are published or exactly known, each a script to copy.

Each script says what it is about, names its source, and has ``numbers()``: what is published, exact or computed by
other means, and what is found here. A number from a paper is a string, with the digits that the paper prints; an
exact or computed one is a float. ``chart()`` is what the script draws. Run a script, or all of them: ``floquet-charts
gallery``.
"""

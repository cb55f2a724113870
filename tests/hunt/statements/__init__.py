"""Sentences hunted: random systems are drawn, asked of, and every answer is held against another integrator.

`systems` draws, `traces`, `windows`, `comparisons` and `points` ask and turn each answer into statements, `magnus`
integrates by another method, `parts` and `origin` tell what belongs to what, `hunt` counts.

    python -m tests.hunt.statements 1000 --seed 7
    python -m tests.hunt.statements --only --seed 4711
"""

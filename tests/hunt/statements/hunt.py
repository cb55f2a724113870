"""Draw systems, ask of each, judge what is said, and count."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from tests.hunt.statements import comparisons, points, traces, windows
from tests.hunt.statements.statement import Case, Judged, Statement
from tests.hunt.statements.systems import SORTS

# What is asked, and how often of a hundred systems.
QUESTIONS = {
    "trace": (traces.ask, 84),
    "chart": (points.ask_chart, 6),
    "regions": (windows.ask, 3),
    "agreement": (comparisons.ask, 5),
    "certificate": (points.ask_certificate, 2),
}


def case(seed: int, sort: str | None = None) -> Case:
    """Return the case of a seed: sorts take turns unless one is given, the rest is drawn."""
    random = np.random.default_rng(seed)
    sort = sort or list(SORTS)[seed % len(SORTS)]
    shares = np.array([share for _, share in QUESTIONS.values()], float)
    question = str(random.choice(list(QUESTIONS), p=shares / shares.sum()))
    system = SORTS[sort](random)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            asked, found = QUESTIONS[question][0](random, system)
    except ValueError as error:  # the program refuses, and says why
        return Case(seed, sort, question, [Statement(question, f"refused: {error}", Judged.WITHHELD)])
    except (Exception, Warning) as error:
        return Case(seed, sort, question, [Statement(question, f"{type(error).__name__}: {error}", Judged.WRONG)])
    return Case(seed, sort, asked, found)


@dataclass
class Tally:
    """Statements counted, and those that are wrong or withheld."""

    counts: Counter[Judged] = field(default_factory=Counter)
    cases: int = 0
    noted: list[tuple[Case, Statement]] = field(default_factory=list)

    @property
    def checked(self) -> int:
        """Statements that the other integrator could judge."""
        return self.counts[Judged.TRUE] + self.counts[Judged.WRONG]

    def add(self, one: Case) -> None:
        """Count the statements of a case."""
        self.cases += 1
        for statement in one.statements:
            self.counts[statement.judged] += 1
            if statement.judged in (Judged.WRONG, Judged.WITHHELD):
                self.noted.append((one, statement))

    def __str__(self) -> str:
        counts = self.counts
        return (
            f"{self.checked} statements checked about {self.cases} systems, {counts[Judged.WRONG]} wrong; "
            f"{counts[Judged.WITHHELD]} withheld, {counts[Judged.TOO_FINE]} too fine for the other integrator"
        )

    def cases_from(self, seed: int, statements: int, sort: str | None = None) -> Iterator[Case]:
        """Yield cases from a seed on, counted, until as many statements have been checked."""
        while self.checked < statements:
            one = case(seed, sort)
            self.add(one)
            seed += 1
            yield one

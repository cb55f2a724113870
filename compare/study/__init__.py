"""Studies: a subject goes in, charts, verdicts, pictures and a written report come out.

A `Subject` is one system or a few variants of it, in a window of excitation frequency and amplitude. `run_study` draws
its charts and holds theory against integration, region by region; `write_report` puts several studies on one page.

>>> from compare.study import Subject, run_study
>>> from periodic.examples import mathieu
>>> subject = Subject("mathieu", "Mathieu's equation", {"": mathieu()}, (1.5, 2.5), 0.4, points=(16, 8), modes=1)
>>> study = run_study(subject, n_jobs=1, quick=True)
>>> print(study.tally)
1 region compared, all agree
>>> sorted(study.figures())
['chart', 'regions']

`Subject.of_case` makes a subject of a case file, `own_system` and `system_subject` make one of a user's matrices. Large
models are integrated in their lowest modes (`lowest_modes`). `validity` says up to which amplitude a theory holds.
"""

from compare.study.limits import Validity, validity
from compare.study.report import write_report
from compare.study.study import Study, Subject, SystemStudy, run_studies, run_study, tally_of
from compare.study.systems import CHART_POINTS, OwnSystem, own_system, system_subject
from compare.study.truncation import lowest_modes

__all__ = [
    "CHART_POINTS",
    "OwnSystem",
    "Study",
    "Subject",
    "SystemStudy",
    "Validity",
    "lowest_modes",
    "own_system",
    "run_studies",
    "run_study",
    "system_subject",
    "tally_of",
    "validity",
    "write_report",
]

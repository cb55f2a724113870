"""How work is spread over workers, and how results are kept: threads, processes, other machines, files.

`as_completed` and `gather` call a function with many arguments (`parallel`), one BLAS thread a worker (`threads`).
`replace_file` writes files that are complete or not there (`files`), and `source_hash` tells whether what was kept was
computed by the same code (`source`).

>>> from floquet.running import as_completed, source_hash
>>> sorted(as_completed(pow, [(2, 3), (2, 4)], n_jobs=1))
[(0, 8), (1, 16)]
>>> source_hash() == source_hash()
True
"""

from floquet.running.files import replace_file
from floquet.running.parallel import as_completed, gather
from floquet.running.source import source_hash
from floquet.running.threads import single_blas_thread

__all__ = ["as_completed", "gather", "replace_file", "single_blas_thread", "source_hash"]

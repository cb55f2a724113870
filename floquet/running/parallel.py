"""One function, many arguments: in threads, in processes or on other machines, as `joblib.parallel_config` says."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from joblib import Parallel, delayed, effective_n_jobs
from tqdm import tqdm

from floquet.running.threads import single_blas_thread

# Calls of each worker in a wave, of which the backend "multiprocessing" returns all results together: workers wait for
# each other at its end, and all of its results are in memory at the same time.
CALLS_PER_WAVE = 16


def as_completed(
    function: Callable[..., Any], arguments: Iterable[tuple[Any, ...]], n_jobs: int | None
) -> Iterator[tuple[int, Any]]:
    """Yield (i, function(*arguments[i])) in the order in which the results arrive.

    ``arguments`` is read while the work goes on, two calls for each worker in advance, so that neither arguments nor
    results pile up. BLAS has one thread in each call. Workers are threads unless `joblib.parallel_config` names another
    backend. ``n_jobs`` is that of joblib.
    """
    tasks = (delayed(_call)(task) for task in ((i, function, each) for i, each in enumerate(arguments)))
    try:
        parallel = Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1, return_as="generator_unordered")
    except ValueError:  # multiprocessing returns all results of a call of Parallel together
        with Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1) as parallel:
            while wave := list(islice(tasks, CALLS_PER_WAVE * effective_n_jobs(n_jobs))):
                yield from parallel(wave)
    else:
        yield from parallel(tasks)


def gather(
    function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]], n_jobs: int | None, bar: tqdm[Any]
) -> list[Any]:
    """Return [function(*each) for each in arguments], and advance the progress bar by one for each result."""
    results = [None] * len(arguments)
    for i, result in as_completed(function, arguments, n_jobs):
        results[i] = result
        bar.update()
    return results


def _call(task: tuple[int, Callable[..., Any], tuple[Any, ...]]) -> tuple[int, Any]:
    """Return i and the result of the function.

    The arguments are one tuple because joblib sends arrays among the arguments of a task to a single dask worker in
    advance. If that worker died they would be lost, and with them every task that needs them.
    """
    i, function, arguments = task
    with single_blas_thread():
        return i, function(*arguments)

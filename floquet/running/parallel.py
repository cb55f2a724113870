"""One call for many arguments, in threads, in processes or on other machines, as `joblib.parallel_config` says."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from joblib import Parallel, delayed, effective_n_jobs
from tqdm import tqdm

from floquet.running.threads import single_blas_thread

# Calls a worker between two moments at which the backend multiprocessing hands over results: workers wait for each
# other once in so many calls, and so many results are in memory.
WAVE = 16


def spread(
    function: Callable[..., Any], arguments: Iterable[tuple[Any, ...]], n_jobs: int | None
) -> Iterator[tuple[int, Any]]:
    """Yield (i, function(*arguments[i])) in the order in which the results arrive.

    ``arguments`` is read while the work goes on, two calls a worker ahead of it, so that neither arguments nor results
    pile up. BLAS has one thread in each call. Without `joblib.parallel_config` the workers are threads.
    """
    tasks = (delayed(_call)(task) for task in ((i, function, each) for i, each in enumerate(arguments)))
    try:
        parallel = Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1, return_as="generator_unordered")
    except ValueError:  # multiprocessing hands over all results of a call of Parallel together
        with Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1) as parallel:
            while wave := list(islice(tasks, WAVE * effective_n_jobs(n_jobs))):
                yield from parallel(wave)
    else:
        yield from parallel(tasks)


def gather(
    function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]], n_jobs: int | None, bar: tqdm[Any]
) -> list[Any]:
    """Return [function(*each) for each in arguments], and advance the progress bar by one for each result."""
    results = [None] * len(arguments)
    for i, result in spread(function, arguments, n_jobs):
        results[i] = result
        bar.update()
    return results


def _call(task: tuple[int, Callable[..., Any], tuple[Any, ...]]) -> tuple[int, Any]:
    """Return i and what the function returns.

    One tuple, since joblib sends arrays among the arguments of a task to a single dask worker, in advance: if that
    worker dies they are lost, and with them every task that needs them.
    """
    i, function, arguments = task
    with single_blas_thread():
        return i, function(*arguments)

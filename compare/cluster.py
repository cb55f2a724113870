"""Workers on other machines: joblib's tasks through a scheduler of dask.distributed."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from typing import Any

from joblib import parallel_config

from floquet.chart import code_version, processor

# Seconds to reach the scheduler, and until a first worker appears.
MAX_CONNECT_SECONDS, MAX_WORKER_SECONDS = 5, 20


@contextmanager
def workers_at(address: str | None) -> Iterator[str]:
    """Compute everything inside the ``with`` block on the workers of a scheduler; on this machine without one.

    Parameters
    ----------
    address : str or None
        The scheduler's, such as "tcp://10.0.0.1:8786".

    Yields
    ------
    str
        What the user has to know about the workers; empty if there is nothing to know.

    Raises
    ------
    ValueError
        If dask.distributed is not installed, no scheduler answers, the scheduler has no workers, a worker has another
        version of the code, or the connection is lost on the way.
    """
    if address is None:
        yield ""
        return
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise ValueError(
            "--dask needs dask.distributed; install it with: pip install 'floquet-charts[distributed]'"
        ) from None
    logger = logging.getLogger("distributed.client")
    level = logger.level
    logger.setLevel(logging.CRITICAL)  # the exceptions say it
    try:
        try:
            client = Client(address, timeout=MAX_CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = str(error) or type(error).__name__
            raise ValueError(
                f"--dask {address}: no scheduler answers there ({reason}); start one with: dask scheduler"
            ) from None
        with client:
            remark = _checked(client, address)
            with parallel_config(backend="dask", client=client):
                try:
                    yield remark
                except CancelledError as error:
                    raise ValueError(f"--dask {address}: the connection to the scheduler was lost ({error})") from None
                except KilledWorker as error:
                    raise ValueError(
                        f"--dask {address}: a task was given up after the death of several workers ({error}); "
                        "give them more memory"
                    ) from None
    finally:
        logger.setLevel(level)


def _checked(client: Any, address: str) -> str:
    """Make sure that there are workers and that they run this code; return what else there is to say of them."""
    try:
        client.wait_for_workers(1, timeout=MAX_WORKER_SECONDS)
    except TimeoutError:
        raise ValueError(
            f"--dask {address}: the scheduler has no workers; start some with: dask worker {address}"
        ) from None
    try:
        versions, processors = client.run(code_version), client.run(processor)
    except ModuleNotFoundError as error:
        raise ValueError(
            f"--dask {address}: a worker cannot import {error.name}; install floquet-charts there, the same version"
        ) from None
    others = [worker for worker, version in versions.items() if version != code_version()]
    if others:
        raise ValueError(
            f"--dask {address}: the worker {others[0]} has another version of floquet-charts, python, numpy, scipy or "
            "numba; install the same everywhere"
        )
    if len({*processors.values(), processor()}) > 1:
        return "The workers have processors of different kinds: the last digits depend on which of them computes what."
    return ""

"""The option --cluster: whose workers do the work."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer

Cluster = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Of a Dask scheduler, such as tcp://10.0.0.1:8786: its workers do the work. They need this "
        "version of shapeconcepts, and the files under the same paths. Needs the extra `cluster`.",
    ),
]
_SECONDS_TO_CONNECT = 10


@contextmanager
def on_cluster(address: str | None, jobs: int) -> Iterator[None]:
    """Let the workers of a cluster do what is done in parallel; nothing without an address."""
    if address is None:
        yield
        return
    if jobs != -1:
        raise typer.BadParameter("is not for --cluster, whose workers say how many", param_hint="--jobs")
    import joblib

    client = _connected(address)
    try:
        _check_workers(client, address)
        with joblib.parallel_config(backend="dask", client=client):
            yield
    finally:
        client.close()


def _connected(address: str) -> Any:
    try:
        import distributed
    except ImportError:
        raise typer.BadParameter(
            "needs Dask: pip install 'shapeconcepts[cluster]'", param_hint="--cluster"
        ) from None
    try:
        return distributed.Client(address, timeout=_SECONDS_TO_CONNECT, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        reason = str(error).strip().splitlines()[-1:] or [type(error).__name__]
        raise typer.BadParameter(
            f"no Dask scheduler answers at {address!r} ({reason[0]:.100})", param_hint="--cluster"
        ) from None


def _check_workers(client: Any, address: str) -> None:
    from shapeconcepts.version import __version__

    versions = client.run(_version)
    if not versions:
        raise typer.BadParameter(f"the scheduler at {address} has no workers", param_hint="--cluster")
    for worker, version in versions.items():
        if version != __version__:
            raise typer.BadParameter(
                f"worker {worker} has {version or 'no shapeconcepts'}, expected {__version__}",
                param_hint="--cluster",
            )


def _version() -> str:
    try:
        from shapeconcepts.version import __version__
    except ImportError:
        return ""
    return __version__

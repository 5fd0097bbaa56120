"""A campaign on a Dask cluster: on this machine, or on one that is there already.

`python -m touchdown_cosim.scale_out STUDY --lander FILE [--out DIR] [--parts N] [--scheduler ADDRESS | --workers N]`

Each task runs `lander campaign STUDY --shard I/N` on one thread; the folder must be the same for all workers, as on a
cluster's shared file system. Shards are written whole or not at all and one that is there is not computed again, so a
task that Dask repeats because its worker died loses and doubles nothing. At the end `lander campaign` merges the shards:
tables and report are the bytes of a run on one machine. Progress goes to standard error, the summary to standard output.
Exit codes: 0 done, 2 bad input or a failed part, 130 interrupted; the same command goes on from the finished shards.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path

from .land import FAILED, INTERRUPTED, complain

# Parts for each worker: the more, the less is idle at the end and computed again after a death.
PARTS_PER_WORKER = 4


class PartFailed(Exception):
    """What a part's `lander` said; the study is at fault and a repetition would not help."""


def command(options) -> list[str]:
    """`lander campaign` of the study, with absolute paths: workers have folders of their own."""
    paths = [str(Path(path).resolve()) for path in (options.lander, options.study, options.out)]
    return [paths[0], "campaign", paths[1], "--out", paths[2]]


def run_part(whole: list[str], number: int, parts: int) -> int:
    """Runs on a worker: part `number` of `parts`, from 1."""
    part = [*whole, "--threads", "1", "--shard", f"{number}/{parts}"]
    done = subprocess.run(part, capture_output=True, text=True)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines()
        raise PartFailed(f"part {number} of {parts}: {lines[-1] if lines else done.returncode}")
    return number


def say(text: str):
    print(text, file=sys.stderr, flush=True)


def run_parts(client, whole: list[str], parts: int):
    """All parts, in any order, with the time left as the finished ones suggest."""
    from dask.distributed import as_completed

    start = time.monotonic()
    # Impure: what counts is the file that a part leaves.
    numbers = range(1, parts + 1)
    futures = [client.submit(run_part, whole, number, parts, pure=False) for number in numbers]
    for done, future in enumerate(as_completed(futures), 1):
        future.result()
        left_s = (time.monotonic() - start) / done * (parts - done)
        say(f"{done}/{parts} parts, {left_s:.0f} s left")


def connect(options):
    """Client of the cluster asked for, and how many parts to cut the campaign into."""
    from dask.distributed import Client, LocalCluster

    if options.scheduler:
        client = Client(options.scheduler)
    else:
        local = LocalCluster(n_workers=options.workers, threads_per_worker=1, dashboard_address=None)
        client = Client(local)
    workers = max(1, len(client.scheduler_info(n_workers=-1)["workers"]))
    return client, options.parts or PARTS_PER_WORKER * workers


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="scale_out", description=__doc__.splitlines()[0])
    parser.add_argument("study", type=Path, help="study file")
    parser.add_argument("--lander", type=Path, required=True, help="the lander binary, for all workers")
    parser.add_argument("--out", type=Path, default=Path("results/campaigns"), help="folder that all workers share")
    parser.add_argument("--parts", type=int, help=f"{PARTS_PER_WORKER} for each worker if not given")
    parser.add_argument("--scheduler", help="address of a Dask scheduler")
    parser.add_argument("--workers", type=int, help="processes on this machine, without a scheduler")
    parser.add_argument("--json", action="store_true", help="summary as one JSON object")
    options = parser.parse_args(arguments)
    try:
        whole = command(options)
        client, parts = connect(options)
        with client:
            run_parts(client, whole, parts)
        merge = [*whole, "--json"] if options.json else whole
        return subprocess.run(merge).returncode
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        complain(error)
        return FAILED


if __name__ == "__main__":
    sys.exit(main())

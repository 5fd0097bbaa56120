"""A campaign on a Dask cluster, a worker of which is killed: the tables of one machine."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from conftest import LANDER, run
from touchdown_cosim import scale_out

RUNS, SHARD_RUNS = 480, 10
STUDY = f"""
name = "scaled"
kind = "touchdown"
scenario = "{{scenario}}"
runs = {{{{ value = {RUNS}, unit = "1" }}}}
shard_runs = {{{{ value = {SHARD_RUNS}, unit = "1" }}}}
seed = {{{{ value = 5, unit = "1" }}}}

[[design]]
key = "scenario.contact.engine"
distribution = "constant"
value = "strut"

[[dispersion]]
key = "case.across_m_s"
distribution = "uniform"
low = {{{{ value = 0.1, unit = "m/s" }}}}
high = {{{{ value = 2.0, unit = "m/s" }}}}
"""
TABLES = ("results.csv", "results.parquet", "summary.json")


@pytest.fixture
def study(kit, tmp_path) -> Path:
    file = tmp_path / "scaled.toml"
    file.write_text(STUDY.format(scenario=kit / "scenarios" / "tip-over.toml"), encoding="utf-8")
    return file


def tables(folder: Path) -> dict[str, bytes]:
    return {name: (folder / "scaled" / name).read_bytes() for name in TABLES}


def kill_a_worker(client, shards: Path, killed: list):
    """Waits for the first shards, then kills one worker's process, as a node that fails does."""
    while len(list(shards.glob("*.csv"))) < 3:
        time.sleep(0.02)
    worker = sorted(client.run(os.getpid).values())[0]
    os.kill(worker, signal.SIGKILL)
    killed.append(len(list(shards.glob("*.csv"))))


def test_a_killed_worker_loses_and_doubles_nothing(study, tmp_path):
    alone, scaled = tmp_path / "alone", tmp_path / "scaled"
    done = run([LANDER, "campaign", study, "--out", alone])
    assert done.returncode == 0, done.stderr

    from dask.distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        killed = []
        shards = scaled / "scaled" / "shards"
        killer = threading.Thread(target=kill_a_worker, args=(client, shards, killed))
        killer.start()
        arguments = [str(study), "--lander", str(LANDER), "--out", str(scaled), "--parts", "6"]
        assert scale_out.main([*arguments, "--scheduler", cluster.scheduler_address]) == 0
        killer.join()
    assert killed and killed[0] < RUNS / SHARD_RUNS, "the worker died too late to matter"
    assert tables(scaled) == tables(alone)
    rows = tables(scaled)["results.csv"].decode().splitlines()
    numbers = [int(row.split(",")[0]) for row in rows if row[:1].isdigit()]
    assert numbers == list(range(RUNS))


def test_a_bad_study_says_what_is_wrong_with_it(study, tmp_path, capfd):
    study.write_text(study.read_text().replace("case.across_m_s", "case.sideways_m_s"), encoding="utf-8")
    arguments = [str(study), "--lander", str(LANDER), "--out", str(tmp_path), "--workers", "1"]
    assert scale_out.main(arguments) == 2
    assert "sideways_m_s" in capfd.readouterr().err

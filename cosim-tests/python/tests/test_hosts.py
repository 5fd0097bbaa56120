"""What a host process may do with the FMUs: create them by the thousand and use them in threads."""

import ctypes
import threading
from pathlib import Path

import fmpy
import pytest

from conftest import FMUS, SCENARIOS
from touchdown_cosim.component import Component
from touchdown_cosim.variants import fmu_file

CYCLES = 10_000
MODELS = ["lander-truth", "scvx-guidance"]


def resident_kb() -> int:
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(status.split("VmRSS:")[1].split()[0])


@pytest.mark.parametrize("model", MODELS)
def test_ten_thousand_instances_leave_no_memory_behind(model, tmp_path):
    file = fmu_file(FMUS, model)
    description = fmpy.read_model_description(file)
    folder = fmpy.extract(file, tmp_path)
    name = description.coSimulation.modelIdentifier
    library = ctypes.CDLL(f"{folder}/binaries/x86_64-linux/{name}.so")
    create = library.fmi3InstantiateCoSimulation
    create.restype = ctypes.c_void_p
    create.argtypes = [ctypes.c_char_p] * 3 + [ctypes.c_bool] * 4
    create.argtypes += [ctypes.c_void_p, ctypes.c_size_t] + [ctypes.c_void_p] * 3
    library.fmi3FreeInstance.argtypes = [ctypes.c_void_p]
    start = library.fmi3EnterInitializationMode
    start.argtypes = [ctypes.c_void_p, ctypes.c_bool, ctypes.c_double, ctypes.c_double]
    start.argtypes += [ctypes.c_bool, ctypes.c_double]
    token, resources = description.instantiationToken.encode(), f"{folder}/resources/".encode()

    def cycle(count: int):
        for _ in range(count):
            instance = create(
                b"one", token, resources, False, False, False, False, None, 0, None, None, None
            )
            assert start(instance, False, 0.0, 0.0, False, 0.0) == 0
            library.fmi3FreeInstance(instance)

    cycle(CYCLES // 10)
    before_kb = resident_kb()
    cycle(CYCLES - CYCLES // 10)
    # Origin: an instance takes some 100 kB; 9,000 that leak 1 kB each would be 9 MB.
    assert resident_kb() - before_kb < 4_000


def fall(results: list, barrier: threading.Barrier):
    with Component(fmu_file(FMUS, "lander-truth"), "truth") as truth:
        truth.initialize(SCENARIOS / "tip-over.toml")
        barrier.wait()
        for index in range(200):
            truth.step(round(index * 0.01, 9), 0.01)
        results.append([value.hex() for value in truth.get(list(truth.outputs.values()))])


def test_instances_in_threads_do_not_disturb_each_other():
    alone: list = []
    fall(alone, threading.Barrier(1))
    together: list = []
    barrier = threading.Barrier(8)
    threads = [threading.Thread(target=fall, args=(together, barrier)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert together == alone * 8

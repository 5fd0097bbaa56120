"""Lands with FMPy alone: `python land.py lander-truth.fmi3.fmu scvx-guidance.fmi3.fmu`."""

import sys

import fmpy

fmus = []
for file in sys.argv[1:]:
    about = fmpy.read_model_description(file)
    fmu = fmpy.instantiate_fmu(fmpy.extract(file), about, "CoSimulation")
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    of = {v.name: v.valueReference for v in about.modelVariables}
    fmus.append((fmu, of, [v.name for v in about.modelVariables if v.causality == "input"]))
(truth, truth_of, commands), (guidance, guidance_of, readings) = fmus

n = 0
while truth.getFloat64([truth_of["outcome"]]) == [0.0]:
    values = truth.getFloat64([truth_of[name] for name in readings])
    guidance.setFloat64([guidance_of[name] for name in readings], values)
    guidance.doStep(round(n * 0.01, 9), 0.01)
    values = guidance.getFloat64([guidance_of[name] for name in commands])
    truth.setFloat64([truth_of[name] for name in commands], values)
    truth.doStep(round(n * 0.01, 9), 0.01)
    n += 1
outcome, down_m_s = truth.getFloat64([truth_of["outcome"], truth_of["contact_speed_down_m_s"]])
print(f"outcome {outcome:.0f} after {n * 0.01:.2f} s, touched at {down_m_s:.2f} m/s")

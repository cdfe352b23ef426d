#!/usr/bin/env python3
"""Goal: the devices' slowdowns are what bench_device.py counts. Method: for each device that names a CPU class, compares
`slowdown` with the clocks a pixel in expected.json by the rule of platform/devices/device.h, within 4 %.

  profiles_test.py ROOT"""
import json
import math
import os
import re
import sys

MHZ = {"gp2x": 200, "miyoo": 408, "miyoo-mini": 1200, "pi-zero": 1000, "rg350": 996}
HOST_NS = {"cornell": 488, "seesaw": 515}  # on the core that a slowdown of 1 stands for
COUNTED_AS = {"armv4t": "armel"}
TOLERANCE = 0.04

root = sys.argv[1]
with open(os.path.join(root, "tests/bench/device/expected.json")) as file:
    cycles = {(row["class"], row["scene"]): row["cycles_per_pixel"] for row in json.load(file)}
with open(os.path.join(root, "platform/devices/README.md")) as file:
    told = {name: float(slowdown) for name, slowdown in re.findall(r"^\|[^|]*\| `([\w-]+)` \|.*\| ([\d.]+) \|$", file.read(), re.M)}
failures, compared = 0, 0
for name, mhz in MHZ.items():
    with open(os.path.join(root, "platform/devices", name.replace("-", "_") + ".h")) as file:
        source = file.read()
    cpu_class = re.search(r'\bcpu_class = "(\w+)"', source)[1]
    slowdown = float(re.search(r"\bslowdown = ([\d.]+);", source)[1])
    ratios = [cycles[COUNTED_AS.get(cpu_class, cpu_class), scene] / mhz * 1000 / ns for scene, ns in HOST_NS.items()]
    expected = math.sqrt(ratios[0] * ratios[1])
    compared += 1
    if abs(slowdown / expected - 1) > TOLERANCE:
        print(f"FAILED {name}: slowdown {slowdown:g}, but {expected:.3g} by the counts of {cpu_class}")
        failures += 1
    if told.get(name) != slowdown:
        print(f"FAILED {name}: slowdown {slowdown:g}, but {told.get(name)} in platform/devices/README.md")
        failures += 1
print(f"profiles: {compared} devices compared, {failures} failed")
sys.exit(failures > 0)

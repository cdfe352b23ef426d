#!/usr/bin/env python3
"""Counts what encryption costs a device: cycles of a handshake, and for each byte received, estimated as bench_device.py
does. Both ends run in one program and cost about the same, so each is half.

  tls_cost.py armel build-armel/tls_cost
"""
import os
import subprocess
import sys
import tempfile

import bench_device


def count(machine, program, plugin, folder, symbols, arguments):
    qemu, cpu, _, weights = machine
    out = os.path.join(folder, "count.txt")
    command = [qemu, "-cpu", cpu, "-plugin", f"{plugin},out={out}", "-d", "plugin", program, *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode:
        bench_device.fail(f"{program} failed: {run.stderr.strip()}")
    result = bench_device.Count()
    result.add_run(out, symbols, weights, 1)
    return result


def main():
    if len(sys.argv) != 3 or sys.argv[1] not in bench_device.MACHINES:
        sys.exit(__doc__)
    machine, program = bench_device.MACHINES[sys.argv[1]], sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        plugin = bench_device.build_plugin(folder)
        symbols = bench_device.symbols_of(program, machine[2])
        one, three, long = (count(machine, program, plugin, folder, symbols, a) for a in ((1, 0), (3, 0), (1, 1024)))
    handshake = (three.cycles - one.cycles) / 2 / 2
    byte = (long.cycles - one.cycles) / 2 ** 20 / 2
    instructions = (long.instructions - one.instructions) / 2 ** 20 / 2
    print(f"{sys.argv[1]}: {handshake / 1e6:.1f} million cycles a handshake, {byte:.1f} cycles"
          f" ({instructions:.1f} instructions) a byte")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Counts what a device needs to prepare a frame of a moving scene: to pose it, refit its accelerator and place its
lights. Cycles, estimated as bench_device.py does, of frames of one pixel after the first, per triangle of the scene.

  prepare_cost.py armel build-armel/pocketray build/pocketray [SCENE]...
"""
import json
import os
import subprocess
import sys
import tempfile

import bench_device

FRAMES = (2, 6)


def cycles_of(machine, program, plugin, folder, symbols, scene, frame_count):
    arguments = ["render", scene, "--size", "1x1", "--threads", "1", "--coherence", "off", "--frames",
                 f"0:{frame_count - 1}", "-o", os.path.join(folder, "out.raw")]
    count = bench_device.Count()
    bench_device.add_counted(count, machine, program, plugin, folder, symbols, arguments)
    return count.cycles


def triangles_in(baker, scene):
    run = subprocess.run([baker, "plan", scene, "--json", "-"], capture_output=True, text=True)
    return json.loads(run.stdout[run.stdout.index("{"):])["triangles"]


def main():
    if len(sys.argv) < 4 or sys.argv[1] not in bench_device.MACHINES:
        sys.exit(__doc__)
    machine, program, baker = bench_device.MACHINES[sys.argv[1]], sys.argv[2], sys.argv[3]
    with tempfile.TemporaryDirectory() as folder:
        plugin = bench_device.build_plugin(folder)
        symbols = bench_device.symbols_of(program, machine[2])
        for scene in sys.argv[4:] or ["seesaw"]:
            baked = bench_device.bake(baker, scene, "", folder)
            first, last = (cycles_of(machine, program, plugin, folder, symbols, baked, n) for n in FRAMES)
            per_frame = (last - first) / (FRAMES[1] - FRAMES[0])
            triangles = triangles_in(baker, scene)
            print(f"{sys.argv[1]}, {os.path.basename(scene)}: {per_frame / 1e6:.2f} million cycles a frame, "
                  f"{per_frame / triangles:.0f} for each of {triangles} triangles", flush=True)


if __name__ == "__main__":
    main()

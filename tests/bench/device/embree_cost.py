#!/usr/bin/env python3
"""Counts the instructions that a ray takes in pocketray's accelerator and in Embree on a device: those of a second round of
the same rays, on one thread, loading and building left out.

  embree_cost.py CLASS PROGRAM EMBREE HOST-PROGRAM [--json FILE] [--size WxH] [SCENE]...

PROGRAM is embree_cost for the device, EMBREE the folder with the packages that it is linked with, SCENE a built-in scene
or a file. Without one: cornell and, where the models are, the Buddha. `make bench-embree DEVICE=aarch64` calls it.
"""
import argparse
import glob
import json
import os
import sys
import tempfile

import bench_device

KINDS = ("primary", "shadow", "bounce")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("cpu_class", "program", "embree", "host"):
        parser.add_argument(name)
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--json")
    arguments = parser.parse_intermixed_args()
    machine = bench_device.MACHINES[arguments.cpu_class]
    libraries = glob.glob(os.path.join(arguments.embree, "usr/lib/*-linux-gnu"))
    # Embree asks the C library of the cross compiler, too, for its symbols.
    os.environ["QEMU_LD_PREFIX"] = "/usr/" + machine[2].rstrip("-")
    os.environ["QEMU_SET_ENV"] = "LD_LIBRARY_PATH=" + ":".join(libraries)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        plugin = bench_device.build_plugin(folder)

        def run(scene, kind, *side_and_rounds):
            count = bench_device.Count()
            command = [scene, arguments.size, kind, *side_and_rounds]
            text = bench_device.add_counted(count, machine, arguments.program, plugin, folder, ([0], ["all"]), command)
            return count.instructions, text

        def per_ray(scene, kind, side):
            once, text = run(scene, kind, side, "1")
            return (run(scene, kind, side, "2")[0] - once) / int(text)

        for scene in arguments.scenes or ["cornell", "buddha"]:
            baked = bench_device.bake(arguments.host, scene, arguments.shared, folder)
            if not baked:
                print(f"{scene}: skipped, since its model is not there", file=sys.stderr)
                continue
            for kind in KINDS:
                modes = [line for line in run(baked, kind)[1].splitlines() if line]
                ours = per_ray(baked, kind, "ours")
                for mode in modes:
                    embree = per_ray(baked, kind, mode)
                    rows.append({"scene": scene, "class": arguments.cpu_class, "size": arguments.size, "rays": kind,
                                 "embree_mode": mode, "ours": round(ours, 1), "embree": round(embree, 1),
                                 "ratio": round(ours / embree, 3)})
                    print(f"{scene:10} {kind:8} {mode:22} ours {ours:8.0f}  Embree {embree:8.0f}  ratio {ours / embree:.2f}",
                          flush=True, file=sys.stderr if arguments.json == "-" else sys.stdout)
    if arguments.json:
        text = json.dumps(rows, indent=1)
        if arguments.json == "-":
            print(text)
        else:
            with open(arguments.json, "w") as file:
                file.write(text + "\n")


if __name__ == "__main__":
    main()

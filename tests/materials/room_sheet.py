#!/usr/bin/env python3
"""Renders five lit rooms with pocketray, by default settings, and with Cycles at full light transport.

rooms.py makes the rooms in Blender; the exporter of platform/blender writes them, and `pocketray render` shows them at the
size and fixed exposure that Cycles has. `make room-sheet` calls it. Two pictures by Cycles with different seeds tell what
its noise adds to ꟻLIP: a mean of both has half the variance, so what both add beyond is taken away once more.
"""
import argparse
import json
import os
import shlex

import sheet

ROOMS = ("office", "bedroom", "kitchen", "bar", "gallery")
EXPORTER = os.path.join(sheet.HERE, "../../platform/blender/pocketray.py")
MEAN_MAX = 0.19
LIGHT = {"width": sheet.WIDTH, "height": sheet.HEIGHT, "depth": 12, "diffuse_bounces": 12, "clamp": 10}


def bake(program, room, folder):
    bin_folder = os.path.join(folder, "bin")
    os.makedirs(bin_folder, exist_ok=True)
    link = os.path.join(bin_folder, "pocketray")
    if os.path.lexists(link):
        os.remove(link)
    os.symlink(os.path.abspath(program), link)
    failed, messages = sheet.run_blender(EXPORTER, room["baked"], scene=room["blend"], program=bin_folder)
    if failed:
        sheet.fail(f"{room['name']}: {failed}")
    return messages


def judge(arguments, room, folder):
    at = lambda end: os.path.join(folder, room["name"] + end)
    both, difference = at(".both.png"), at(".flip.png")
    status, _, messages = sheet.run(["convert", *room["pictures"], "-evaluate-sequence", "mean", both])
    if status:
        sheet.fail("convert: " + messages)
    status, _, messages = sheet.run([arguments.program, "render", room["baked"], "--size", f"{sheet.WIDTH}x{sheet.HEIGHT}",
                                     "--exposure", "fixed", *shlex.split(arguments.render), "-o", at(".pocketray.png")])
    if status:
        sheet.fail(f"{room['name']}: {messages}")
    mean = sheet.flip(arguments.program, both, at(".pocketray.png"), difference)
    single = [sheet.flip(arguments.program, one, at(".pocketray.png")) for one in room["pictures"]]
    return {"model": room["name"], "flip": 2 * mean - sum(single) / 2, "with noise": mean,
            "warnings": [f"{mean:.3f} with Cycles' noise"] + sheet.warnings_in(messages),
            "pictures": [at(".pocketray.png"), both, difference]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    sheet.add_options(parser, "build/room-sheet", 256, 1)
    parser.add_argument("--rooms", nargs="+", metavar="NAME", choices=ROOMS, default=ROOMS,
                        help="only these: " + ", ".join(ROOMS))
    parser.add_argument("--render", default="", metavar="OPTIONS", help="of `pocketray render`, besides size and exposure")
    parser.add_argument("--keep-baked", action="store_true", help="bake only rooms that are not baked yet")
    parser.add_argument("--fail-above", type=float, metavar="MEAN",
                        help=f"exit with 1 if the mean ꟻLIP exceeds it ({MEAN_MAX})")
    arguments = parser.parse_args()
    sheet.check_tools()
    folder = os.path.abspath(arguments.folder)
    os.makedirs(folder, exist_ok=True)
    light = dict(LIGHT, samples=arguments.samples)
    sheet.forget_others(folder, ".cycles.png", ("rooms.py", "furniture.py", "cycles_picture.py"), light)
    at = lambda name, end: os.path.join(folder, name + end)
    rooms = [{"name": name, "blend": at(name, ".blend"), "baked": at(name, ".pray"),
              "pictures": [at(name, f".{seed}.cycles.png") for seed in (1, 2)]} for name in arguments.rooms]
    with open(at("jobs", ".json"), "w") as file:
        json.dump(dict(light, rooms=rooms), file)
    print(f"rendering {len(rooms)} rooms with Cycles", flush=True)
    failed, _ = sheet.run_blender(os.path.join(sheet.HERE, "rooms.py"), at("jobs", ".json"))
    if failed:
        sheet.fail("Blender failed:\n" + failed)
    for room in rooms:
        if not (arguments.keep_baked and os.path.exists(room["baked"])):
            for line in bake(arguments.program, room, folder).splitlines():
                if line.startswith("radiosity:"):
                    print(f"{room['name']}: {line}", flush=True)
    limit = MEAN_MAX if arguments.fail_above is None and len(rooms) == len(ROOMS) else arguments.fail_above
    sheet.report([judge(arguments, room, folder) for room in rooms], arguments.rooms, arguments, limit)


if __name__ == "__main__":
    main()

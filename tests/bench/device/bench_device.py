#!/usr/bin/env python3
"""Counts the instructions that a device spends per pixel, in all, by part of the program and by effect. With --classes
alone, prints the CPU classes that can be counted.

Runs the device's program under QEMU's user mode, which repeats exactly, at two picture sizes; the difference leaves
start-up out, which is counted on its own. Cycles are estimated from weights by class of instruction: no caches, no dual
issue, not calibrated on hardware. `make bench-device DEVICE=armhf` calls it.
"""
import argparse
import bisect
import json
import os
import re
import shlex
import struct
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SIZES = ((320, 240), (160, 120))
PIXELS = SIZES[0][0] * SIZES[0][1] - SIZES[1][0] * SIZES[1][1]
BUDDHA = "mesh/happy_vrip_res3.ply"
SCENES = ("cornell", "statue", "seesaw", "buddha")
TOLERANCE, START_TOLERANCE = 1.02, 1.1  # the start depends on the machine, too: its environment, its file system

# As in count.c; then registers moved by loads and by stores.
CLASSES = ("integer", "branch", "load", "store", "multiply", "divide", "float", "float divide", "vector")
MACHINES = {  # QEMU, CPU, tools, and cycles by class; loads and stores take their registers moved in addition
    "armel": ("qemu-arm", "arm926", "arm-linux-gnueabi-", (1, 3, 1, 0, 3, 30, 1, 1, 1)),
    "armv6": ("qemu-arm", "arm1176", "arm-linux-gnueabi-", (1, 2, 1, 0, 2, 30, 3, 15, 3)),
    "armv7": ("qemu-arm", "cortex-a9", "arm-linux-gnueabihf-", (1, 2, 1, 0, 2, 30, 2, 15, 2)),
    "armhf": ("qemu-arm", "cortex-a7", "arm-linux-gnueabihf-", (1, 2, 1, 0, 2, 8, 2, 18, 2)),
    "aarch64": ("qemu-aarch64", "cortex-a53", "aarch64-linux-gnu-", (1, 2, 1, 0, 3, 8, 2, 14, 2)),
    "mips32": ("qemu-mipsel", "24Kf", "mipsel-linux-gnu-", (1, 2, 1, 0, 3, 30, 3, 15, 3)),
}
PARTS = (  # the first that matches a symbol
    ("soft float", r"^(__aeabi_[fdlui]|__(add|sub|mul|div|cmp|eq|ne|ge|gt|le|lt|unord|float|fix|extend|trunc|udiv|sqrt)|"
                   r"_*aeabi|sqrt|__ieee754|.*soft)"),
    ("triangles", r"(neon|baseline)::.*(leaf|leaves|triangle|segment|crossing|cross_|settle|locate|test_rays|list_|"
                  r"meet_window|edge|place_)"),
    ("traversal", r"(neon|baseline)::|Guarded|occluded|closest"),
    ("lights", r"direct_light|polygon|edge_sum|area_lights|_points|find_views|_light\(|reach\(|tile_shadows|shadow|"
               r"transmittance|accept_|LightPoint"),
    ("pack", r"pack|tone|sRGB|srgb|dither|write_row"),
    ("surface", r"surface|smooth_normal|texture|shade|radiance|contact|normalize|mirror|dielectric|fresnel|brdf|"
                r"spawn|det_|origin"),
    ("camera", r"trace_spans|camera|trace_frame|strip"),
)
# Starts from a file, with a camera that looks away, so that frames cost next to nothing; and its parts.
START = ("bench", "--no-prices", "--frames", "1", "--size", "8x6", "--threads", "1", "--memory", "400M", "--camera",
         "9000,9000,9000 9900,9900,9900 0,1,0 40")
START_PARTS = (
    ("checksum", r"block_sum|add_stripes|join_sums|crc32|hash_part"),
    ("tree", r"node_is_plain|bvh_adopt|check_nodes|check_numbers|set_(no_)?rows|surely_has_area|is_plainly_sound|fill_block|"
             r"fetch_triangle"),
    ("arrays", r"largest_|least_magnitude|find_|has_word|bounds|validate_|is_surely_inside|take_census|has_light"),
)


def part_of(symbol):
    for name, pattern in PARTS:
        if re.search(pattern, symbol):
            return name
    return "other"


def fail(text):
    sys.exit("bench_device: " + text)


def build_plugin(folder):
    library = os.path.join(folder, "libcount.so")
    command = ["cc", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", os.path.join(HERE, "count.c"), "-o", library]
    if subprocess.run(command).returncode:
        fail("cannot compile count.c")
    return library


def symbols_of(program, tools):
    """Sorted addresses and names, from the symbols beside the program or in it."""
    source = program + ".debug" if os.path.exists(program + ".debug") else program
    listing = subprocess.run([tools + "nm", "-C", "-n", "--defined-only", source], capture_output=True, text=True).stdout
    addresses, names = [], []
    for line in listing.splitlines():
        match = re.match(r"([0-9a-f]+) [tTwWiIuV] (.*)", line)
        if match and not match[2].startswith("$"):
            addresses.append(int(match[1], 16) & ~1)
            names.append(match[2])
    if not names:
        fail(f"{source} has no symbols")
    return addresses, names


def compiler_of(tools):
    return subprocess.run([tools + "g++", "-dumpfullversion"], capture_output=True, text=True).stdout.strip()


class Count:
    """Instructions and cycles, in all and by part."""

    def __init__(self):
        self.instructions, self.cycles, self.parts, self.symbols = 0, 0, {}, {}

    def add_run(self, path, symbols, weights, sign):
        addresses, names = symbols
        with open(path) as lines:
            for line in lines:
                address, executions, *counts = line.split()
                counts = [int(x) for x in counts]
                times = int(executions) * sign
                classes, moved = counts[:len(CLASSES)], sum(counts[len(CLASSES):])
                instructions = sum(classes) * times
                self.instructions += instructions
                self.cycles += (sum(n * w for n, w in zip(classes, weights)) + moved) * times
                index = bisect.bisect_right(addresses, int(address, 16)) - 1
                name = names[index] if index >= 0 else "?"
                self.symbols[name] = self.symbols.get(name, 0) + instructions
                part = part_of(name)
                self.parts[part] = self.parts.get(part, 0) + instructions


def add_counted(count, machine, program, plugin, folder, symbols, arguments, sign=1):
    """Runs the program and adds its counts, or subtracts them. Returns what it printed."""
    qemu, cpu, _, weights = machine
    out = os.path.join(folder, "count.txt")
    command = [qemu, "-cpu", cpu, "-plugin", f"{plugin},out={out}", "-d", "plugin", program, *arguments]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode:
        fail(f"{os.path.basename(program)} {' '.join(arguments[:2])} failed: {run.stderr.strip()}")
    count.add_run(out, symbols, weights, sign)
    return run.stdout


def count_pixels(machine, program, scene, plugin, folder, symbols, options, effects="auto"):
    """The counts of PIXELS pixels, and the instructions before the first pixel and after the last."""
    count, start = Count(), 0
    for (width, height), sign in zip(SIZES, (1, -1)):
        arguments = ["render", scene, "--size", f"{width}x{height}", "--threads", "1", "--effects", effects, *options,
                     "-o", os.path.join(folder, "out.raw")]
        add_counted(count, machine, program, plugin, folder, symbols, arguments, sign)
        start = start or count.instructions
    return count, start - count.instructions * SIZES[0][0] * SIZES[0][1] // PIXELS


def bake(baker, scene, shared, folder):
    """The scene as a .pray file, or None."""
    if scene.endswith(".pray"):
        return scene
    source = scene
    if scene == "buddha":
        source = os.path.join(shared, "scenes", BUDDHA)
        if not os.path.exists(source):
            return None
    target = os.path.join(folder, os.path.basename(scene) + ".pray")
    run = subprocess.run([baker, "bake", source, "--no-radiosity", "-o", target], capture_output=True, text=True)
    if run.returncode:
        fail(f"cannot bake {scene}: {run.stderr.strip()}")
    return target


def triangles_in(path):
    with open(path, "rb") as file:
        return struct.unpack_from("<I", file.read(64 + 24 * 6), 64 + 24 * 5 + 16)[0]  # src/scene/baked_layout.h


def measure_start(arguments, machine, baked, plugin, folder, symbols):
    """Prints the instructions a triangle before the first frame."""
    count, triangles = Count(), triangles_in(baked)
    add_counted(count, machine, arguments.program, plugin, folder, symbols,
                [START[0], baked, *START[1:]])
    parts = {part: sum(n for name, n in count.symbols.items() if re.search(pattern, name))
             for part, pattern in START_PARTS}
    parts["other"] = count.instructions - sum(parts.values())
    print(f"{os.path.basename(baked)}: {count.instructions / triangles:,.0f} instructions a triangle to start: " +
          ", ".join(f"{part} {n / triangles:,.0f}" for part, n in parts.items()), file=sys.stderr, flush=True)


def effects_in(baker, scene):
    run = subprocess.run([baker, "plan", scene, "--json", "-"], capture_output=True, text=True)
    plan = json.loads(run.stdout[run.stdout.index("{"):])
    return [effect["name"] for effect in plan["effects"] if effect.get("on")]


def measure(arguments):
    machine = MACHINES[arguments.cpu_class]
    results, options = [], shlex.split(arguments.options)
    with tempfile.TemporaryDirectory() as folder:
        plugin = build_plugin(folder)
        symbols = symbols_of(arguments.program, machine[2])
        for scene in arguments.scenes:
            baked = bake(arguments.baker, scene, arguments.shared, folder)
            if not baked:
                print(f"{scene}: skipped, since {arguments.shared}/scenes/{BUDDHA} is not there", file=sys.stderr)
                continue
            if arguments.start:
                measure_start(arguments, machine, baked, plugin, folder, symbols)
                continue
            count, start = count_pixels(machine, arguments.program, baked, plugin, folder, symbols, options)
            result = {"scene": scene, "class": arguments.cpu_class, "compiler": compiler_of(machine[2]),
                      "instructions_per_pixel": round(count.instructions / PIXELS, 1),
                      "cycles_per_pixel": round(count.cycles / PIXELS, 1), "start_instructions": start,
                      "parts": {part: round(n / PIXELS, 1) for part, n in
                                sorted(count.parts.items(), key=lambda item: -item[1])}}
            if options:
                result["options"] = arguments.options
            if arguments.effects:
                result["effects"] = {}
                for effect in effects_in(arguments.baker, baked):
                    without, _ = count_pixels(machine, arguments.program, baked, plugin, folder, symbols, options,
                                              f"auto,-{effect}")
                    result["effects"][effect] = round((count.instructions - without.instructions) / PIXELS, 1)
            results.append(result)
            print_result(result)
            if arguments.symbols:
                for name, n in sorted(count.symbols.items(), key=lambda item: -item[1])[:arguments.symbols]:
                    print(f"  {n / PIXELS:9.1f}  {name[:110]}", file=sys.stderr)
    return results


def print_result(result):
    def row(values):
        return ", ".join(f"{name} {round(n):,}" for name, n in values.items())
    print(f"{result['scene']}: {round(result['instructions_per_pixel']):,} instructions a pixel, about "
          f"{round(result['cycles_per_pixel']):,} cycles; {result['start_instructions'] / 1e6:,.1f} million to start\n  parts: {row(result['parts'])}", file=sys.stderr, flush=True)
    if result.get("effects"):
        print(f"  effects: {row(result['effects'])}", file=sys.stderr, flush=True)


def check(results, path):
    """Compares with committed counts. Returns the number of scenes that got worse."""
    with open(path) as file:
        expected = {(row["scene"], row["class"]): row for row in json.load(file)}
    worse = 0
    for result in results:
        was = expected.get((result["scene"], result["class"]))
        if was is None:
            worse += 1
            print(f"{result['scene']} on {result['class']}: {path} has no count of it; add it", file=sys.stderr)
            continue
        if was["compiler"] != result["compiler"]:
            print(f"{result['scene']}: not compared, since {path} has its count with GCC {was['compiler']}, not "
                  f"{result['compiler']}", file=sys.stderr)
            continue
        for what, key, most in (("a pixel", "instructions_per_pixel", TOLERANCE),
                                ("to start", "start_instructions", START_TOLERANCE)):
            ratio = result[key] / was[key] if key in was else 1
            if ratio > most:
                worse += 1
                print(f"{result['scene']} on {result['class']}: {ratio:.3f} times the instructions {what} in {path}; make it "
                      f"faster, or state the reason and update the file", file=sys.stderr)
    return worse


def main():
    if sys.argv[1:] == ["--classes"]:
        print(*sorted(MACHINES))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cpu_class", choices=sorted(MACHINES), metavar="CLASS", help=" ".join(sorted(MACHINES)))
    parser.add_argument("program", help="pocketray for the device, statically linked, its symbols in PROGRAM.debug")
    parser.add_argument("baker", help="pocketray for this machine")
    parser.add_argument("--scenes", nargs="+", default=SCENES, help="built-in scenes, files, or buddha")
    parser.add_argument("--shared", default="../shared", help="where the Buddha's scenes/ is")
    parser.add_argument("--effects", action="store_true", help="also price each effect: render without it")
    parser.add_argument("--start", action="store_true", help="count only the start from a file, by triangle")
    parser.add_argument("--symbols", type=int, default=0, metavar="N", help="also list the N dearest functions")
    parser.add_argument("--options", default="", metavar="TEXT", help='options of render, as in --options="--selective .25"')
    parser.add_argument("--json", metavar="FILE", help="write the results; - for standard output")
    parser.add_argument("--check", metavar="FILE", help="fail if a scene takes 2 %% more instructions than in FILE, or 10 %% more to start")
    arguments = parser.parse_args()
    if arguments.options and arguments.check:
        fail("the counts to --check with are those without --options")
    results = measure(arguments)
    text = json.dumps(results, indent=2) + "\n"
    if arguments.json == "-":
        print(text, end="")
    elif arguments.json:
        with open(arguments.json, "w") as file:
            file.write(text)
    if arguments.check and check(results, arguments.check):
        sys.exit(1)


if __name__ == "__main__":
    main()

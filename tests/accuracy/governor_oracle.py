#!/usr/bin/env python3
"""Compares the choice of `--budget-ms` with an exhaustive search.

Each scene gets a reference by `pocketray reference`, a front by `pocketray accuracy`, and one picture for each
combination of a grid of settings. The oracle's choice is the picture nearest to the reference, by `pocketray compare`,
of those that took no longer than the budget. Writes a table in Markdown to standard output.

    tests/accuracy/governor_oracle.py build/pocketray build/governor SCENE ...

Pictures, references and fronts stay in the folder and are not made again.
"""
import argparse
import itertools
import json
import math
import os
import pathlib
import subprocess
import sys

BUDGETS = [20, 50, 100, 1000]
INVISIBLE = 0.005  # a difference of mean FLIP that nobody sees

AXES = {
    "samples": [["--samples", str(n)] for n in (1, 4, 16)],
    "points": [["--area-lights", str(n)] for n in (1, 4, 16)],
    "depth": [["--depth", str(n)] for n in (2, 8)],
    "pixels": [[], ["--selective", "0.25"], ["--resolution", "half"]],
    "environment": [["--environment-shadows", str(n)] for n in (32, 128)],
    "method": [[]] + [["--indirect", "instant-radiosity", "--virtual-lights", str(lights), "--compensation", how]
                      for lights, how in ((64, "none"), (256, "rays"), (512, "rays"))],
}
# Every picture is the last frame of a sequence, LAST / RATE seconds into the animation.
RATE, LAST = 240, 11
# What an axis is measured with to see whether the scene depends on it.
BASE = {"samples": 0, "points": 1, "depth": 1, "pixels": 0, "environment": 0, "method": 0}


class Scene:
    def __init__(self, program, folder, scene, size, reference_samples):
        self.program, self.scene, self.size = program, scene, size
        self.name = pathlib.Path(scene).stem
        self.folder = folder / self.name
        self.folder.mkdir(parents=True, exist_ok=True)
        self.reference = self.folder / "reference.pfm"
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        self.pictures_file = self.folder / "pictures.json"
        self.pictures = json.loads(self.pictures_file.read_text()) if self.pictures_file.exists() else {}
        if pathlib.Path(scene).exists() and not scene.endswith(".pray"):
            self.scene = str(self.folder / "scene.pray")
            if not os.path.exists(self.scene):
                self.run("bake", scene, "-o", self.scene)
        self.run("reference", self.scene, "--size", size, "--samples", str(reference_samples), "--time",
                 str(LAST / RATE), "-o", str(self.reference))

    def run(self, *arguments):
        done = subprocess.run([self.program, *arguments], env=self.environment, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(arguments)}: {done.stderr.strip()}")
        return done.stdout

    def measure_front(self):
        if not (self.folder / "accuracy" / "accuracy.csv").exists():
            self.run("accuracy", self.scene, "--size", self.size, "--rounds", "6", "-o", str(self.folder / "accuracy"))

    def picture(self, settings, frames=3):
        """Renders frames and returns the milliseconds of one and the last one's mean FLIP to the reference."""
        output = self.folder / "picture.png"
        report = json.loads(self.run("render", self.scene, "--size", self.size, "--frames",
                                     f"{LAST + 1 - frames}:{LAST}", "--fps", str(RATE), "-o", str(output), "--json", "-", *settings))
        last = report["files"][-1]
        judged = json.loads(self.run("compare", str(self.reference), last, "--exposure", str(math.log2(report["exposure"])),
                                     "--json", "-"))
        for file in report["files"]:
            os.unlink(file)
        return {"ms": report["ns_per_pixel"] * report["width"] * report["height"] / 1e6, "flip": judged["flip"],
                "settings": settings, "chosen": report.get("budget")}

    def known_picture(self, settings):
        key = " ".join(settings)
        if key not in self.pictures:
            self.pictures[key] = self.picture(settings)
            self.pictures_file.write_text(json.dumps(self.pictures))
        return self.pictures[key]

    def live_axes(self):
        """The values of each axis that change picture or time; of the others, the first."""
        base = [axis[BASE[name]] for name, axis in AXES.items()]
        start = self.known_picture(sum(base, []))
        axes = []
        for i, (name, axis) in enumerate(AXES.items()):
            values = []
            for value in axis:
                changed = self.known_picture(sum(base[:i] + [value] + base[i + 1:], []))
                if value == axis[BASE[name]] or abs(changed["flip"] / start["flip"] - 1) > 1e-4:
                    values.append(value)
            axes.append(values)
        return axes

    def search(self):
        pictures = [self.known_picture(sum(values, [])) for values in itertools.product(*self.live_axes())]
        return sorted(pictures, key=lambda p: p["ms"])


def row(scene, budgets, slack):
    scene.measure_front()
    pictures = scene.search()
    cells, errors = [], []
    for budget in budgets:
        within = [p for p in pictures if p["ms"] <= budget]
        best = min(within or pictures[:1], key=lambda p: p["flip"])
        chosen = scene.picture(["--budget-ms", str(budget)], frames=LAST + 1)
        errors.append(chosen["flip"])
        is_near = chosen["flip"] <= max(best["flip"] * (1 + slack), best["flip"] + INVISIBLE)
        mark = "" if is_near else " **"
        cells.append(f"{chosen['flip']:.3f} / {best['flip']:.3f}{mark}")
        print(f"{scene.name} {budget} ms: {chosen['ms']:.1f} ms, best {best['ms']:.1f} ms by {' '.join(best['settings'])}",
              file=sys.stderr)
    rises = any(later > earlier * 1.01 for earlier, later in zip(errors, errors[1:]))
    return f"| {scene.name} | {len(pictures)} | " + " | ".join(cells) + (" | rises |" if rises else " | |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--budgets", default=",".join(map(str, BUDGETS)))
    parser.add_argument("--reference-samples", type=int, default=256)
    parser.add_argument("--slack", type=float, default=0.1)
    options = parser.parse_args()
    budgets = [float(b) for b in options.budgets.split(",")]
    print("| scene | pictures | " + " | ".join(f"{b:g} ms" for b in budgets) + " | |")
    print("|---" * (len(budgets) + 3) + "|")
    for path in options.scenes:
        scene = Scene(os.path.abspath(options.program), options.folder, path, options.size, options.reference_samples)
        print(row(scene, budgets, options.slack), flush=True)


if __name__ == "__main__":
    main()

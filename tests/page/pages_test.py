#!/usr/bin/env python3
"""pages_test.py PROGRAM FOLDER [--write]: the pages of `pocketray accuracy` and of the hard cases in Chromium, from files.

Each is loaded 1200 and 390 pixels wide, light and dark. Screenshots stay in FOLDER and are compared by region with
expected.json; --write writes it anew: look at the screenshots first. Exit status 77: skipped.
"""
import base64
import csv
import json
import os
import re
import shutil
import subprocess
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "hard", "page"))
import scripts
from browser import Browser
from rows import ROWS

SIZES = {1200: 900, 390: 844}
SCHEMES = ("light", "dark")

# Regions: selector of an element, the screen (None) or every such element; how far its mean colour may be off.
REGIONS = {
    "accuracy": {"screen": (None, 16), "levels": (".quality", 20), "truth": (".quality figure:last-child img", 8),
                 "explanation": (".quality + p", 10), "answer": (".answer", 10), "prices": (".pair table", 10),
                 "plot": ("figure.plot", 12), "strip": (".strip", 24)},
    "hardcases": {"screen": (None, 10), "answer": (".answer", 8), "row": ("tbody tr:nth-child(2)", 10),
                  "picture": ("svg.picture", 10), "method": (".method", 10)},
}
# A region has this many times as much ink as expected.
INK_LOW, INK_HIGH = 0.6, 1.6

failures = []


def check(what, good, detail=""):
    if not good:
        failures.append(what)
        if len(failures) <= 20:
            print(f"FAILED {what}" + (f": {str(detail)[:300]}" if detail else ""))


def make_accuracy_page(program, folder):
    environment = dict(os.environ, XDG_CACHE_HOME=os.path.join(folder, "cache"))
    command = [program, "accuracy", "cornell", "--size", "80x60", "--rounds", "2", "--reference-samples", "16", "--price-limit", "4",
               "--threads", "2", "-o", os.path.join(folder, "accuracy")]
    made = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if made.returncode != 0:
        sys.exit(f"FAILED {' '.join(command)}: {made.stdout.decode()}")
    return os.path.join(folder, "accuracy", "index.html")


def make_hard_page(folder):
    """The page with made-up figures for every row and method."""
    lines, names = [], []
    for row in ROWS:
        beside = "plain|ray|20000|1500|4e-05|0|5e-05;Woop et al., contracted|ray|20000|12|3e-05|0|5e-05" if row % 3 == 1 else ""
        for test in ("one", "another"):
            names.append(f"hard\thard_{row:02}_{test}\n")
            lines.append(f"hard_{row:02}_{test}\t{1000 * row}\t0\t0 misses\t1.5\t{beside}\t1\n")
    for name, content in (("lines", lines), ("names", names)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.writelines(content)
    page = os.path.join(folder, "hardcases.html")
    subprocess.run([sys.executable, "-B", os.path.join(here, "..", "hard", "page", "page.py"), os.path.join(folder, "lines"),
                    os.path.join(folder, "names"), page], check=True)
    return page


class View:
    """A page at a width, in a scheme."""

    def __init__(self, tab, looker, page, name, width, scheme, folder):
        self.tab, self.looker, self.width, self.height, self.scheme = tab, looker, width, SIZES[width], scheme
        self.name, self.where, self.folder = name, f"{name} {width} {scheme}", folder
        self.page = page
        self.errors = tab.load("file://" + page, width, self.height, scheme)

    def rows_of(self, link):
        """The rows of the CSV file that a link names, the header not among them; None if one is missing."""
        file, rows = link.split("#row=")
        with open(os.path.join(os.path.dirname(self.page), file), encoding="utf-8", newline="") as table:
            lines = list(csv.reader(table))
        found = []
        for part in rows.split(";"):
            first, _, last = part.partition("-")
            for row in range(int(first), int(last or first) + 1):
                if not 2 <= row <= len(lines):
                    return None
                found.append(dict(zip(lines[0], lines[row - 1])))
        return found

    def check_whole(self):
        check(f"{self.where} causes no error", not self.errors, self.errors)
        sideways = self.tab.run(scripts.SIDEWAYS)
        check(f"{self.where} does not scroll sideways", not sideways, sideways[:5])
        unseen = self.tab.run(scripts.UNSEEN)
        check(f"{self.where} shows every picture", not unseen, unseen[:5])
        check(f"{self.where} has pictures", self.tab.run(scripts.COUNT) > 10)
        return not unseen

    def check_figures(self, selector, pattern, at_least):
        figures = self.tab.run(scripts.figures(selector, pattern))
        check(f"{self.where} has figures in {selector}", len(figures) >= at_least, figures)
        for figure in figures:
            check(f"{self.where} links '{figure['text']}'", figure["link"] and self.rows_of(figure["link"]))
        return figures

    def look_at(self, box, name):
        png = self.tab.screenshot(box["x"], box["y"], box["width"], box["height"])
        with open(os.path.join(self.folder, f"{self.where} {name}.png".replace(" ", "-")), "wb") as file:
            file.write(png)
        return self.looker.run(scripts.look(base64.b64encode(png).decode()))

    def look_at_regions(self):
        seen = {}
        for name, (selector, _) in REGIONS[self.name].items():
            found = self.tab.run(scripts.boxes(selector)) if selector else [dict(x=0, y=0, width=self.width, height=self.height)]
            if selector == "figure.plot" and not found:
                continue  # without gnuplot there are no plots
            on_screen = bool(found) and 0 <= found[0]["x"] < self.width and found[0]["width"] * found[0]["height"] > 0
            check(f"{self.where} has a region {name}", on_screen)
            if on_screen:
                box = dict(found[0], width=min(found[0]["width"], self.width - found[0]["x"]))
                seen[name] = self.look_at(box, name)
        return seen

    def check_regions(self, seen, expected):
        dark = self.scheme == "dark"
        lightness = sum(seen["screen"]["paper"]) / 3
        check(f"{self.where} has {self.scheme} paper", lightness < 60 if dark else lightness > 220, lightness)
        for name, region in seen.items():
            if name not in expected:
                check(f"{self.where} {name} is expected", False)
                continue
            known, tolerance = expected[name], REGIONS[self.name][name][1]
            off = max(abs(a - b) for a, b in zip(region["mean"], known["mean"]))
            check(f"{self.where} {name} has its colour", off <= tolerance, f"{region['mean']} not {known['mean']}")
            check(f"{self.where} {name} has its ink", known["ink"] * INK_LOW <= region["ink"] <= known["ink"] * INK_HIGH,
                  f"{region['ink']:.4f} not {known['ink']:.4f}")


def check_levels(view):
    """Each picture of the first screen stands right above its time and error, which are those of its row."""
    cards = view.tab.run("""[...document.querySelectorAll('.quality figure')].map(f => {
      const box = e => e && (r => ({x: r.x, y: r.y, right: r.right, bottom: r.bottom}))(e.getBoundingClientRect());
      const link = f.querySelector('a'), image = f.querySelector('img');
      return {name: f.querySelector('b').textContent, image: box(image), figures: box(link), source: image.src,
              text: link && link.textContent, link: link && link.getAttribute('href'), option: f.querySelector('code').textContent};
    })""")
    names = [card["name"] for card in cards]
    check(f"{view.where} shows every level", names == ["draft", "low", "medium", "high", "best", "full light transport"], names)
    pictures = view.tab.run(scripts.boxes(".quality img"))
    width, height = map(int, re.search(r"(\d+) × (\d+) pixels", view.tab.run("document.body.textContent")).groups())
    times = []
    for card, box in zip(cards, pictures):
        shown = view.look_at(box, card["name"])
        own = view.looker.run(scripts.look(card["source"].split(",", 1)[1]))
        off = max(abs(a - b) for one, other in zip(shown["parts"], own["parts"]) for a, b in zip(one, other))
        check(f"{view.where} draws the picture of {card['name']}", off < 16, off)
        if card["name"] == "full light transport":
            continue
        check(f"{view.where} has linked figures for {card['name']}", card["figures"])
        if not card["figures"]:
            continue
        below = card["figures"]["y"] - card["image"]["bottom"]
        check(f"{view.where} has figures below {card['name']}", 0 <= below < 60 and
              abs(card["figures"]["x"] - card["image"]["x"]) < 8 and card["figures"]["right"] <= card["image"]["right"] + 1, card)
        check(f"{view.where} says what to set for {card['name']}", card["option"] == f"--quality {card['name']}", card["option"])
        ms, flip = map(float, re.fullmatch(r"([\d.]+) ms FLIP ([\d.]+)", card["text"]).groups())
        row = (view.rows_of(card["link"]) or [{"ns_per_pixel": "nan", "flip_rgb888": "nan"}])[0]
        exact = float(row["ns_per_pixel"]) * width * height * 1e-6
        check(f"{view.where} has the time of {card['name']} from its row", abs(ms - exact) <= 0.01 * exact, row)
        check(f"{view.where} has the error of {card['name']} from its row", abs(flip - float(row["flip_rgb888"])) <= 0.001, row)
        times.append(ms)
    check(f"{view.where} orders the levels by time", times == sorted(times), times)
    # The answer to "what do I set, what do I get" is on the first screen: all of it, or the first levels on a phone.
    first = 6 if view.width == 1200 else 2
    lowest = max((card["figures"] or card["image"])["bottom"] for card in cards[:first])
    check(f"{view.where} answers on the first screen", lowest < view.height, lowest)


def check_checks(tab, looker, folder):
    """A page with one fault of each kind: all must be seen."""
    page = os.path.join(folder, "faulty.html")
    with open(page, "w", encoding="utf-8") as file:
        file.write('<!DOCTYPE html><meta name="viewport" content="width=device-width"><title>faulty</title>'
                   '<img src="data:image/png;base64,AAAA"><img src="missing.png"><svg></svg>'
                   '<div style="width: 500px">wide</div><p>3 ms</p><script>console.error("told"); unknown();</script>')
    view = View(tab, looker, page, "faulty", 390, "light", folder)
    check("errors of the console, of scripts and of files are seen", len(view.errors) >= 3, view.errors)
    wide = tab.run(scripts.SIDEWAYS)
    check("what is too wide is seen", "DIV : wide" in wide, wide)
    check("pictures that are not decoded are seen", len(tab.run(scripts.UNSEEN)) >= 2, tab.run(scripts.UNSEEN))
    check("a figure without a link is seen", tab.run(scripts.figures("p", r"\d ms")) == [{"text": "3 ms", "link": None}])


def check_page(view, expected, write):
    if not view.check_whole():
        return  # the rest looks at pictures
    if view.name == "accuracy":
        view.check_figures(".quality, .answer", r"[\d.] ms|FLIP \d|\d per frame", 12)
        check_levels(view)
    else:
        view.check_figures(".answer, td.ours > *:not(details), .method", r"\d of|\d to|wrong|\d (ns|µs|ms)", 100)
    seen = view.look_at_regions()
    if write:
        expected[view.where] = {name: {"mean": [round(v) for v in s["mean"]], "ink": round(s["ink"], 4)} for name, s in seen.items()}
    else:
        view.check_regions(seen, expected[view.where])


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, folder, write = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), "--write" in sys.argv
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not chromium:
        print("skipped: this system has no Chromium (make pages installs it)")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    pages = {"accuracy": make_accuracy_page(program, folder), "hardcases": make_hard_page(folder)}
    file = os.path.join(here, "expected.json")
    expected = {}
    if not write:
        with open(file, encoding="utf-8") as stored:
            expected = json.load(stored)
    with Browser(chromium, folder) as browser:
        tab, looker = browser.tab(), browser.tab()
        check_checks(tab, looker, folder)
        for name, page in pages.items():
            for width in SIZES:
                for scheme in SCHEMES:
                    check_page(View(tab, looker, page, name, width, scheme, folder), expected, write)
    shutil.rmtree(os.path.join(folder, "profile"), ignore_errors=True)
    if write:
        with open(file, "w", encoding="utf-8") as stored:
            stored.write("{\n" + ",\n".join(f" {json.dumps(view)}: {{\n" + ",\n".join(
                f"  {json.dumps(name)}: {json.dumps(region)}" for name, region in regions.items()) + "}"
                for view, regions in expected.items()) + "}\n")
    if failures:
        print(f"{len(failures)} checks failed; the screenshots are in {folder}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

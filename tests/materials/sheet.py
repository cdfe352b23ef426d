"""What the sheets beside Cycles share: running programs, comparing pictures, the table and the sheet itself."""
import hashlib
import json
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
WIDTH, HEIGHT = 320, 240


def fail(text):
    sys.exit(os.path.basename(sys.argv[0]).removesuffix(".py") + ": " + text)


def add_options(parser, folder, samples, columns):
    parser.add_argument("program", help="pocketray, with importers")
    parser.add_argument("--samples", type=int, default=samples, help=f"Cycles' samples a pixel ({samples})")
    parser.add_argument("--folder", default=folder, help="where pictures go; Cycles' are kept there")
    parser.add_argument("--columns", type=int, default=columns, help=f"comparisons side by side on the sheet ({columns})")
    parser.add_argument("--colors", type=int, help="colours of the sheet's palette, for a small file; all otherwise")
    parser.add_argument("--json", metavar="FILE", help="also write the table as JSON")


def check_tools():
    for tool in ("blender", "montage"):
        if not shutil.which(tool):
            fail(f"{tool} is missing: toolchains/setup.sh contact-sheet installs it")


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    return done.returncode, done.stdout, done.stderr.strip()


def run_blender(script, *arguments, scene=None, program=None):
    """Runs a script in Blender. program: found as `pocketray` there. Returns the messages of a failure, or None."""
    path = "/usr/bin:/bin"  # where Blender looks for Python's modules
    command = ["blender", "--background", "--factory-startup", *([scene] if scene else []), "--python-exit-code", "1",
               "--python", script, "--", *arguments]
    status, output, messages = run(command, env=dict(os.environ, PATH=f"{program}:{path}" if program else path))
    return f"{messages}{output[-2000:]}" if status else None, messages + output


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def forget_others(folder, ends, scripts, *light):
    """Removes Cycles' pictures that were made by other scripts or in another light."""
    made_by = [digest(os.path.join(HERE, script)) for script in scripts] + [json.dumps(light)]
    path = os.path.join(folder, "made-by.json")
    if os.path.exists(path):
        with open(path) as file:
            if json.load(file) == made_by:
                return
    for name in os.listdir(folder):
        if name.endswith(ends):
            os.remove(os.path.join(folder, name))
    with open(path, "w") as file:
        json.dump(made_by, file)


def flip(program, reference, picture, difference=None):
    status, text, messages = run([program, "compare", reference, picture, "--json", "-",
                                  *(["-o", difference] if difference else [])])
    if status:
        fail(f"{picture}: {messages}")
    return json.loads(text)["flip"]


def warnings_in(messages, *expected):
    return [line.removeprefix("pocketray: ") for line in messages.splitlines()
            if line.startswith("pocketray: ") and not any(text in line for text in expected)]


def draw(rows, arguments, sheet):
    """Labels have two lines: the longest names fill the width of a picture."""
    labelled = []
    for row in rows:
        for label, picture in zip((row["model"], "Cycles", "ꟻLIP"), row["pictures"]):
            value = f"{row['flip']:.3f}" if label == "ꟻLIP" else " "
            labelled += ["-label", f"{label}\n{value}", picture]
    status, _, messages = run(["montage", "-font", "DejaVu-Sans", "-pointsize", "10", *labelled, "-tile",
                               f"{3 * arguments.columns}x", "-geometry", "160x120+2+2", "-alpha", "remove", "-alpha", "off",
                               sheet])
    if not status and arguments.colors:
        status, _, messages = run(["convert", sheet, "-dither", "None", "-colors", str(arguments.colors), "PNG8:" + sheet])
    if status:
        fail("montage: " + messages)
    print(f"the sheet: {sheet}")


def report(rows, names, arguments, limit):
    """Prints the table, the worst first, draws the sheet, and fails if the mean is above the limit."""
    rows = sorted((row for row in rows if row), key=lambda row: -row["flip"])
    if not rows:
        fail("nothing could be rendered by both")
    for row in rows:
        print(f"{row['flip']:.3f}  {row['model']}" + "".join("\n       " + text for text in row["warnings"]))
    mean = sum(row["flip"] for row in rows) / len(rows)
    print(f"{mean:.3f}  mean of {len(rows)}; left out: " +
          (", ".join(sorted(set(names) - {row["model"] for row in rows})) or "none"))
    draw(rows, arguments, os.path.join(os.path.abspath(arguments.folder), "sheet.png"))
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump([{key: row[key] for key in row if key != "pictures"} for row in rows], file, indent=2)
    if limit is not None and mean > limit:
        fail(f"the mean ꟻLIP is {mean:.3f}, more than {limit:g}")

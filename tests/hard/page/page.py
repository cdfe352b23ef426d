#!/usr/bin/env python3
"""page.py LINES NAMES PAGE: makes the page of the hard cases from the lines that their tests wrote (support/hard_case.h)
and the names of all tests: suite TAB name.

Every figure is measured; rows.py has only titles and pictures. The page needs no scripts and no other files; its figures
lead to their lines in a CSV file beside it.
"""
import html
import os
import re
import sys

from cases import read_cases, row_of, write_csv
from pictures import draw
from rows import ROWS, SECTIONS

STYLE = """
:root { color-scheme: light dark; --ink: #1b1d22; --soft: #62666f; --paper: #ffffff; --card: #f4f5f7; --line: #dcdfe4;
  --mark: #0063a6; --wrong: #b3261e; --right: #1a7f37; }
@media (prefers-color-scheme: dark) { :root { --ink: #e9eaed; --soft: #a2a7b1; --paper: #15171b; --card: #1e2126;
  --line: #363a42; --mark: #6cb8f0; --wrong: #ff8a80; --right: #6fd08c; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.25rem; margin: 0; padding-top: 1.6rem; }
p { margin: .4rem 0 .8rem; max-width: 46rem; }
a { color: inherit; text-decoration: underline var(--line); text-underline-offset: .2em; }
small, .soft { color: var(--soft); font-size: .85em; }
.answer { background: var(--card); border-left: 4px solid var(--mark); border-radius: 4px; padding: .7rem 1rem;
  max-width: none; font-size: 1.1rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: .92rem; }
th, td { padding: .5rem .8rem .5rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
thead th { font-weight: 500; color: var(--soft); font-size: .85rem; vertical-align: bottom; }
th[scope=rowgroup] { border: 0; padding: 0; }
td.number { color: var(--soft); width: 2.2rem; }
td.case { width: 19rem; }
td.ours { width: 17rem; }
td.case b { font-weight: 600; display: block; line-height: 1.3; }
.picture { display: block; width: 7.5rem; height: 4.5rem; background: var(--card); border-radius: 4px;
  font: 12px system-ui, sans-serif; }
.right { color: var(--right); } .wrong { color: var(--wrong); }
.method { display: grid; grid-template-columns: 1fr auto; gap: 0 .8rem; margin-bottom: .5rem; }
.method .bar { grid-column: 1 / 3; height: 4px; border-radius: 2px; background: var(--line); overflow: hidden; }
.method .bar i { display: block; height: 100%; background: var(--wrong); }
.method span:last-child { font-size: .85em; text-align: right; }
details { font-size: .85rem; color: var(--soft); } summary { cursor: pointer; }
details div { overflow-wrap: anywhere; }
@media (max-width: 48rem) {
  thead { display: none; }
  table, tbody, tr, td, th { display: block; width: auto !important; }
  td { border: 0; padding: .15rem 0; }
  tr { border-bottom: 1px solid var(--line); padding: .7rem 0; position: relative; }
  td.number { position: absolute; right: 0; top: .7rem; }
  td[data-name]::before { content: attr(data-name); display: block; color: var(--soft); font-size: .8rem; }
  td:empty { display: none; }
  td.case { padding-right: 2rem; }
}
"""


NOTES = """<p class="soft" style="padding-top: 1rem">Möller–Trumbore: the two-sided test of 1997 with an epsilon of 1e-8. Woop et al.: the
watertight test of 2013 as published; contracted: compiled with FMA, as compilers do by default where the CPU has it. Slabs, not
padded: the box test of Williams et al. 2005.</p>
"""


def grouped(count):
    return f"{count:,}".replace(",", "\u202f")


def share(wrong, inputs):
    percent = 100 * wrong / inputs
    return "0" if wrong == 0 else f"{percent:.2g} %" if percent < 10 else f"{percent:.0f} %"


def duration(seconds, inputs):
    value = 1e9 * seconds / inputs
    for unit in ("ns", "µs"):
        if value < 10000:
            return f"{value:.1f} {unit}" if value < 100 else f"{grouped(round(value))} {unit}"
        value /= 1000
    return f"{value:.1f} ms" if value < 100 else f"{grouped(round(value))} ms"


def answer_html(answer):
    return html.escape(re.sub(r"\d{4,}", lambda m: grouped(int(m[0])), answer))


class Links:
    """Links of figures to their lines in the CSV file (RFC 7111, sec. 2.1)."""

    def __init__(self, file):
        self.file = file

    def to(self, entries, text):
        lines = [entry.line for entry in entries]
        rows = f"{lines[0]}-{lines[-1]}" if len(lines) > 20 else ";".join(map(str, lines))
        return f'<a href="{html.escape(self.file)}#row={rows}">{text}</a>'


def count_text(cases, links):
    inputs, wrong = sum(c.inputs for c in cases), sum(c.wrong for c in cases)
    if inputs == 0:
        return '<span class="wrong"><b>did not run</b></span>'
    kind = "wrong" if wrong else "right"
    return links.to(cases, f'<span class="{kind}"><b>{grouped(wrong)}</b> wrong</span> of {grouped(inputs)}')


def methods_html(cases, links):
    text = ""
    beside = [b for case in cases for b in case.beside]
    several = len({b.answer for b in beside}) > 1
    for b in beside:
        what = f", {answer_html(b.answer)}" if several else ""
        width = 0 if b.wrong == 0 else max(1.0, 100 * b.wrong / b.inputs)
        text += (f'<div class="method"><span>{html.escape(b.method)}</span><span>{links.to([b], share(b.wrong, b.inputs) + " wrong")}</span>'
                 f'<span class="bar"><i style="width:{width:.1f}%"></i></span>'
                 f"<small>{links.to([b], f'{grouped(b.wrong)} of {grouped(b.inputs)}')}{what}</small>"
                 f"<span>{links.to([b], duration(b.seconds, b.inputs))}</span></div>")
    return text


def our_times_html(cases, links):
    text, seen = "", set()
    for case in cases:
        for b in case.beside:
            if (case.name, b.answer) not in seen:
                counts = f"{grouped(b.our_wrong)} wrong of {grouped(b.inputs)}"
                text += (f"<div>{links.to([b], duration(b.our_seconds, b.inputs))} <small>for a {answer_html(b.answer)}, "
                         f"{links.to([b], counts)}</small></div>")
            seen.add((case.name, b.answer))
    return text


def tests_html(cases):
    lines = "".join(f"<div>{html.escape(c.name)}: {grouped(c.wrong)} of {grouped(c.inputs)}, {html.escape(c.bound)}, "
                    f"{c.seconds:.1f} s</div>" if c.ran else
                    f'<div class="wrong">{html.escape(c.name)} did not run</div>' for c in cases)
    ran = sum(c.ran for c in cases)
    count = f"{len(cases)} test{'s' if len(cases) > 1 else ''}"
    return f"<details><summary>{count if ran == len(cases) else f'{ran} of {count} ran'}</summary>{lines}</details>"


def row_html(number, title, answer, picture, cases, links):
    methods = methods_html(cases, links)
    name = ' data-name="ordinary methods"' if methods else ""
    return (f'<tr><td class="number">{number}</td>'
            f'<td class="case"><b>{html.escape(title)}</b><span class="soft">{html.escape(answer)}</span></td>'
            f"<td>{picture}</td>"
            f'<td class="ours" data-name="ours">{count_text(cases, links)}{our_times_html(cases, links)}{tests_html(cases)}</td>'
            f"<td{name}>{methods}</td></tr>\n")


def machine():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return (html.escape(names[0]) + ", " if names else "") + f"{os.cpu_count()} threads"


def share_html(cases):
    shares = sorted({c.share for c in cases if c.ran})
    if shares == [1]:
        return "The full run"
    text = [f"{100 * s:.3g} %" for s in shares]
    return f"A run of {text[0] if len(text) == 1 else f'{text[0]} to {text[-1]}'} of the full run’s inputs, where these are many"


def missing_html(cases, suites):
    missing = [c.name for c in cases if not c.ran]
    if not missing:
        return ""
    by_suite = {}
    for name in missing:
        by_suite.setdefault(suites.get(name, ""), []).append(name)
    lists = "".join(f"<div>test_{html.escape(suite)}: {html.escape(', '.join(names))}</div>"
                    for suite, names in sorted(by_suite.items()))
    return (f'<p class="answer"><b class="wrong">{len(missing)} of {len(cases)} tests did not run</b> or did not finish; '
            f"their rows lack answers.</p>\n<details><summary>which</summary>{lists}</details>\n")


def head_html(cases, suites, links):
    inputs, wrong = sum(c.inputs for c in cases), sum(c.wrong for c in cases)
    beside = [b for c in cases for b in c.beside]
    rows = {row_of(c) for c in cases if c.ran} - {None}
    ran = sum(c.ran for c in cases)
    text = ("<h1>Hard cases</h1>\n<p>Inputs that break ordinary ray tracers: what they are, how often the program is wrong, "
            "and what ordinary methods make of equal inputs.</p>\n"
            '<p class="answer">' + links.to(cases, f'<b class="{"wrong" if wrong else "right"}">{grouped(wrong)} wrong answers</b> to '
                                            f"{grouped(inputs)} inputs"))
    if beside:
        text += "; ordinary methods gave " + links.to(beside, f'<b class="wrong">{grouped(sum(b.wrong for b in beside))}</b> to '
                                                      f"{grouped(sum(b.inputs for b in beside))}")
    text += ". " + links.to(cases, f"<b>{ran} of {len(cases)} tests</b>") + f" ran, in {len(rows)} rows.</p>\n"
    return text + missing_html(cases, suites) + (
        f'<p class="soft">{share_html(cases)}, on {machine()}, in {sum(c.seconds for c in cases):.0f} s. Times are CPU times of one '
        "thread and hold only beside each other. Inputs are aimed at the weak spots: shares of wrong answers say nothing about "
        "ordinary scenes.</p>\n")


def page_html(cases, suites, links):
    text = ('<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>Hard cases</title>\n<style>{STYLE}</style>\n</head>\n<body>\n" + head_html(cases, suites, links) +
            "<table>\n<thead><tr><th></th><th>case, right answer</th><th></th><th>ours</th><th>ordinary methods</th></tr></thead>\n")
    by_row = {}
    for case in cases:
        by_row.setdefault(row_of(case), []).append(case)
    bounds = [first for first, _ in SECTIONS[1:]] + [1000]
    for (first, name), end in zip(SECTIONS, bounds):
        numbers = sorted(n for n in by_row if n is not None and first <= n < end)
        if not numbers:
            continue
        text += f'<tbody><tr><th colspan="5" scope="rowgroup"><h2>{html.escape(name)}</h2></th></tr>\n'
        for n in numbers:
            title, answer, picture = ROWS.get(n, (f"Row {n}", "", ""))
            text += row_html(n, title, answer, draw(picture, title) if picture else "", by_row[n], links)
        text += "</tbody>\n"
    if None in by_row:
        text += '<tbody><tr><th colspan="5" scope="rowgroup"><h2>Every method against another</h2></th></tr>\n'
        for case in by_row[None]:
            title = re.sub(r"^(hard|differential)_", "", case.name).replace("_", " ")
            text += row_html("", title[0].upper() + title[1:], case.bound, "", [case], links)
        text += "</tbody>\n"
    return text + "</table>\n" + NOTES + "</body>\n</html>\n"


def main():
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    with open(sys.argv[1], encoding="utf-8") as lines, open(sys.argv[2], encoding="utf-8") as names:
        cases, suites = read_cases(lines, names)
    if not any(case.ran for case in cases):
        print("page.py: no hard case was run", file=sys.stderr)
        return 1
    table = os.path.splitext(sys.argv[3])[0] + ".csv"
    write_csv(table, cases)
    with open(sys.argv[3], "w", encoding="utf-8") as file:
        file.write(page_html(cases, suites, Links(os.path.basename(table))))
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Draws the small pictures of the rows as inline SVG.

A picture is a list of shapes separated by semicolons: l line, a arrow, t triangle, r rectangle, c circle, e ellipse,
d dot, p path, x text. "!" behind the letter draws in the accent colour. Coordinates lie in 120 × 72.
"""
import html
import math


def _points(words):
    return [tuple(float(v) for v in word.split(",")) for word in words]


def _arrow(tail, tip, color):
    length = math.hypot(tip[0] - tail[0], tip[1] - tail[1])
    x, y = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
    back = (tip[0] - 7 * x, tip[1] - 7 * y)
    head = f"{tip[0]:.1f},{tip[1]:.1f} {back[0] - 3 * y:.1f},{back[1] + 3 * x:.1f} {back[0] + 3 * y:.1f},{back[1] - 3 * x:.1f}"
    return (f'<line x1="{tail[0]:g}" y1="{tail[1]:g}" x2="{back[0]:.1f}" y2="{back[1]:.1f}"/>'
            f'<polygon points="{head}" fill="{color}"/>')


def _shape(letter, words, color):
    if letter == "x":
        x, y = _points(words[:1])[0]
        return (f'<text x="{x:g}" y="{y:g}" fill="{color}" stroke="none" text-anchor="middle">'
                f'{html.escape(" ".join(words[1:]))}</text>')
    if letter == "p":
        return f'<path d="M {html.escape(" ".join(words))}"/>'
    if letter == "c":
        (x, y), radius = _points(words[:1])[0], float(words[1])
        return f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}"/>'
    points = _points(words)
    if letter == "d":
        return f'<circle cx="{points[0][0]:g}" cy="{points[0][1]:g}" r="2.6" fill="{color}"/>'
    if letter == "e":
        (x, y), (rx, ry) = points
        return f'<ellipse cx="{x:g}" cy="{y:g}" rx="{rx:g}" ry="{ry:g}"/>'
    if letter == "r":
        (x, y), (width, height) = points
        return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}"/>'
    if letter == "a":
        return _arrow(points[0], points[1], color)
    if letter == "l":
        (x1, y1), (x2, y2) = points
        return f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}"/>'
    assert letter == "t", letter
    return '<polygon points="' + " ".join(f"{x:g},{y:g}" for x, y in points) + '"/>'


def draw(picture, title):
    shapes = []
    for text in picture.split(";"):
        letter, *words = text.split()
        color = "var(--mark)" if letter.endswith("!") else "var(--ink)"
        shapes.append(f'<g stroke="{color}">{_shape(letter[0], words, color)}</g>')
    return (f'<svg class="picture" viewBox="0 0 120 72" role="img" aria-label="{html.escape(title)}" fill="none" '
            f'stroke-width="1.6" stroke-linejoin="round">{"".join(shapes)}</svg>')

"""The pieces of a report's page: tables, figures, notes; all of it in one file that needs nothing else."""

import html
import io
import pathlib
from typing import NamedTuple

from . import drawing, files

HERE = pathlib.Path(__file__).parent
THREE = pathlib.Path("/usr/share/javascript/three")  # Debian's libjs-three
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


class Cell(NamedTuple):
    """A number in a table: as it is shown, and as it is, to the last digit."""

    shown: str
    value: float


def number(value, form=".4g", factor=1):
    """The cell of a number; a dash where it is not known."""
    return Cell("–" if value != value else format(factor * value, form), value)


def escaped(value):
    return html.escape(str(value))


def table_cell(value, classes=""):
    if isinstance(value, Cell):
        return f'<td class="number{classes}" data-value="{value.value!r}">{escaped(value.shown)}</td>'
    return f'<td class="{classes.strip()}">{escaped(value)}</td>' if classes else f"<td>{escaped(value)}</td>"


def table(name, header, rows, marked=(), unprinted=()):
    """header: [(title, unit)]; rows: lists of texts and Cells; those of the numbers `marked` are on the front; columns of
    the numbers `unprinted` are shown on the screen alone."""
    classes = [" on-screen" if k in unprinted else "" for k in range(len(header))]
    head = "".join(
        f"<th{f' class={c.strip()}' if c else ''}>{escaped(t)}{f' <small>[{escaped(u)}]</small>' if u else ''}</th>"
        for (t, u), c in zip(header, classes)
    )
    lines = [f'<div class="scroll"><table id="{escaped(name)}"><thead><tr>{head}</tr></thead><tbody>']
    for i, row in enumerate(rows):
        lines.append(f"<tr{' class=front' if i in marked else ''}>{''.join(map(table_cell, row, classes))}</tr>")
    return "\n".join([*lines, "</tbody></table></div>"])


def facts(name, pairs):
    """A table of names and texts."""
    return table(name, [("", ""), ("", "")], [list(pair) for pair in pairs])


def paragraph(text):
    return f"<p>{escaped(text)}</p>"


def note(text):
    """What a reader must not overlook."""
    return f'<p class="note">{escaped(text)}</p>'


def heading(text, name, first=False):
    return f'<h2 id="{escaped(name)}"{" class=first" if first else ""}>{escaped(text)}</h2>'


def details(title, content):
    return f"<details><summary>{escaped(title)}</summary>{content}</details>"


def preformatted(text):
    return f"<pre>{escaped(text)}</pre>"


def picture(address, caption, alternative=None):
    return (
        f'<figure><img alt="{escaped(alternative or caption)}" src="{address}">'
        f"<figcaption>{escaped(caption)}</figcaption></figure>"
    )


class Figures:
    """Writes each figure as PNG and SVG into a folder, and gives the page its picture."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.names = []

    def add(self, name, figure, caption):
        """The figure's piece of the page; "" for None. The page holds the SVG, or a much smaller PNG."""
        if figure is None:
            return ""
        images = {form: drawing.image(figure, form) for form in ("svg", "png")}
        drawing.plt.close(figure)
        for form, content in images.items():
            files.write(self.folder / f"{name}.{form}", content)
        self.names.append(name)
        if len(images["svg"]) <= 2 * len(images["png"]):
            return picture(drawing.data_address(images["svg"], "svg+xml"), caption)
        return picture(drawing.data_address(images["png"], "png"), caption)


def frames(paths, width=480):
    """Images of a run, made smaller."""
    from PIL import Image

    pieces = []
    for path in paths:
        with Image.open(path) as image:
            small = image.convert("RGB")
            small.thumbnail((width, width))
        stream = io.BytesIO()
        small.save(stream, "JPEG", quality=80)
        pieces.append(picture(drawing.data_address(stream.getvalue(), "jpeg"), path.stem, f"frame {path.stem}"))
    return f'<div class="frames">{"".join(pieces)}</div>'


def viewer(name):
    """The place of a surface that is turned by hand; its data stand in the script element of that name."""
    return f"""<div class="viewer" data-source="{escaped(name)}"><div class="canvas"></div><div class="bar">
<button class="play" type="button">Play</button><input type="range" min="0" value="0" aria-label="frame">
<output></output><button class="home" type="button">First view</button></div></div>"""


def data_element(name, json_text):
    """JSON inside the page; a '<' in it must not end the element."""
    return f'<script type="application/json" id="{escaped(name)}">{json_text.replace("<", chr(92) + "u003c")}</script>'


def three_is_there():
    return (THREE / "three.min.js").is_file() and (THREE / "examples/js/controls/OrbitControls.js").is_file()


def scripts(with_viewers):
    """The page's scripts, three.js with its licence before them."""
    texts = [(HERE / "viewer.js").read_text()]
    licence = ""
    if with_viewers:
        library = [THREE / "three.min.js", THREE / "examples/js/controls/OrbitControls.js"]
        texts = [path.read_text() for path in library] + texts
        licence = f"<!--\n{(HERE / 'three.LICENSE').read_text()}-->\n"
    return licence + "\n".join(
        f"<script>{text.replace('</script', '<' + chr(92) + '/script')}</script>" for text in texts
    )


def whole(title, contents, body, with_viewers):
    """The page. contents: [(text, name)] of its parts."""
    links = "".join(f'<li><a href="#{escaped(name)}">{escaped(text)}</a></li>' for text, name in contents)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<title>{escaped(title)}</title><style>{(HERE / "report.css").read_text()}</style></head><body>
<header><h1>{escaped(title)}</h1></header><nav><ul>{links}</ul></nav>
{body}
{scripts(with_viewers)}
</body></html>
"""

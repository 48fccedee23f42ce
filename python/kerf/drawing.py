"""How figures look: colours that the colour-blind tell apart, markers and dashes for print, files for a paper."""

import base64
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# Okabe and Ito without their yellow, which is too light for lines; then the same with other markers and dashes.
COLOURS = ["#000000", "#E69F00", "#0072B2", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "<", ">", "p", "h"]
DASHES = ["-", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2)), (0, (3, 1, 1, 1, 1, 1))]
FILLS = ["#E69F00", "#0072B2", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#999999", "#F0E442", "#444444"]
HATCHES = ["", "//", "\\\\", "xx", "--", "", "||", "++", ""]

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.titlesize": 9,
        "axes.grid": True,
        "grid.color": "#dddddd",
        "grid.linewidth": 0.6,
        "axes.axisbelow": True,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "legend.frameon": False,
        "legend.fontsize": 8,
        "lines.linewidth": 1.3,
        "lines.markersize": 5,
        "hatch.linewidth": 0.5,
        "svg.hashsalt": "kerf",
        "svg.fonttype": "path",
        "figure.max_open_warning": 0,
    }
)


def look(index):
    """Colour, marker and dashes of the line of that number: no two of the first 385 are alike."""
    return {
        "color": COLOURS[index % len(COLOURS)],
        "marker": MARKERS[index % len(MARKERS)],
        "linestyle": DASHES[index % len(DASHES)],
    }


STAGES = [
    "set-up",
    "cut",
    "topology",
    "assemble",
    "visibility",
    "solve",
    "surface",
    "colour",
    "output",
    "images",
    "stepping",
]


def fill(stage):
    """Colour and hatch of the bars of a stage, the same in all figures."""
    i = STAGES.index(stage) % len(FILLS) if stage in STAGES else len(FILLS) - 1
    return {"color": FILLS[i], "hatch": HATCHES[i], "edgecolor": "white", "linewidth": 0.3}


def panels(n, n_columns=2, width=3.5, height=2.5):
    """A figure of n panels, in rows of at most n_columns; sizes of a panel in inches. Returns figure and axes."""
    n_columns = min(n, n_columns)
    n_rows = -(-n // n_columns)
    figure, grid = plt.subplots(n_rows, n_columns, figsize=(width * n_columns, height * n_rows), squeeze=False)
    axes = list(grid.flat)
    for spare in axes[n:]:
        spare.set_axis_off()
    return figure, axes[:n]


def legend_beside(figure, axes):
    """One legend for all panels, below them, of the labels in the order in which they come."""
    entries = {}
    for one in axes:
        for handle, label in zip(*one.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    longest = max((len(label) for label in entries), default=0)
    n_columns = max(1, min(len(entries), int(figure.get_figwidth() / (0.75 + 0.068 * longest))))
    rows = -(-len(entries) // n_columns)
    height = figure.get_figheight()
    below = 0.17 * rows + 0.1  # inches
    figure.set_figheight(height + below)
    figure.legend(entries.values(), entries.keys(), ncol=n_columns, loc="lower center", handlelength=3)
    figure.tight_layout(rect=(0, below / figure.get_figheight(), 1, 1))


def image(figure, form):
    """The figure as bytes: form "png" or "svg", the same for the same figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format=form, dpi=150, metadata={"Date": None} if form == "svg" else None)
    return stream.getvalue()


def data_address(content, kind):
    """Bytes as an address that a page carries in itself."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"

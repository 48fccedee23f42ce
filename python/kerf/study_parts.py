"""What a report says of a study: table, front, figures, notes."""

import pathlib

from . import page, stability_figures, studies, study_figures

# Column -> (title, unit in the table, factor, format); columns that are not named follow as they are.
SHOWN = {
    "name": ("row", "", 1, ""),
    "error": ("error", "%", 100, "+.2f"),
    "order": ("order", "1", 1, ".2f"),
    "setup_cpu_time": ("set-up CPU", "s", 1, ".3f"),
    "cpu_time": ("steps CPU", "s", 1, ".3g"),
    "setup_time": ("set-up", "s", 1, ".3f"),
    "stepping_time": ("stepping", "s", 1, ".2f"),
    "peak_memory": ("memory", "MB", 1e-6, ".0f"),
    "h": ("h", "m", 1, ".4g"),
    "dt": ("dt", "s", 1, ".4g"),
    "dof": ("dof", "1", 1, "d"),
    "value": ("value", None, 1, ".5g"),
    "reference": ("reference", None, 1, ".5g"),
    "steps": ("steps", "1", 1, "d"),
    "iterations": ("iterations", "1", 1, "d"),
    "backend": ("backend", "", 1, ""),
    "integrator": ("integrator", "", 1, ""),
    "outcome": ("outcome", "", 1, ""),
}
ASIDE = ("family", "changes", "reference_source")
# Besides all errors; more would not fit on a page.
PRINTED = ("name", "error", "order", "setup_cpu_time", "cpu_time", "peak_memory", "h", "dof", "value", "iterations")


def table_of(study, name, marked):
    """All rows."""
    others = [n for n in study.columns if n not in SHOWN and n not in ASIDE]
    last = [n for n in ("outcome",) if n in study.columns]
    names = [n for n in SHOWN if n in study.columns and n not in last] + others + last
    formats = {n: SHOWN.get(n, (n.replace("_", " "), None, 1, ".4g")) for n in names}
    units = {n: study.columns[n].unit if formats[n][1] is None else formats[n][1] for n in names}
    rows = [[shown(study.columns[n].values[i], *formats[n][2:]) for n in names] for i in range(study.n_rows)]
    unprinted = [k for k, n in enumerate(names) if n not in PRINTED and not n.startswith("error")]
    return page.table(name, [(formats[n][0], units[n]) for n in names], rows, marked, unprinted)


def cpu_time_of(row):
    """Of set-up and steps [s]."""
    return row["setup_cpu_time"] + row["cpu_time"]


def shown(value, factor, form):
    if isinstance(value, str):
        return value
    return page.Cell(str(value), int(value)) if form == "d" else page.number(float(value), form or ".4g", factor)


def references(study):
    """Where they come from, each with the rows that have it."""
    found = {}
    for name, source in zip(study.columns["name"].values, study.columns["reference_source"].values):
        found.setdefault(source or "no reference", []).append(name)
    return [(source, "all rows" if len(found) == 1 else ", ".join(names)) for source, names in found.items()]


def notes(study):
    """Failures, ends that are none, what cannot be drawn."""
    lines = []
    if study.outcome != "completed":
        lines.append(f"The study's outcome is '{study.outcome}': it has the {study.n_rows} rows so far.")
    bad = studies.failed(study)
    if bad:
        lines.append(f"{len(bad)} of {study.n_rows} rows failed and are in no figure:")
        lines += [f"{study.columns['name'].values[i]}: {study.columns['outcome'].values[i]}" for i in bad]
    if not studies.norms(study):
        lines.append("No row has an error: the study has no reference, or nothing completed. Errors are not drawn.")
    return "".join(page.note(line) for line in lines)


def front_in_words(study, norm):
    """The front from the fastest to the most accurate."""
    members = studies.fronts(study, norm)
    rows = [study.row(i) for i in members]
    if studies.has_families(study):
        rows.sort(key=cpu_time_of)
    texts = [f"{r['name']} ({cpu_time_of(r):.3g} s, {100 * abs(r[norm]):.3g} %)" for r in rows]
    return "On the Pareto front, where no other row is both faster and closer: " + "; ".join(texts) + "."


def orders_table(study, norm, name):
    fits = studies.orders(study, norm)
    rows = [[method, page.number(order, ".2f")] for method, (order, _) in fits.items()]
    return page.table(f"{name}-{norm}-orders", [("method", ""), ("fitted order", "1")], rows) if rows else ""


def norm_parts(study, norm, name, figures):
    """Figures of one norm."""
    title = norm.replace("_", " ")
    together = "" if len(studies.problems(study)) == 1 else " Rows are of different problems, so there is a front for each."
    by_time = []
    if studies.has_times(study):
        by_time = [
            figures.add(
                f"{name}_{norm}_time",
                study_figures.error_against_time([study], [name], norm),
                f"{study.title}: {title} against CPU time of set-up and all steps. Rings: the Pareto front.{together}",
            ),
            page.paragraph(front_in_words(study, norm)),
        ]
    return by_time + [
        figures.add(
            f"{name}_{norm}_h",
            study_figures.error_against_h(study, norm),
            f"{study.title}: {title} against the edge of the grid's cubes; orders are least squares of the logarithms.",
        ),
        orders_table(study, norm, name),
    ]


def study_part(study, name, figures):
    """The part of a study."""
    norms = studies.norms(study)
    marked = studies.fronts(study, norms[0]) if norms else []
    pieces = [
        page.heading(f"Study {name}: {study.title}", name),
        page.paragraph(f"Value: {study.answer}."),
        notes(study),
    ]
    for norm in norms:
        pieces += norm_parts(study, norm, name, figures)
    if studies.has_times(study):
        caption = f"{study.title}: where each row's wall-clock time went."
        pieces.append(figures.add(f"{name}_stages", study_figures.time_per_stage(study), caption))
    pieces.append(table_of(study, f"{name}-rows", marked))
    pieces.append(page.table(f"{name}-references", [("reference", ""), ("rows", "")], references(study)))
    return "\n".join(pieces + background(study, name))


def background(study, name):
    """The study as written, what its rows change, and where it comes from."""
    changes = list(zip(*(study.columns[c].values for c in ("name", "changes"))) if "name" in study.columns else [])
    return [
        page.details("The study as written", page.preformatted(study.text)),
        page.details("What each row changes", page.facts(f"{name}-changes", changes)) if changes else "",
        page.details(
            "Provenance",
            page.facts(f"{name}-info", [("file", pathlib.Path(study.path).resolve()), *study.info.items()]),
        ),
    ]


def stability_part(study, name, figures):
    """The part of a study of stability: maps, counts, reasons."""
    rows = stability_figures.rows_of(study)
    pieces = [page.heading(f"Stability {name}: {study.title}", name)]
    if study.outcome != "completed":
        pieces.append(page.note(f"The study's outcome is '{study.outcome}': it has the {study.n_rows} rows so far."))
    for backend in stability_figures.unique(row["backend"] for row in rows):
        caption = f"{study.title}: {backend}. A panel is a variant in a sweep, a cell a run."
        pieces.append(figures.add(f"{name}_{backend}", stability_figures.stability_map(backend, rows), caption))
    header = [("sweep", ""), ("variant", ""), *((outcome, "") for outcome in stability_figures.OUTCOMES)]
    lines = [
        [sweep, variant, *(page.Cell(str(n), n) for n in found.values())]
        for sweep, variant, found in stability_figures.counts(study)
    ]
    pieces.append(page.table(f"{name}-counts", header, lines))
    bad = [r for r in map(study.row, range(study.n_rows)) if r["outcome"] in ("refused", "stopped", "failed")]
    reasons = [[f"{r['sweep']}, {r['variant']}, {r['cases']}", r["outcome"], r["reason"]] for r in bad]
    if reasons:
        reasons_table = page.table(f"{name}-reasons", [("run", ""), ("outcome", ""), ("reason", "")], reasons)
        pieces.append(page.details(f"{len(bad)} runs that were refused, stopped or failed", reasons_table))
    return "\n".join(pieces + background(study, name))

"""Documents as tables: HTML for notebooks, as in the report, and rows for pandas."""

from __future__ import annotations

import functools
import html
import math
import re
import textwrap
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mbk import _mbk

NORMAL95 = 1.959963984540054
MATRICES = (("M", "inertia"), ("B", "damping"), ("K", "stiffness"))
UNITS = {"M": "kg or kg·m²", "B": "N·s/m or N·m·s/rad", "K": "N/m or N·m/rad", "x0": "m or rad", "force": "N or N·m"}
METHODS = {"ls": "least squares", "iv": "instrumental variables"}

# ---- numbers for people


def minus(text: str) -> str:
    return text.replace("-", "−")


def fixed(value: float | None, decimals: int) -> str:
    if value is None or math.isnan(value):
        return "undefined"
    return minus(f"{value + 0.0:.{min(max(decimals, 0), 12)}f}")


def significant(value: float | None, digits: int = 3) -> str:
    if value is None or math.isnan(value):
        return "undefined"
    if value == 0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if magnitude < -4 or magnitude > 6:
        return minus(f"{value:.{digits - 1}e}")
    return fixed(value, digits - 1 - magnitude)


def unit_as_read(unit: str) -> str:
    """For people: "N·m", "m/s²" for "N.m", "m/s2" in a recording."""
    return re.sub(r"(?<=[a-z])2$", "²", unit.replace(".", "·"))


def with_half_width(value: float | None, error: float | None, scale: float = 1.0) -> str:
    """34 ± 15, where ± is half of the 95 % interval."""
    if value is None or error is None:
        return significant(None if value is None else scale * value, 4)
    half = scale * NORMAL95 * error
    decimals = min(max(1 - math.floor(math.log10(half)), 0), 9) if half > 0 else 3
    return f"{fixed(scale * value, decimals)} ± {fixed(half, decimals)}"


def with_interval(value: float | None, interval: list[float | None], decimals: int) -> str:
    low, high = interval
    if low is None or high is None:
        return fixed(value, decimals)
    return f"{fixed(value, decimals)} [{fixed(low, decimals)}, {fixed(high, decimals)}]"


# ---- rows for pandas


def axis_names(axes: int) -> list[str]:
    return [""] if axes == 1 else ["x", "y", "z"][:axes]


def named(symbol: str, *axes: str) -> str:
    return symbol + ("_" + "".join(axes) if any(axes) else "")


def number(value: float | None) -> float:
    return math.nan if value is None else value


def parameters(result: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each parameter of a result."""
    rows = []
    names = axis_names(result["axes"])
    units = result.get("units", UNITS)

    def row(name: str, value: float | None, error: float | None, unit: str) -> None:
        value, error = number(value), number(error)
        rows.append({"parameter": name, "value": value, "standard_error": error, "low95": value - NORMAL95 * error,
                     "high95": value + NORMAL95 * error, "unit": unit})

    for symbol, _ in MATRICES:
        for i, first in enumerate(names):
            for j, second in enumerate(names):
                row(named(symbol, first, second), result["model"][symbol][i][j], result["standard_error"][symbol][i][j],
                    units[symbol])
    for i, first in enumerate(names):
        row(named("x0", first), result["model"]["x0"][i], result["standard_error"]["x0"][i], units["x0"])
    return rows


def one_row(result: dict[str, Any]) -> dict[str, Any]:
    """A result as one row of a table."""
    row: dict[str, Any] = {
        "file": ", ".join(one["file"] for one in result["inputs"]),
        "trial": ", ".join(one["trial"] for one in result["inputs"] if "trial" in one),
        "usable": result["usable"], "method": result["method"], "protocol": result.get("protocol"),
        "warnings": ", ".join(one["code"] for one in result["warnings"])}
    for one in parameters(result):
        row[one["parameter"]] = one["value"]
        row[one["parameter"] + "_se"] = one["standard_error"]
    for name, value in zip(axis_names(result["axes"]), result["fit"]["VAF"]):
        row[named("VAF", name)] = number(value)
    for matrix, ellipse in result.get("ellipses", {}).items():
        for field in ("area", "shape", "orientation_deg"):
            row[f"{matrix}_{field}"] = number(ellipse[field])
    for matrix, ellipsoid in result.get("ellipsoids", {}).items():
        for field in ("volume", "shape"):
            row[f"{matrix}_{field}"] = number(ellipsoid[field])
        for k, one in enumerate(ellipsoid["principal"]):
            row[f"{matrix}_principal_{k + 1}"] = number(one["value"])
    return row


def ellipse_rows(document: dict[str, Any]) -> list[dict[str, Any]]:
    documents = document.get("results", [document])
    rows = []
    for one in documents:
        for matrix, ellipse in one["ellipses"].items():
            row: dict[str, Any] = {"matrix": matrix}
            if len(documents) > 1:
                row["file"] = ", ".join(source["file"] for source in one["inputs"])
            for field in ("area", "shape", "orientation_deg"):
                row[field] = number(ellipse[field])
                row[f"{field}_low95"], row[f"{field}_high95"] = map(number, ellipse["interval95"][field])
            rows.append(row)
    return rows


def widths(comparison: dict[str, Any]) -> list[dict[str, Any]]:
    rows = []
    for _, name in MATRICES:
        width = comparison["width"].get(name)
        row: dict[str, Any] = {"matrix": name, "distance": math.nan, "low95": math.nan, "high95": math.nan,
                               "distinguishable": None, "why_not": comparison["refused"].get(name, "")}
        if width:
            row["distance"], row["distinguishable"] = number(width["distance"]), width["distinguishable"]
            row["low95"], row["high95"] = map(number, width["interval95"])
        rows.append(row)
    return rows


def coefficients(found: dict[str, Any]) -> list[dict[str, Any]]:
    return [{"parameter": one["name"], "value": number(one["value"]), "standard_error": number(one["standard_error"]),
             "low95": number(one["value"]) - NORMAL95 * number(one["standard_error"]),
             "high95": number(one["value"]) + NORMAL95 * number(one["standard_error"])} for one in found["parameters"]]


def frequency_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    response = found.get("frequency_response")
    if response is None:
        return rows
    for one in response["responses"]:
        for k, frequency in enumerate(response["frequency_hz"]):
            rows.append({
                "input": one["input"], "output": one["output"], "frequency_hz": frequency,
                "magnitude": number(one["magnitude"][k]), "phase_deg": number(one["phase_deg"][k]),
                "magnitude_low95": number(one["magnitude_interval95"][0][k]),
                "magnitude_high95": number(one["magnitude_interval95"][1][k]),
                "partial_coherence": number(one["partial_coherence"][k]) if "partial_coherence" in one else math.nan})
    return rows


def validation_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    rows = []
    for one in found["rows"]:
        row = {**one, "unit": one.get("unit", found["unit"]), "value": number(one["value"])}
        for key, low, high in (("interval95", "low95", "high95"), ("expected", "expected_low", "expected_high")):
            ends = row.pop(key, None) or (None, None)
            row[low], row[high] = map(number, ends)
        rows.append(row)
    return rows


def study_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    """Numbers and texts of each recording; lists are omitted."""
    return [{name: value for name, value in one.items() if not isinstance(value, (dict, list))}
            for one in found["recordings"]]


def reliability_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    """Reliability of each outcome between sessions."""
    rows = []
    for one in found.get("reliability", []):
        between = one.get("between_sessions", {})
        icc: dict[str, Any] = next((one for one in between.get("icc", [])
                                    if one["form"] == "agreement" and one["averaged"] == 1), {})
        error: dict[str, Any] = next((one for one in between.get("error", []) if one["form"] == "agreement"), {})
        low, high = icc.get("interval95", (None, None))
        rows.append({
            "condition": one["condition"], "outcome": one["outcome"], "unit": one["unit"],
            "participants": between.get("participants", one["participants"]),
            "sessions": len(between.get("sessions", [])), "support": between.get("support"),
            "ICC": number(icc.get("value")), "ICC_low95": number(low), "ICC_high95": number(high),
            "SEM": number(error.get("sem")), "MDC95": number(error.get("mdc95")),
            "warnings": ", ".join(one.get("warnings", []))})
    return rows


def passivity_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    rows = []
    for one in found.get("results", [found]):
        passivity = one["passivity"]
        trial, prediction, excess = passivity.get("trial"), passivity.get("prediction"), passivity.get("eop", {})
        low, high = trial["interval95"] if trial else (None, None)
        excess_low, excess_high = excess.get("interval95") or (None, None)
        rows.append({
            "file": names_of(one), "verdict": trial["verdict"] if trial else None,
            "absorbed_J": number(trial["absorbed_J"] if trial else None), "low95": number(low), "high95": number(high),
            "predicted": prediction["verdict"] if prediction else None, "min_index": number(passivity.get("min_index")),
            "excess": number(excess.get("corrected")), "excess_low95": number(excess_low),
            "excess_high95": number(excess_high)})
    return rows


def channel_rows(found: dict[str, Any]) -> list[dict[str, Any]]:
    """A row for each channel of each recording."""
    if "results" not in found:
        return list(found.get("channels", []))
    return [{"file": names_of(one), **channel} for one in found["results"] for channel in one.get("channels", [])]


def flat(values: dict[str, Any]) -> list[dict[str, Any]]:
    """The first list of objects in a document; if there is none, its numbers and texts."""
    for name, value in values.items():
        if objects(value) and name != "inputs":
            return [dict(leaves(one)) for one in value]
    return [{name: value for name, value in leaves(values) if not isinstance(value, list)}]


# ---- HTML


def escaped(text: object) -> str:
    return html.escape(str(text))


def for_python(text: str) -> str:
    """Escaped, with options and commands as in Python."""
    return escaped(_mbk.in_python(text))


def table(caption: str, head: list[str], rows: list[list[str]], align: str = "right") -> str:
    """A table whose first column names its rows."""
    style = f" style='text-align:{align}'"
    body = "".join(
        "<tr>" + "".join(f"<th style='text-align:left'>{escaped(one)}</th>" if k == 0 else f"<td{style}>{escaped(one)}</td>"
                         for k, one in enumerate(row)) + "</tr>" for row in rows)
    heads = f"<thead><tr>{''.join(f'<th{style}>{escaped(one)}</th>' for one in head)}</tr></thead>" if head else ""
    return (f"<table><caption style='text-align:left;white-space:nowrap'>{escaped(caption)}</caption>"
            f"{heads}<tbody>{body}</tbody></table>")


def warning_list(warnings: list[dict[str, Any]]) -> str:
    if not warnings:
        return ""
    items = "".join(f"<li><code>{escaped(one['code'])}</code>: {for_python(one['message'])}. <strong>Try:</strong> "
                    f"{for_python(one['try'])}.</li>" for one in warnings)
    return f"<p><strong>Warnings</strong></p><ul>{items}</ul>"


def verdict(document: dict[str, Any]) -> str:
    warnings = document.get("warnings", [])
    codes = ", ".join(one["code"] for one in warnings)
    if not document["usable"]:
        return f"<p><strong>✕ Not usable.</strong> Do not report these numbers: {escaped(codes or 'see the warnings')}.</p>"
    if warnings:
        return f"<p><strong>! Usable with care.</strong> Read the warnings first: {escaped(codes)}.</p>"
    return "<p><strong>✓ Usable.</strong></p>"


def per_axis(values: list[float | None], decimals: int, unit: str) -> str:
    names = axis_names(len(values)) if len(values) < 4 else [str(k) for k in range(len(values))]
    return ", ".join(f"{name} {fixed(value, decimals)} {unit}".strip() for name, value in zip(names, values))


def model_rows(model: dict[str, Any], error: dict[str, Any], units: dict[str, str]) -> list[list[str]]:
    """A row for each matrix and one for the equilibrium: name, values ± 95 %, unit. In space, three rows each."""
    names = axis_names(len(model["x0"]))
    if len(names) == 3:
        rows = [[f"{name} {symbol}" if i == 0 else "", first,
                 *(with_half_width(model[symbol][i][j], error[symbol][i][j]) for j in range(3)),
                 units[symbol] if i == 0 else ""] for symbol, name in MATRICES for i, first in enumerate(names)]
        return [*rows, ["equilibrium x₀", "", *(with_half_width(model["x0"][k], error["x0"][k], 1000.0)
                                               for k in range(3)), "mm"]]
    pairs = [(i, j) for i in range(len(names)) for j in range(len(names))]
    rows = [[f"{name} {symbol}", *(with_half_width(model[symbol][i][j], error[symbol][i][j]) for i, j in pairs),
             units[symbol]] for symbol, name in MATRICES]
    scale = 1000.0 if units["x0"] == "m" else 1.0
    rows.append(["equilibrium x₀",
                 *(f"{name} {with_half_width(model['x0'][k], error['x0'][k], scale)}".strip()
                   for k, name in enumerate(names)),
                 *([""] * (len(pairs) - len(names))), "mm" if scale == 1000.0 else units["x0"]])
    return rows


def result_html(result: dict[str, Any], heading: bool = True) -> str:
    """The tables of the report."""
    axes, fit = result["axes"], result["fit"]
    units = result.get("units", UNITS)
    files = ", ".join(f"{one['file'] or 'arrays'} ({one['duration_s']:.4g} s at {one['rate_hz']:.5g} Hz)"
                      for one in result["inputs"] if one["duration_s"] and one["rate_hz"])
    out = [f"<p><strong>Impedance</strong>: {escaped(files)}; {escaped(METHODS[result['method']])}, "
           f"{escaped(result.get('protocol', 'unknown'))} protocol</p>"] if heading else []
    out.append(verdict(result))
    if result["usable"]:
        out.append(table("Inertia, damping, stiffness and equilibrium; ± is half of the 95 % interval",
                         {1: ["", "value ± 95 %", "unit"], 2: ["", "xx", "xy", "yx", "yy", "unit"],
                          3: ["", "", "x", "y", "z", "unit"]}[axes],
                         model_rows(result["model"], result["standard_error"], units)))
    where = "held-out data" if fit["validated_on"] == "held-out" else "the same data"
    out.append(table("Goodness of fit", ["", "value"], [
        [f"VAF on {where}", per_axis(fit["VAF"], 2, "%")],
        ["VAF in sample", per_axis(fit["VAF_in_sample"], 2, "%")],
        [f"RMSE on {where}", per_axis(fit["RMSE"], 3, units["force"])]]))
    if "ellipses" in result and result["usable"]:
        out.append(ellipses_html(result, units))
    if "ellipsoids" in result and result["usable"]:
        out.append(ellipsoids_html(result, units))
    if "joint_domain" in result and result["usable"]:
        out.append(joint_html(result["joint_domain"]))
    if "passivity" in result:
        out.append(passivity_html(result["passivity"]))
    out.append(warning_list(result["warnings"]))
    return "".join(out)


def ellipses_html(result: dict[str, Any], units: dict[str, str]) -> str:
    rows = []
    for symbol, name in MATRICES:
        one = result["ellipses"][name]
        anti = result.get("antisymmetry", {}).get(name)
        area = one["area"]
        rows.append([
            f"{name} {symbol}",
            "none" if area is None else f"{with_interval(area, one['interval95']['area'], 2 if area < 100 else 0)} "
                                        f"({units[symbol]})²",
            "none" if one["shape"] is None else with_interval(one["shape"], one["interval95"]["shape"], 2),
            "undefined" if one["orientation_deg"] is None else
            with_interval(one["orientation_deg"], one["interval95"]["orientation_deg"], 1) + "°",
            f"{significant(one['eigenvalues'][1])} and {significant(one['eigenvalues'][0])} {units[symbol]}",
            "" if not anti else "undefined" if anti["zmean_percent"] is None else
            with_interval(anti["zmean_percent"], anti["interval95"], 1) + " %"])
    return table("Ellipses in numbers; brackets are 95 % intervals",
                 ["", "area", "shape", "orientation", "semi-axes", "antisymmetry"], rows)


def ellipsoids_html(result: dict[str, Any], units: dict[str, str]) -> str:
    rows = []
    for symbol, name in MATRICES:
        for k, one in enumerate(result["ellipsoids"][name]["principal"]):
            half = one["half_angle95_deg"]
            rows.append([f"{name} {symbol}" if k == 0 else "", with_interval(one["value"], one["value95"], 2),
                         "[" + ", ".join(fixed(value, 2) for value in one["direction"]) + "]",
                         "any direction" if half is not None and half >= 90.0 else f"± {fixed(half, 1)}°", units[symbol]])
    return table("Principal values and axes; brackets are 95 % intervals",
                 ["", "value", "axis", "cone", "unit"], rows)


def joint_html(joints: dict[str, Any]) -> str:
    pairs = [(0, 0), (0, 1), (1, 0), (1, 1)]
    rows = [[f"{name} {symbol}", *(with_half_width(joints["model"][symbol][i][j], joints["standard_error"][symbol][i][j])
                                   for i, j in pairs), joints["units"][symbol]] for symbol, name in MATRICES]
    return table(f"At the joints of the {joints['of']}; ± is half of the 95 % interval",
                 ["", *(f"{i + 1}{j + 1}" for i, j in pairs), "unit"], rows)


def names_of(document: dict[str, Any]) -> str:
    """The input files of a document."""
    return ", ".join(one["file"] or "arrays" for one in document["inputs"])


def passivity_html(passivity: dict[str, Any], of_what: str = "the limb") -> str:
    rows = []
    for key, title in (("trial", "during the trial"), ("prediction", "predicted by the model")):
        one = passivity.get(key)
        if one:
            rows.append([title, one["verdict"], one.get("statement", "")])
    return table(f"Is {of_what} passive?", ["", "verdict", "statement"], rows)


def results_rows(found: dict[str, Any]) -> list[list[str]]:
    """A heading, and a row for each recording: file, usable, diagonal of M, B and K ± 95 %."""
    rows: list[list[str]] = [["recording", "usable"]]
    for result in found["results"]:
        units, names = result.get("units", UNITS), axis_names(result["axes"])
        diagonal = [(symbol, k, named(symbol, name, name)) for symbol, _ in MATRICES for k, name in enumerate(names)]
        rows[0] = ["recording", "usable", *(f"{name} [{units[symbol]}]" for symbol, _, name in diagonal)]
        rows.append([names_of(result), "yes" if result["usable"] else "no",
                     *(with_half_width(result["model"][symbol][k][k], result["standard_error"][symbol][k][k])
                       if result["usable"] else "" for symbol, k, _ in diagonal)])
    return rows


def results_html(found: dict[str, Any]) -> str:
    head, *rows = results_rows(found)
    out = [f"<p><strong>Impedance of {len(found['results'])} recordings</strong></p>",
           table("Diagonal entries; ± is half of the 95 % interval", head, rows)]
    for one in found.get("failed", []):
        out.append(f"<p>{escaped(one['file'])}: {for_python(one['message'])}; {for_python(one['try'])}</p>")
    if "no_summary" in found:
        out.append(f"<p>No mean: {for_python(found['no_summary'])}.</p>")
    return "".join(out)


def transfer_function_html(found: dict[str, Any]) -> str:
    rows = [[one["name"], with_half_width(one["value"], one["standard_error"])] for one in found["parameters"]]
    poles = [[f"pole {k + 1}", f"{significant(one['frequency_hz'])} Hz", f"damping {significant(one['damping'])}"]
             for k, one in enumerate(found["poles"]) if one.get("frequency_hz") is not None]
    return "".join([
        f"<p><strong>Transfer function</strong> from {escaped(found['input']['name'])} to "
        f"{escaped(found['output']['name'])}, {escaped(found['method'])}, delay {found['delay_s']:.4g} s</p>",
        verdict(found), table("Coefficients; ± is half of the 95 % interval", ["", "value"], rows),
        table("Poles", [], poles) if poles else "", warning_list(found["warnings"])])


def teleoperation_html(found: dict[str, Any]) -> str:
    rows = [["every passive hand and environment", found["llewellyn"]["verdict"]]]
    if "modified_llewellyn" in found:
        rows.append([f"this operator (excess {significant(-found['operator']['a'])} N·s/m)",
                     found["modified_llewellyn"]["verdict"]])
    limits = [[f"port {one['port']}", significant(one["a"])] for one in found["largest_a"]]
    return (f"<p><strong>{escaped(found['name'])}</strong>: {escaped(found['kind'])}, decided {escaped(found['decided'])}</p>"
            + table("Absolutely stable with", ["", "verdict"], rows)
            + table("Largest permitted shortage of passivity of a termination [N·s/m]", ["", "a ≤"], limits))


def validation_html(found: dict[str, Any]) -> str:
    rows = []
    for one in validation_rows(found):
        expected = "" if math.isnan(one["expected_low"]) and math.isnan(one["expected_high"]) else \
            f"{significant(one['expected_low'])} to {significant(one['expected_high'])}"
        rows.append([one["what"], significant(one["value"]), f"{significant(one['low95'])} to {significant(one['high95'])}",
                     expected, one["unit"], str(one["verdict"] or "")])
    return (f"<p><strong>{escaped(found['study'])}</strong>: {escaped(found['question'])} ({found['runs']} runs, seed "
            f"{found['seed']}): {escaped(found['verdict'])}</p>"
            + table("", ["", "value", "95 %", "expected", "unit", "verdict"], rows))


# ---- text, as the command prints it

LINE = 100


def text_table(rows: list[list[str]]) -> str:
    """Left-aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    return "".join("  " + "  ".join(one.ljust(width) for one, width in zip(row, widths)).rstrip() + "\n" for row in rows)


def paragraph(first: str, text: str) -> str:
    return textwrap.fill(_mbk.in_python(text), LINE, initial_indent=first, subsequent_indent=" " * len(first),
                         break_long_words=False, break_on_hyphens=False) + "\n"


def model_text(model: dict[str, Any], error: dict[str, Any], units: dict[str, str]) -> str:
    head = {2: [["", "xx", "xy", "yx", "yy", ""]], 3: [["", "", "x", "y", "z", ""]]}.get(len(model["x0"]), [])
    return text_table(head + model_rows(model, error, units)).replace("−", "-")  # so that a number can be copied


def result_text(result: dict[str, Any]) -> str:
    """The inputs, the model if it is usable, the fit and the warnings."""
    units, fit = result.get("units", UNITS), result["fit"]
    text = "".join(f"{one['file'] or 'arrays'}   {one['duration_s'] or 0:.1f} s at {one['rate_hz'] or 0:.6g} Hz\n"
                   for one in result["inputs"])
    text += f"  {METHODS[result['method']]}, {result.get('protocol', 'unknown')} protocol\n\n"
    if result["usable"]:
        text += model_text(result["model"], result["standard_error"], units) + "  (± is half of the 95 % interval)\n\n"
    where = "held-out data" if fit["validated_on"] == "held-out" else "the same data"
    text += f"  fit on {where}: VAF {per_axis(fit['VAF'], 2, '%')}; RMSE {per_axis(fit['RMSE'], 3, units['force'])}\n"
    for one in result["warnings"]:
        text += paragraph("  ! ", f"{one['code']}: {one['message']}") + paragraph("    try: ", one["try"])
    if not result["usable"]:
        text += "  NOT USABLE: no model is shown; see the warnings above.\n"
    return text.rstrip("\n")


def results_text(found: dict[str, Any]) -> str:
    """A row for each recording, the mean, and what failed."""
    text = text_table(results_rows(found)).replace("−", "-") + "  (± is half of the 95 % interval)\n"
    if "summary" in found:
        mean = found["summary"]
        error = {name: (np.array(mean["half_width95"][name], float) / NORMAL95).tolist() for name in mean["half_width95"]}
        text += f"\nmean of {mean['trials']} trials, by {METHODS[mean['method']]}\n"
        text += model_text(mean["model"], error, found["results"][0].get("units", UNITS))
    if "no_summary" in found:
        text += paragraph("no mean: ", found["no_summary"])
    for one in found.get("failed", []):
        text += paragraph("  ! ", f"{one['file']}: {one['message']}") + paragraph("    try: ", one["try"])
    return text.rstrip("\n")


def result_line(result: dict[str, Any]) -> str:
    """Inputs, stiffness and verdict in one line."""
    first, *more = [one["file"] or "arrays" for one in result["inputs"]] or ["arrays"]
    files = f"{first} and {len(more)} more" if more else first
    if not result["usable"]:
        return f"{files}: not usable ({', '.join(one['code'] for one in result['warnings'])})"
    rows = [", ".join(significant(one, 4).replace("−", "-") for one in row) for row in result["model"]["K"]]
    stiffness = f"[[{'], ['.join(rows)}]]" if len(rows) > 1 else rows[0]
    warned = ", ".join(one["code"] for one in result["warnings"])
    return f"{files}: K = {stiffness} {result.get('units', UNITS)['K']}, usable" + (f", warnings {warned}" if warned else "")


HIDDEN = frozenset(("schema", "units", "software", "sha256", "options_sha256", "hash", "digest", "covariance", "description"))
NUMBERS_SHOWN, ROWS_SHOWN = 8, 60


def scalars(values: Any) -> int:
    return sum(map(scalars, values)) if isinstance(values, list) else 1


def cell(value: Any) -> str:
    """The text of a value in a table."""
    if isinstance(value, bool) or value is None:
        return "" if value is None else "yes" if value else "no"
    if isinstance(value, list):
        if not value:
            return "none"
        if scalars(value) > NUMBERS_SHOWN and not all(isinstance(one, str) for one in value):
            return f"{scalars(value)} numbers"
        return ("; " if isinstance(value[0], (list, str)) else ", ").join(cell(one) or "–" for one in value)
    return significant(value, 4) if isinstance(value, float) else _mbk.in_python(str(value))


def objects(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def leaves(values: dict[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value below, and every list of several objects, by its path in Python."""
    for name, value in values.items():
        if objects(value) and len(value) == 1:
            name, value = f"{name}[0]", value[0]
        if isinstance(value, dict):
            yield from leaves(value, f"{path}{name}.")
        elif name not in HIDDEN and value is not None and value != "":
            yield path + name, value


def unit_of(part: Any, path: str) -> str:
    try:
        unit: str = part.unit(path.replace("[0]", ".0"))
    except KeyError:
        return ""
    return unit


def unit_below(part: Any, path: str, name: str) -> str:
    return unit_of(part, f"{path}.{name}")


def listed(caption: str, rows: list[dict[str, Any]], unit: Callable[[str], str]) -> str:
    """A table with a row for each of several objects."""
    shown = [dict(leaves(row)) for row in rows[:ROWS_SHOWN]]
    names = [name for name in dict.fromkeys(name for row in shown for name in row)
             if all(scalars(row.get(name)) <= NUMBERS_SHOWN and not objects(row.get(name)) for row in shown)]
    if len(rows) > ROWS_SHOWN:
        caption = f"{caption}: the first {ROWS_SHOWN} of {len(rows)}".lstrip(": ")
    heads = [f"{name} [{unit(name)}]" if unit(name) else name for name in names]
    return table(caption, heads, [[cell(row.get(name)) for name in names] for row in shown])


def fields(part: Any) -> str:
    """All values in a part, by their names in Python."""
    rows, lists = [], []
    for path, value in leaves(part._values):
        if objects(value):
            lists.append(listed(path, value, functools.partial(unit_below, part, f"{path}.0")))
        elif path not in ("usable", "warnings"):
            rows.append([path, cell(value), unit_of(part, path)])
    return (table("", ["", "value", "unit"], rows, "left") if rows else "") + "".join(lists)


def title_of(document: dict[str, Any]) -> str:
    """Title from the schema: 'Study check' for 'study_check'."""
    schema: str = document.get("schema", "").split("/")[0].removeprefix("mbk.")
    return str(document.get("title") or schema.replace("_", " ").capitalize() or "mbk")


def of(document: Any) -> str:
    """The HTML of a document for a notebook."""
    values: dict[str, Any] = document._values
    schema = values.get("schema", "").split("/")[0]
    special: dict[str, Callable[[dict[str, Any]], str]] = {
        "mbk.result": result_html, "mbk.results": results_html, "mbk.tf": transfer_function_html,
        "mbk.teleop": teleoperation_html, "mbk.validation": validation_html}
    if schema in special:
        return special[schema](values)
    if schema == "mbk.passivity":
        return passivity_html(values["passivity"])
    if schema == "mbk.passivities":
        return "".join(passivity_html(one["passivity"], f"the limb of {names_of(one)}") for one in values["results"])
    if schema == "mbk.compare":
        return heading("Difference between the two results") + listed("", widths(values), no_unit)
    if schema == "mbk.ellipse":
        return heading("Ellipses") + listed("", ellipse_rows(values), no_unit)
    if schema == "mbk.study_list":
        return heading(title_of(values)) + listed("", study_rows(values), no_unit)
    if schema == "mbk.study_summary":
        return heading(title_of(values)) + listed("", values["outcomes"], no_unit)
    judged = verdict(values) if "usable" in values and "warnings" in values else ""
    return heading(title_of(values)) + judged + fields(document) + (warning_list(values["warnings"]) if judged else "")


def heading(text: str) -> str:
    return f"<p><strong>{escaped(text)}</strong></p>"


def no_unit(name: str) -> str:
    return ""

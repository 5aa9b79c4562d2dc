#!/usr/bin/env python3
"""Every number that a benchmark gave, in README.md and docs/, is the one of the committed tables.

A claim is the text of a page with its numbers computed from benchmarks/results/*.csv. Tables that are made of
a CSV whole, and the list of laws, which is made of the schema of scenes, stand between comments `<!-- table:
NAME -->` and `<!-- end -->`. No table is older than the code that it measures, but for those that are known
to be (ages.py).

claims.py ROOT [--write]: --write puts the tables into the pages again; claims must be mended by hand.
"""
import json
import re
import sys
from pathlib import Path

import ages
from claims_list import CLAIMS
from claims_scalpel import table_blade
from results import ROOT, one, percent, rows, thousands


def markdown(header, body):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in body])


def table_realtime():
    body = []
    for tets in sorted({row["tets"] for row in rows("realtime")}):
        single, two = (rows("realtime", tets=tets, threads=n)[0] for n in (1, 2))
        figures = [f"{r[c]:.2f}" if r[c] < 2 else f"{r[c]:.1f}" for r in (single, two)
                   for c in ("real_time_factor", "undisturbed_factor")]
        body.append(["liver", thousands(tets), f"{single['wave_step_us']:.0f} µs", f"{single['limit_us']:.0f} µs",
                     f"{single['limit_gain']:.1f}", f"{single['local_step_gain']:.2f}", *figures])
    return markdown(["organ", "tetrahedra", "$h/c_p$", "limit", "gain", "local steps, at most",
                     "real time, one thread", "undisturbed", "two threads", "undisturbed"], body)


def table_hybrid():
    body = []
    for row in sorted(rows("hybrid", representation="precomputed"), key=lambda r: (r["tets"], r["linear_fraction"])):
        other = rows("hybrid", representation="tensor-mass", tets=row["tets"], linear_fraction=row["linear_fraction"])[0]
        set_up = f"{row['set_up_s']:.2f}" if row["set_up_s"] < 1 else f"{row['set_up_s']:.1f}"
        body.append([thousands(row["tets"]), percent(row["linear_fraction"], 0), f"{row['interface_vertices']:.0f}",
                     f"{row['speedup']:.1f}", percent(row["error_l2"]), percent(row["error_transient"]), set_up,
                     f"{other['speedup']:.1f}"])
    return markdown(["tetrahedra", "linear", "interface", "speed-up", "error L2", "in motion", "set-up [s]",
                     "tensor-mass"], body)


SHOWN = ["strain-recipe", "proposed", "proposed-precomputed", "proposed-corrected", "precomputed-alone",
         "precomputed-corrected", "selective-mass-alone", "selective-mass-corrected", "reduced", "reduced-corrected"]


def gesture_row(row, second):
    return [row["scene"].removeprefix("liver_"), second, f"`{row['regions']}`", f"{row['speedup']:.2f}",
            f"{row['worst_frame']:.2f}", percent(row["mean_error"], 2), percent(row["largest_error"])]


def table_gestures():
    found = [gesture_row(row, percent(row["tolerance"], 0)) for row in rows("gestures", tets=10299, regions=SHOWN)]
    return markdown(["scene", "tolerance", "regions", "speed-up", "worst frame", "mean error", "largest error"], found)


def table_gestures_meshes():
    found = [gesture_row(row, thousands(row["tets"])) for row in rows("gestures", tets__ne=10299, regions=SHOWN)]
    return markdown(["scene", "tetrahedra", "regions", "speed-up", "worst frame", "mean error", "largest error"], found)


def table_live():
    body = [[thousands(row["tets"]), f"{row['bare_us']:,.0f}", f"{100 * row['overhead']:.1f}",
             f"{row['publish_us']:.0f}", f"{row['seal_us']:.0f}"] for row in rows("live", frames__ge=1)]
    return markdown(["tetrahedra", "a frame of a world alone [µs]", "a session adds [%]", "of that a picture [µs]",
                     "a digest [µs]"], body)


def table_contact():
    shown = {"also none": "none (what the measurement is off by)",
             "far probe": "far probe", "touching with friction": "touching, friction 0.1",
             "self without touch": "self, nothing touches",
             "self while swinging": "self, nothing touches, the organ swings",
             "self with a slit while swinging": "self, lips of a slit rub, the organ swings"}
    body = [[f"{thousands(row['tets'])} tetrahedra", shown[row["contact"]], thousands(row["touched_vertices"]),
             f"{row['step_us']:.1f}", percent(row["cost"], 0 if row["cost"] > 0.1 else 1), f"{row['limit']:.4f}"]
            for row in rows("contact", contact=list(shown))]
    return markdown(["organ", "contact", "touched vertices", "step [µs]", "more than without",
                     "stable step over that without"], body)


def table_palpation():
    places = ("right of the tumour", "over the tumour", "left of the tumour")
    body = [[place, *(f"{one('palpation', 'force_N', place=place, tumour=t, indentation_mm=7):.1f} N" for t in ("yes", "no"))]
            for place in places]
    return markdown(["place", "with the tumour", "without"], body)


def table_haptic(contact="hold"):
    chosen = dict(mesh="liver_10k", speed=0.1, contact=contact)
    body = []
    for row in rows("haptic", frame_hz=120, **chosen):
        slow = one("haptic", "rms", frame_hz=20, method=row["method"], **chosen)
        body.append([row["method"], *(f"{100 * row[column]:.1f}" for column in ("rms", "max", "jump")), f"{100 * slow:.1f}"])
    return markdown(["between frames", "rms %", "largest %", "largest jump %", "rms % at 20 Hz"], body)


def table_haptic_fine():
    chosen = dict(mesh="liver_50k", speed=0.1, frame_hz=120)
    touching = {row["method"]: row for row in rows("haptic", contact="touch", **chosen)}
    body = []
    for row in rows("haptic", contact="hold", **chosen):
        cells = [of[column] if of else None for of in (row, touching.get(row["method"]))
                 for column in ("rms", "max", "jump")]
        body.append([row["method"], *("" if cell is None else f"{100 * cell:.1f}" for cell in cells)])
    return markdown(["between frames", "held: rms %", "largest %", "largest jump %",
                     "touched: rms %", "largest %", "largest jump %"], body)


def table_elements():
    elements = ["plain", "plain with nodal_pressure", "edge-smoothed", "edge-smoothed with nodal_pressure"]
    found, body = rows("elements"), []
    for name, tets in dict.fromkeys((row["body"], row["tets"]) for row in found):
        of_body = [row for row in found if row["body"] == name]
        for gesture in dict.fromkeys(row["gesture"] for row in of_body):
            by = {row["element"]: row for row in of_body if row["gesture"] == gesture}
            signed = gesture == "lowest frequency"
            cells = [f"{100 * by[e]['error']:{'+' if signed else ''}.1f} %"
                     + (f", {100 * by[e]['force_excess']:+.1f} %" if by[e]["force_excess"] else "") for e in elements]
            body.append([name.split("_")[0], thousands(tets), gesture, *cells])
        for column, what in (("step_ratio", "stable step"), ("time_ratio", "time per simulated second")):
            cells = [f"{next(row[column] for row in of_body if row['element'] == e):.2f}" for e in elements]
            body.append([name.split("_")[0], thousands(tets), what, *cells])
    return markdown(["body", "tetrahedra", "", *elements], body)


def table_huge():
    body = [[thousands(row["tets"]), thousands(row["ranks"]), f"{row['wall_s']:.1f} s",
             thousands(row["newton"]), thousands(row["linear"]), f"{row['peak_rank_bytes'] / 1e9:.2f} GB",
             f"{row['halo_bytes'] / 1e6:.3f} MB" if row["halo_bytes"] else "0"] for row in rows("huge")]
    return markdown(["tetrahedra", "ranks", "wall time", "Newton", "CG in all", "memory per rank",
                     "received per product, all ranks"], body)


def table_reduced():
    body = [[row["scene"].removeprefix("liver_"), thousands(row["tets"]),
             percent(row["tolerance"], 0) if row["regions"] == "reduced-corrected" else "–", f"{float(row['speedup']):.2f}",
             percent(row["largest_error"]), percent(row["mean_error"], 2), percent(row["largest_same_cut"]),
             percent(row["estimated_error"]),
             f"{float(row['ratio_at_worst']):.2f}", percent(row["watching"], 0), f"{float(row['worst_frame']):.2f}",
             percent(row["expanded"], 0), f"{int(row['frames_beyond'])} of {int(row['frames_wrong'])}"]
            for row in rows("reduced") if row["regions"] != "nonlinear"]
    return markdown(["gesture", "tetrahedra", "corrected above", "speed-up", "largest error", "mean error", "largest, same cut",
                     "largest estimated", "ratio", "watch", "slowest frame", "all full", "beyond 3"], body)


def table_reduced_setup():
    body = [[thousands(row["tets"]), f"{row['setup_s']:.2f}", f"{row['setup_s_per_million']:.1f}", f"{row['bytes_per_tet']:.0f}",
             f"{row['bytes_per_tet_beyond_nonlinear']:.0f}"] for row in rows("reduced_setup")]
    return markdown(["tetrahedra", "set-up [s]", "set-up per million [s]", "bytes per tetrahedron",
                     "of these beyond all non-linear"], body)


def table_frequencies():
    body = [[thousands(row["tets"]), f"{row['lambda_over_mu']:.0f}", f"{1e3 * row['cell']:.1f}", thousands(row["cells"]),
             f"{row['alpha_over_mu']:.2f}", percent(row["mean_error"]), percent(row["largest_error"])]
            for row in rows("frequencies")]
    return markdown(["tetrahedra", "λ/μ", "cell [mm]", "cells", "α/μ", "mean error", "largest error"], body)


def table_accuracy_undeclared():
    shown = {"svk_volume": "all non-linear", "reduced": "reduced", "reduced_corrected": "reduced, corrected",
             "selective_mass_corrected": "selective masses, corrected",
             "hybrid_gradient_50": "half tensor-mass", "tensor_mass": "all tensor-mass"}
    body = [[thousands(row["tets"]), name, f"{float(row['wall_s_per_s']):.2g}", percent(row["error_model"]),
             percent(row["error_total"])]
            for model, name in shown.items()
            for row in rows("accuracy_undeclared", model=model, precision="single", safety=0.9)]
    body.sort(key=lambda line: (int(line[0].replace(",", "")), -float(line[2])))
    return markdown(["tetrahedra", "model", "time per simulated second [s]", "to the converged solution",
                     "to the refined solution"], body)


def table_meshing_quality():
    body = []
    for row in rows("meshing/quality"):
        kept = row["mesher"] if row["mesher_kept"] == row["mesher"] else f"{row['mesher']}, {row['mesher_kept']} kept"
        body.append([row["body"], thousands(row["asked"]), kept, thousands(row["tets"]), f"{row['time_step_star']:.2f}",
                     f"{row['min_dihedral']:.1f}", f"{row['median_min_dihedral']:.0f}",
                     f"{row['smallest_altitude_ratio']:.2f}", f"{round(row['volume_error_percent'], 2) + 0.0:.2f}",
                     f"{row['cpu_s']:.1f}", f"{row['peak_bytes'] / 1e6:.0f}"])
    return markdown(["body", "asked", "mesher", "tetrahedra", "dt\\*", "smallest dihedral °", "median of the smallest °",
                     "altitude / edge", "volume error %", "processor s", "MB"], body)


def table_meshing_fuzz():
    body = [[row["damage"], *(f"{row[column]:.0f}" for column in ("surfaces", "meshed", "refused", "gave_up", "wrong"))]
            for row in rows("meshing/fuzz")]
    return markdown(["damage", "surfaces", "meshed", "refused by name", "gave up by name", "wrong"], body)


def table_laws():
    """The laws of fem/law_moduli.h, with their constants as the schema of scenes describes them."""
    schema = json.loads((ROOT / "lib/lobe/scene/scene.schema.json").read_text(encoding="utf-8"))
    material = schema["definitions"]["material"]["properties"]
    header = (ROOT / "lib/lobe/fem/law_moduli.h").read_text(encoding="utf-8")
    body = []
    for law, keys in re.findall(r'\{"([\w-]+)", \{([^}]*)\}', header.split("law_rows[] =")[1].split(";")[0]):
        for key in re.findall(r'"(\w+)"', keys):
            least = [f"{sign} {material[key][limit]}" for limit, sign in
                     (("minimum", "≥"), ("exclusiveMinimum", ">")) if limit in material[key]]
            body.append([f'`"{law}"`', f"`{key}`", " ".join(["number", *least]), material[key]["description"]])
        if law not in material["law"]["enum"]:
            raise LookupError(f"the schema of scenes has no law {law}")
    named = ", ".join(f'`"{law}"`' for law in material["law"]["enum"])
    return (f'{named}. {material["law"]["description"]}\n\n' +
            markdown(["law", "constant", "type", "meaning"], body))


def unit(row):
    return "" if row["unit"] == "-" else f" {row['unit']}"


def table_beam_in_motion():
    body = [[row["case"], row["quantity"], f"{row['measured']:.4g}{unit(row)}", f"{row['reference']:.4g}{unit(row)}",
             percent(row["measured"] / row["reference"] - 1) if row["reference"] else ""] for row in rows("silicone_beam_motion")]
    return markdown(["case", "quantity", "lobe", "reference", "lobe is off by"], body)


def table_own_steps():
    def asked(row):
        return f"gain ≥ {row['asked_gain']:g}" if row["asked_gain"] else f"own steps ≤ {row['asked_cost']:.2f}"

    figures = ("one_over_without", "own_over_without", "gain", "evaluations")
    body = [[row["case"], thousands(row["tets"])] + [f"{row[name]:.2f}" for name in figures] + [asked(row)]
            for row in rows("own_steps")]
    return markdown(["", "tetrahedra", "one step", "own steps", "gain", "evaluations", "asked"], body)


TABLES = {"laws": table_laws, "old": lambda: ages.list_of_old(ROOT), "reduced": table_reduced, "reduced-setup": table_reduced_setup, "frequencies": table_frequencies,
          "accuracy-undeclared": table_accuracy_undeclared,
          "meshing-quality": table_meshing_quality, "meshing-fuzz": table_meshing_fuzz,
          "blade": table_blade, "contact": table_contact, "haptic": table_haptic,
          "haptic_touch": lambda: table_haptic("touch"), "haptic_fine": table_haptic_fine, "palpation": table_palpation,
          "elements": table_elements, "huge": table_huge, "live": table_live, "realtime": table_realtime, "hybrid": table_hybrid,
          "beam-in-motion": table_beam_in_motion,
          "own-steps": table_own_steps,
          "gestures": table_gestures, "gestures-meshes": table_gestures_meshes}
TABLE = re.compile(r"(<!-- table: ([\w-]+) -->\n)((?:(?!<!--).)*)(<!-- end -->)", re.S)  # may be empty


def squeezed(text):
    return re.sub(r"\s+", " ", text.replace("**", ""))


def main(write):
    faults, tables = [], 0
    for page in [ROOT / "README.md"] + sorted((ROOT / "docs").rglob("*.md")):
        text = page.read_text(encoding="utf-8")

        def made(match):
            nonlocal tables
            tables += 1
            try:
                table = TABLES[match[2]]() + "\n"
            except FileNotFoundError as missing:
                print(f"{page.name}: table {match[2]} waits for {Path(missing.filename).relative_to(ROOT)}")
                return match[0]
            if table == match[3]:
                return match[0]
            faults.append(f"{page.name}: table {match[2]} is not that of its source; run tests/docs/claims.py . --write")
            return match[1] + table + match[4]

        text = TABLE.sub(made, text)
        if write:
            page.write_text(text, encoding="utf-8")
    faults += ages.faults(ROOT)
    for page, claim in CLAIMS:
        said = squeezed(claim())
        if said not in squeezed((ROOT / page).read_text(encoding="utf-8")):
            faults.append(f"{page}: the tables say: {said}")
    print("\n".join(faults))
    print(f"{tables} tables, {len(CLAIMS)} claims, {len(faults)} faults")
    return 1 if faults or tables < len(TABLES) else 0


if __name__ == "__main__":
    sys.exit(main("--write" in sys.argv))

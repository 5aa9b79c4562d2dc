"""The table of docs/benchmarks/blade.md, and claims on it, for claims.py."""
from results import high, low, one, percent, rows, span

BODIES = ("liver_10k", "cube_48k", "liver_0.00575")


def series(column, region="nonlinear", digits=2, most=None):
    """Of the liver, the cube and the finer liver; bold where it is above what was aimed at."""
    found = [f"{one('scalpel', column, mesh=mesh, region=region):.{digits}f}" for mesh in BODIES]
    missed = [most is not None and float(figure) > most for figure in found]
    if all(missed):
        return f"**{'; '.join(found)}**"
    return "; ".join(f"**{figure}**" if is_missed else figure for figure, is_missed in zip(found, missed))


def both(column, most, digits=2):
    of_tensor_mass = series(column, "tensor-mass", digits, most)
    return series(column, "nonlinear", digits, most), f"tensor-mass: {of_tensor_mass}"


def per_frame():
    return "; ".join(f"{row['cut'] / row['frames']:.0f}" for mesh in BODIES
                     for row in rows("scalpel", mesh=mesh, region="nonlinear"))


def floor(column, mesh, cut_step=0.75):
    return one("scalpel_limit", column, mesh=mesh, cut_step=cut_step)


def precomputed_rows():
    row = rows("scalpel_precomputed")[0]
    return [["frame of a 40 mm blade in the pre-computed liver, mean; slowest [ms, wall]", "0.3",
             f"**{row['frame_ms']:.0f}; {row['slowest_frame_ms']:.0f}**",
             f"{row['frame_tets']:.1f} exact edits of {row['tet_us'] / 1000:.1f} ms; "
             "expand the region ahead where that is too long"],
            ["a single cut there; per tetrahedron of a full cut [µs, wall]", "–",
             f"{row['single_us']:,.0f}; {row['full_us']:,.0f}",
             "vertices of the cut join the interface, whose matrix is dense"]]


def order_text():
    row = rows("scalpel_beam_order")[0]
    grows = any(a < b for a, b in zip(deviations(), deviations()[1:]))
    return (f"order {row['cut_order']:.2f}, of meshes that follow the slit {row['conforming_order']:.2f}; "
            f"if one of the meshes is left out, {row['least_order']:.2f} to {row['most_order']:.2f}"
            + ("; the deviations are not monotone" if grows else ""))


def deviations():
    return [100 * (1 - row["cut_m"] / row["conforming_m"]) for row in rows("scalpel_beam")]


def floor_rows():
    added = f"{100 * floor('most_added', 'liver_2k'):.2f} %"
    if floor("most_added", "liver_2k") > 0.01:
        added = f"**{added}**"
    return [["time step after one of twelve full cuts, worst; median", "0.7; 0.95",
             f"{floor('worst_limit', 'liver_10k'):.3f}; {floor('median_limit', 'liver_10k'):.2f}",
             f"without the floor {floor('worst_limit', 'liver_10k', 0):.2f}; "
             f"{floor('median_limit', 'liver_10k', 0):.2f}"],
            ["mass of the floor per full cut, most", "1 %", percent(floor("most_added", "liver_10k"), 2),
             f"on the shipped liver of 2,103 tetrahedra {added} in one cut of twelve, "
             f"median {percent(floor('median_added', 'liver_2k'), 2)}"]]


def beam_rows():
    rims = "; ".join(f"{row['rim_edges']:+.2f}".replace("-", "−") for row in rows("scalpel_beam"))
    return [["sag of the slit beam against a mesh that follows the slit, cells of 10; 5; 3.3; 2.5; 2 mm",
             "the mesh's rate", "−" + "; −".join(f"{d:.1f}" for d in deviations()) + " %", order_text()],
            ["ends of these slits beyond what the blade swept, in mean edges", "0.2", rims,
             "a cut ends at faces"]]


def table_blade():
    error = f"{high(rows('scalpel'), 'error'):.0e}".replace("e-0", "e-")
    body = [
        ["geometry per cut tetrahedron [µs]", "5", series("geometry_us", digits=1, most=5),
         "each tetrahedron is near the blade, and looked at, in several steps"],
        ["the same, all in one sweep [µs]", "5", series("sweep_us", digits=1, most=5), ""],
        ["tetrahedra cut per frame that opens something", "–", per_frame(),
         "the blade begins and ends outside"],
        ["all, non-linear, in 60 frames [µs, wall]", "12", series("all_us", digits=0, most=12),
         "a step of the blade in each frame, after steps of the body that have emptied the caches"],
        ["non-linear, all in one frame [µs, wall]", "12", series("batch_us", digits=0, most=12),
         "not in every run: up to 14 on the small liver"],
        ["all, tensor-mass, in 60 frames [µs, wall]", "15", series("all_us", "tensor-mass", 0, 15),
         "the same, and six edges per tetrahedron whose blocks are summed again"],
        ["tensor-mass, all in one frame [µs, wall]", "15", series("batch_us", "tensor-mass", 0, 15), ""],
        ["all, a single tetrahedron per frame [µs, wall]", "20", *both("single_us", 20, 0)],
        ["frame of a 40 mm blade, mean [ms, wall]", "0.3", *both("frame_ms", 0.3)],
        ["its slowest frame [ms, wall]", "0.3", *both("slowest_frame_ms", 0.3)],
        *precomputed_rows(),
        ["step after a full cut, non-linear", "1.10", series("step_ratio", most=1.1),
         f"a world built afresh from the cut body takes {series('fresh_ratio')}"],
        ["the same, tensor-mass", "1.10", series("step_ratio", "tensor-mass", most=1.1),
         "copies add edges and vertices; a world built afresh from the cut body takes "
         + series("fresh_ratio", "tensor-mass")],
        ["step after a cut that leaves one half loose, which is non-linear then; tensor-mass", "1.10",
         series("loose_ratio", "tensor-mass", most=1.1), "half of the body is of the dearer model"],
        ["all that a world allocates per cut tetrahedron [bytes]", "400",
         series("world_bytes", digits=0, most=400),
         f"tensor-mass: {series('world_bytes', 'tensor-mass', 0, 400)}; "
         "vertices, copies, the record of the cut, room to spare"],
        ["grains alone [bytes]", "400", series("bytes", digits=0, most=400), ""],
        *floor_rows(),
        ["forces and masses against a world built afresh", "1e-5", error, "single precision"],
        *beam_rows(),
    ]
    lines = ["| | aimed at | reached | what bounds it |", "|---|---|---|---|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in body])


def slow_steps():
    return [row["step_ratio"] for row in rows("scalpel", region="tensor-mass") if row["step_ratio"] > 1.1]


def floored():
    return rows("scalpel_limit", cut_step=0.75)


L, GUIDE = "docs/limitations.md", "docs/guide/cut.md"

CLAIMS = [
    (L, lambda: "takes " + " and ".join(f"{ratio:.2f}" for ratio in slow_steps()) +
        " times as long on two of three tensor-mass bodies (aim: 1.10)"),
    (L, lambda: f"It takes {span(rows('scalpel', region='tensor-mass'), 'loose_ratio', 2)} times as long "
                "where half of such a body"),
    (L, lambda: f"was {percent(floor('most_added', 'liver_2k'), 2)} in one cut of twelve on 2,103 tetrahedra"),
    (L, lambda: f"sags {span([{'less': less} for less in deviations()], 'less')} % less"),
    (GUIDE, lambda: "In {:.0f} cuts through the shipped livers at least {:.3f} of it was left".format(
        sum(row["planes"] for row in floored()), low(floored(), "worst_limit"))),
    (GUIDE, lambda: f"a scalpel takes {low(rows('scalpel'), 'batch_us'):.0f} to "
                    f"{high(rows('scalpel'), 'all_us'):.0f} µs per cut tetrahedron"),
]

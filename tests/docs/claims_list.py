"""The claims that claims.py checks: a page, and its text with numbers from the tables."""
import re

import claims_choice
import claims_scalpel
from results import ROOT, alone, corrected, ends, high, kernel, low, one, percent, rows, span

PRECOMPUTED = dict(representation="precomputed", tets=10299)
UNDECLARED = dict(scene="liver_undeclared", tets=10299)
B = "docs/benchmarks.md"


def realtime(tets, threads, column="real_time_factor"):
    return one("realtime", column, tets=tets, threads=threads)


def cuts(region, batch, tets=None):
    chosen = {"tets": tets} if tets else {}
    return rows("cut", region=region, batch=batch, **chosen)


def two_threads(name, tets):
    return kernel(name, "ns_per_tet", tets=tets) / kernel(name, "ns_per_tet", tets=tets, threads=2)


def growth(name):
    return kernel(name, "ns_per_tet", tets=998250) / kernel(name, "ns_per_tet", tets=10368)


def front(regions, tolerance):
    row = rows("gestures", regions=regions, tolerance=tolerance, **UNDECLARED)[0]
    return f"{row['speedup']:.2f}", percent(row["largest_error"])


def hybrid(representation, which):
    found = sorted(rows("hybrid", representation=representation, tets=10299), key=lambda r: r["linear_fraction"])
    return found[which]


def independent():
    return high(rows("validation", family="independent solution"), "error")


def silicone_beam(case):
    """How far a beam under 0.51 N is off what was measured, of what was measured; below 0: too stiff."""
    row = rows("validation", family="silicone beam", case=case, quantity="displacement, 0.51 N")[0]
    return f"{100 * (row['measured'] / row['reference'] - 1):+.0f} %".replace("-", "−")


def swing(quantity):
    return percent(one("silicone_beam_motion", "error", case="a term and damping, predicted", quantity=quantity))


def played():
    return rows("live", random_minutes__ge=1)[0]


def drawn(row):
    return row["positions_ns"] + row["normals_ns"]


def peer(program, figure, **wanted):
    found = rows("peers", program=program, figure=figure, **wanted)
    ends = [f"{end:,.0f}" if end >= 5 else f"{end:g}" for end in (low(found, "low"), high(found, "high"))]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def growth_of_energy(precision, *models):
    """Largest energy of the second half of a million steps over that of the first."""
    found = rows("stress", case="undamped and adrift, 0.90 of the limit", precision=precision, model=list(models))
    return [row["energy_late_J"] / row["energy_early_J"] for row in found]


PLAIN = ["nonlinear", "volume term", "nodal pressure", "mixed", "corotated"]


def over(base, kernel_name, precision):
    return [row["ns_per_tet"] / one("kernels_quick", "ns_per_tet", kernel=base, precision=precision, tets=row["tets"])
            for row in rows("kernels_quick", kernel=kernel_name, precision=precision)]


def over_svk(kernel_name, precision):
    return over("svk", kernel_name, precision)


def watching(regions, tets):
    return span(rows("gestures", regions=regions, tets=tets), "watching", 0, 100)


def example(name):
    """The numbers that the test of an example expects of its output."""
    text = (ROOT / "examples" / "CMakeLists.txt").read_text(encoding="utf-8")
    printed = re.search(rf"lobe_example\({name}\s+\"([^\"]*)\"", text)[1]
    return re.findall(r"\d+\.\d\d", printed.replace("\\\\", ""))


def cylinder(row):
    return " / ".join(example("02_cylinder_volume")[3 * row:3 * row + 3])


def by_lattice(tets):
    return span(rows("reduced", regions="reduced-corrected", tolerance=0.02, tets=tets), "speedup")


def lattice_error(tets):
    found = rows("reduced", regions="reduced-corrected", tolerance=0.02, tets=tets)
    return percent(high(found, "largest_error"))


def page(column):
    return [f"{one('page', column, browser=name):.0f}" for name in ("all by software", "WebGL by software")]


def held(scene, column="largest_error", **wanted):
    """A column of the corrected pre-computed regions, of the errors as a share of the tolerance."""
    found = rows("gestures", regions="precomputed-corrected", **({"scene": scene} if scene else {}), **wanted)
    return [row[column] / row["tolerance"] if column.endswith("error") else row[column] for row in found]


def more_linear(scene, tolerance):
    share = {name: one("gestures", "linear_share", scene=scene, tets=10299, tolerance=tolerance, regions=name)
             for name in ("proposed", "strain-recipe")}
    return share["proposed"] / share["strain-recipe"]


def session(tets, column):
    return one("live", column, tets=tets)


def beam(case):
    """The deflection of the end of the beam of the theory, section 12 [m]."""
    return f"{-rows('validation', family='SVK beam', case=case, quantity='u_y of the end')[0]['measured']:.2f}"


def beam_in_motion():
    elastic, viscous = (rows("silicone_beam_motion", case=case, quantity="half period, gravity_b")[0]["measured"]
                        for case in ("elastic", "one term alone"))
    return (f"An elastic beam with the rest of `gravity_a` has a half period of {elastic:.4f} s, the real one 0.0647 s, "
            f"and one whose damping is all of a term {viscous:.4f} s.")


R = "README.md"
T = "docs/theory.md"
S = "docs/surface.md"

def one_version(program):
    version = {row["version"] for row in rows("peers", program=program)}
    return f"{version.pop():g}" if len(version) == 1 else version


def pressed(place, tumour="yes"):
    """The force of a finger at an indentation of 7 mm [N]."""
    return one("palpation", "force_N", place=place, tumour=tumour, indentation_mm=7)


def felt():
    over, beside = pressed("over the tumour"), max(pressed(f"{side} of the tumour") for side in ("left", "right"))
    return over / beside, over / pressed("over the tumour", "no")


def predicted(method, column, frame_hz=120, contact="hold", speed=0.1):
    return one("haptic", column, mesh="liver_10k", contact=contact, speed=speed, method=method, frame_hz=frame_hz)


def loop_on_the_liver():
    for speed in (0.02, 0.05, 0.1):
        of = {method: predicted(method, "rms", speed=speed)
              for method in ("the servo", "linear in time", "constant")}
        assert of["the servo"] <= of["linear in time"] and of["the servo"] <= of["constant"] / 5
    rms, largest, jump = (predicted("the servo", column) for column in ("rms", "max", "jump"))
    assert rms <= 0.01 and largest <= 0.04 and jump <= 0.01
    ratio = predicted("the servo", "rms") / predicted("linear in time", "rms")
    return (f"At 0.1 m/s the loop has {ratio:.2f} times the error of *linear in time*, and less at lower "
            "speeds. It has less than a fifth of that of *constant*")


def loop_that_touches():
    of = lambda method, column, **more: predicted(method, column, contact="touch", **more)
    ratios = [of("the servo", "rms", speed=speed) / of("linear in time", "rms", speed=speed)
              for speed in (0.02, 0.05, 0.1)]
    for speed in (0.02, 0.05, 0.1):
        assert of("the servo", "rms", speed=speed) < 0.5 * of("constant", "rms", speed=speed)
        assert of("the servo", "jump", speed=speed) < 0.02
    assert of("the servo", "max") < of("linear in time", "max")
    return ("At 0.02 to 0.1 m/s the loop has less than half the rms error of *constant*, and "
            f"{min(ratios):.2f} to {max(ratios):.2f} times that of *linear in time*")


KERNELS = "docs/benchmarks/kernels.md"
CUTS = "docs/benchmarks/cuts.md"
REAL_TIME = "docs/benchmarks/real_time.md"
HYBRIDS = "docs/benchmarks/hybrids.md"
GESTURES = "docs/benchmarks/gestures.md"


FIGURES = "docs/haptics/figures.md"




COST = "docs/contact/cost.md"


NODAL_PRESSURE = "docs/theory/12_nodal_pressure.md"


MATERIALS = "docs/scene/materials.md"


CLAIMS = [
    (FIGURES, loop_on_the_liver),
    (FIGURES, loop_that_touches),
    (FIGURES, lambda: "Its largest jump is {:.1f} % of the peak, and that of *linear in time* {:.1f} %".format(
        *(100 * predicted(method, "jump", contact="touch") for method in ("the servo", "linear in time")))),
    ("docs/contact.md", lambda: "Over the tumour the force is {:.1f} times that beside it, and {:.1f} times that of the "
                                "same place without it".format(*felt())),
    (R, lambda: f"tools and cuts included | {realtime(10299, 1):.1f} times real time |"),
    (R, lambda: f"by a cautery, against a model built afresh | {high(rows('cut'), 'error'):.0e} apart |"),
    (R, lambda: f"by a scalpel, against a model built afresh | {high(rows('scalpel'), 'error'):.0e} apart |"),
    (R, lambda: f"| St Venant-Kirchhoff forces | {kernel('svk'):.2f}; {kernel('svk', precision='double'):.2f} |"),
    (R, lambda: f"| linear tensor-mass forces | {kernel('tensor_mass'):.2f}; {kernel('tensor_mass', precision='double'):.2f} |"),
    (R, lambda: f"| remove one tetrahedron [µs] | {span(cuts('nonlinear', 1), 'us_per_tet')} |"),
    (R, lambda: f"| memory per tetrahedron [bytes] | {kernel('step', 'world_bytes_per_tet'):.0f} |"),
    (R, lambda: f"| force error after cuts, against a rebuilt model | {high(rows('cut'), 'error'):.0e} |"),
    (R, lambda: f"against FEniCSx and GetFEM, at every vertex | {independent():.1e} apart |"),
    (R, lambda: "Turek-Hron CSM1, extrapolated to fine meshes | {} off |".format(percent(
        one("validation", "error", family="Turek-Hron", case="CSM1", quantity="u_y(A), extrapolated"), 2))),
    (R, lambda: "a real silicone beam bent by 0.51 N; quadratic elements: "
                f"{silicone_beam('quadratic tetrahedra, predicted')} | "
                f"{silicone_beam('P1, 1,248 tetrahedra, with that modulus')} | "
                f"{silicone_beam('edge-smoothed, with that modulus')} |"),
    (R, lambda: f"half period and damping ratio, predicted | {swing('half period, 0.51 N')} and "
                f"{swing('damping ratio, 0.51 N')} off |"),
    (R, lambda: f"| {kernel('svk'):.2f}; {kernel('svk', precision='double'):.2f} | {peer('SOFA', 'svk')} | "
                f"{peer('VegaFEM', 'svk')} | {peer('NiftySim', 'svk')} |"),
    (R, lambda: f"{kernel('tensor_mass', precision='double'):.2f} | {peer('SOFA', 'tensor_mass')} | | |"),
    (R, lambda: f"{span(cuts('nonlinear', 1), 'us_per_tet')} | {peer('SOFA', 'remove')} | | |"),
    (R, lambda: f"{kernel('step', 'world_bytes_per_tet'):.0f} | {peer('SOFA', 'bytes')} | | {peer('NiftySim', 'bytes')} |"),
    (R, lambda: f"{high(rows('cut'), 'error'):.0e} | {100 * low(rows('peers', figure='cut_error'), 'low'):.0f} % "
                f"(tensor-mass) | | |"),
    (R, lambda: "includes mass and surface; SOFA's is "
                f"{peer('SOFA', 'remove', high__le=20)} µs without them"),
    (R, lambda: "| | lobe, single; double | " + " | ".join(
        f"{name} {one_version(name)}" for name in ("SOFA", "VegaFEM", "NiftySim")) + " |"),
    (R, lambda: f"| linear | {cylinder(0)} | 7 / 28 / 63 |"),
    (R, lambda: f"| non-linear | {cylinder(1)} | 0.3 / 1 / 2 |"),
    (R, lambda: f"| non-linear + volume term | {cylinder(2)} | 0.2 / 0.5 / 1 |"),
    (COST, lambda: f"A pressure of 10 kPa goes {one('contact', 'depth_at_10_kPa_mm', tets=10299, contact='far probe'):.2f} "
                                f"mm deep on the finer organ"),
    ("docs/huge.md", lambda: f"take {one('huge', 'wall_s', tets=1996500, ranks=2):.0f} s (target: 10 minutes) and "
                             f"{2 * one('huge', 'peak_rank_bytes', tets=1996500, ranks=2) / 2**30:.1f} GiB in all (target: 12)"),
    ("docs/stability.md", lambda: f"the largest energy of the second half is {ends(growth_of_energy('single', *PLAIN), '.1f')} "
                                  f"times that of the first ({growth_of_energy('single', 'selective')[0]:.1f} with selective masses)"),
    ("docs/stability.md", lambda: "In double precision the factor is "
                                  f"{ends(growth_of_energy('double', *PLAIN, 'tensor-mass', 'selective'), '.2f')} in every model"),
    ("docs/limitations.md", lambda: f"is {one('reduced', 'speedup', scene='liver_undeclared', regions='reduced', tets=10299):.2f} times as fast as "
                                    f"all non-linear, with a largest error of {percent(one('reduced', 'largest_error', scene='liver_undeclared', regions='reduced', tets=10299))} "
                                    f"and a mean of {percent(one('reduced', 'mean_error', scene='liver_undeclared', regions='reduced', tets=10299))}"),
    ("docs/live.md", lambda: f"({played()['random_commands']:,.0f} commands, {played()['random_returns']:,.0f} times back) "
                             f"made a record of {played()['recording_mb']:.0f} MB. They were played in "
                             f"{played()['playing_s']:.0f} s and replayed bit for bit in {played()['replaying_s']:.0f} s"),
    (S, lambda: "to follow the cut of a tetrahedron with the surface takes "
                f"{span(rows('surface'), 'follow_us', 0)} µs"),
    (S, lambda: f"positions and normals of the surface take {min(map(drawn, rows('surface'))):.0f} to "
                f"{max(map(drawn, rows('surface'))):.0f} ns per vertex"),
    (S, lambda: f"positions and normals of the skin take {span(rows('skin'), 'update_ns', 0)} ns per vertex"),
    (S, lambda: f"with the skin takes {span(rows('skin'), 'follow_us', 0)} µs"),
    (S, lambda: f"along the cut of a blade takes {span(rows('skin'), 'blade_us', 0)} µs per tetrahedron"),
    (MATERIALS, lambda: f"A force evaluation takes {kernel('svk_nodal_pressure') / kernel('svk'):.1f} times as long"),
    ("docs/stability.md", lambda: f"{len(rows('stress', passed='yes'))} of {len(rows('stress'))} runs end as they must. In "
                                  f"{len([r for r in rows('stress') if r['unravelling_s'] > 0])} of them a tangle was "
                                  f"unravelled, for {high(rows('stress'), 'unravelling_s'):.1f} s"),
    ("docs/validation.md", beam_in_motion),
    ("docs/validation.md", lambda: f"{len(rows('validation', passed='yes'))} of {len(rows('validation'))} rows passed"),
    (B, lambda: f"A liver of 10,299 tetrahedra then runs at {realtime(10299, 1):.1f} times real time on one thread"),
    (B, lambda: f"one of 50,244 at {realtime(50244, 2):.2f} times on two threads"),
    (B, lambda: f"`\"selective_mass\": 12` in `time` | {span(corrected(tets__ge=10000), 'speedup')} times | at most "
                f"{percent(high(corrected(tets__ge=10000), 'largest_error'))} in every frame |"),
    (B, lambda: f"| {by_lattice(50244)} times at 50,244, {by_lattice(200712)} at 200,712 | at most {lattice_error(50244)} in every frame "
                f"at 50,244; {high(rows('reduced', tets=200712, regions='reduced-corrected', tolerance=0.02), 'largest_error') * 100:.0f} % where"),
    (B, lambda: f"| {hybrid('precomputed', -1)['speedup']:.1f} times per step, "
                f"{percent(hybrid('precomputed', -1)['linear_fraction'], 0)} of the volume pre-computed | "
                f"{percent(hybrid('precomputed', -1)['error_l2'])} in equilibrium |"),
    (B, lambda: f"| `tensor-mass` in its place | {hybrid('tensor-mass', -1)['speedup']:.1f} times | the same |"),
    (B, lambda: f"right after a release the error was {span(alone(), 'largest_error', 0, 100)} %"),
    ("README.md", lambda: f"are {by_lattice(50244)} times as fast as all non-linear, with an error of at "
                          f"most {lattice_error(50244)} in every frame"),
    (B, lambda: f"Selective masses reach {span(corrected(tets__ge=10000), 'speedup')} times, reduced regions "
                f"{by_lattice(10299)} times at 10,299 tetrahedra"),
    (KERNELS, lambda: "Forces of edge-smoothed tetrahedra take {:.1f} times as long as `svk` at 10,368 tetrahedra and {:.1f} "
                      "times at 998,250".format(*(kernel('svk_smoothed', tets=n) / kernel('svk', tets=n) for n in (10368, 998250)))),
    (KERNELS, lambda: f"The closed form reads {kernel('svk', 'bytes_per_tet'):.0f} bytes per tetrahedron in single precision, the "
                f"stored one {span(rows('kernels', kernel='svk_stored', precision='single', mesh='cube', threads=1, tets__ge=10000), 'bytes_per_tet', 0)}"),
    (KERNELS, lambda: f"the stored form takes {kernel('svk_stored', tets=10368) / kernel('svk', tets=10368):.1f} to "
                f"{kernel('svk_stored') / kernel('svk'):.1f} times as long as the closed one"),
    (KERNELS, lambda: f"up to {kernel('svk_stored', tets=196608) / kernel('svk', tets=196608):.1f} times as long"),
    (KERNELS, lambda: f"The closed form does {kernel('svk', 'flops_per_tet'):.0f} flops on 44 bytes"),
    (KERNELS, lambda: f"does {kernel('tensor_mass', 'flops_per_tet'):.0f} flops on {kernel('tensor_mass', 'bytes_per_tet'):.0f} bytes"),
    (KERNELS, lambda: f"the closed form goes from {kernel('svk', 'ns_per_tet', tets=10368):.1f} to "
                f"{kernel('svk', 'ns_per_tet', tets=998250):.1f} ns and the tensor-mass product from "
                f"{kernel('tensor_mass', 'ns_per_tet', tets=10368):.1f} to {kernel('tensor_mass', 'ns_per_tet', tets=998250):.1f} ns: "
                f"{growth('svk'):.1f} and {growth('tensor_mass'):.1f} times"),
    (KERNELS, lambda: f"A world of 998,250 tetrahedra takes {kernel('step', 'world_bytes_per_tet', tets=998250):.0f} bytes per "
                f"tetrahedron in single precision"),
    (KERNELS, lambda: f"| `svk`, single; double | 0.20; 0.45 | {kernel('svk'):.2f}; {kernel('svk', precision='double'):.2f} |"),
    (KERNELS, lambda: f"| 0.12, 0.26 | {kernel('tensor_mass'):.2f}, {kernel('svk_volume'):.2f} |"),
    (KERNELS, lambda: f"| whole step over its forces | 1.15 | {kernel('step') / kernel('svk'):.2f} |"),
    (KERNELS, lambda: f"at 998,250 over that at 10,368: `svk` | 1.3 | {growth('svk'):.1f} |"),
    (KERNELS, lambda: f"at 48k, 197k, 998k | 1.8 | {two_threads('svk', 48000):.2f}, {two_threads('svk', 196608):.2f}, "
                f"{two_threads('svk', 998250):.2f} |"),
    (KERNELS, lambda: f"| two threads below 48k | not slower | {two_threads('svk', 2058):.1f} to {two_threads('svk', 10368):.1f} |"),
    (KERNELS, lambda: f"| one cut tetrahedron, non-linear [µs] | 3 | {span(cuts('nonlinear', 1), 'us_per_tet')} |"),
    (KERNELS, lambda: f"| tensor-mass [µs] | 3 | {span(cuts('tensor-mass', 1), 'us_per_tet')} |"),
    (KERNELS, lambda: f"| a cut at 998,250 over that at 48,000 | 1 | "
                f"{one('cut', 'us_per_tet', region='nonlinear', batch=1, tets=998250) / one('cut', 'us_per_tet', region='nonlinear', batch=1, tets=48000):.1f} |"),
    (KERNELS, lambda: f"| 150 | {kernel('step', 'world_bytes_per_tet', tets=998250):.0f} | indices"),
    (KERNELS, lambda: f"times real time | 1 | {realtime(50244, 2):.2f}; {realtime(50244, 2, 'undisturbed_factor'):.2f} undisturbed |"),
    (CUTS, lambda: f"Non-linear region: one by one {span(cuts('nonlinear', 1), 'us_per_tet')} µs per tetrahedron, in batches "
                f"of 100 {span(cuts('nonlinear', 100), 'us_per_tet')} µs."),
    (CUTS, lambda: f"Tensor-mass region: one by one {span(cuts('tensor-mass', 1), 'us_per_tet')} µs"),
    (CUTS, lambda: f"takes {cuts('precomputed liver', 100)[0]['us_per_tet'] / 1000:.2f} ms per tetrahedron, the cube of 10,368 "
                f"(312 vertices) {cuts('precomputed', 100)[0]['us_per_tet'] / 1000:.2f} ms. In batches of 10 it is "
                f"{cuts('precomputed liver', 10)[0]['us_per_tet'] / 1000:.1f} and {cuts('precomputed', 10)[0]['us_per_tet'] / 1000:.1f} ms"),
    (REAL_TIME, lambda: f"With the lobe held still, a step costs {span(rows('resting', part='resting'), 'gain')} times less"),
    (REAL_TIME, lambda: f"At most {span(rows('realtime', threads=1), 'local_step_gain', 0, 100).replace('115', '15').replace('116', '15').replace('117', '17')} % of the evaluations"),
    (REAL_TIME, lambda: f"costs {one('frames', 'over_steps', frame_ms=1):.2f} times its two steps"),
    (HYBRIDS, lambda: f"Tensor-mass in its place gains {span(rows('hybrid', representation='tensor-mass'), 'speedup')}."),
    (HYBRIDS, lambda: f"costs an error of {span(rows('hybrid', representation='precomputed'), 'error_transient', 1, 100)} % in motion"),
    (GESTURES, lambda: f"They are {span(corrected(tets__ge=10000), 'speedup')} times as fast as all non-linear with lumped masses "
                f"({span(corrected(tets=2925), 'speedup')} at 2,925 tetrahedra)."),
    (GESTURES, lambda: f"the largest error of any frame is {span(corrected(tets__ge=10000), 'largest_error', 1, 100)} %, the mean "
                f"error {span(corrected(tets__ge=10000), 'mean_error', 1, 100)} %, declared or not. The slowest frame takes "
                f"{span(corrected(tets__ge=10000), 'worst_frame')} times"),
    (GESTURES, lambda: f"the largest error is {span(corrected(tets=2925), 'largest_error', 1, 100)} %"),
    (GESTURES, lambda: "declared, at 10,299: " + percent(one('gestures', 'largest_error', scene='liver_declared', tets=10299,
                                                      regions='selective-mass-corrected', tolerance=0.01))),
    (GESTURES, lambda: f"is {span(alone(), 'speedup')} times as fast, but wrong by {span(alone(), 'largest_error', 0, 100)} %"),
    (GESTURES, lambda: "go from {} times the speed at {}".format(*front("precomputed-corrected", 0.01))),
    (GESTURES, lambda: "over {} at {}, {} at {} and {} at {} (selective masses".format(
        *(x for t in (0.01, 0.02, 0.05) for x in front("selective-mass-corrected", t)))),
    (GESTURES, lambda: "to {} at {} (not corrected)".format(*front("selective-mass-alone", 0.02))),
    (KERNELS, lambda: f"With fibres a tetrahedron there takes {ends(over_svk('svk_fibre', 'single'), '.2f')} times as long as `svk` "
                f"in single precision and {ends(over_svk('svk_fibre', 'double'), '.2f')} in double"),
    (KERNELS, lambda: "Two terms of a Prony series take "
                f"{ends(over_svk('svk_prony', 'single'), '.2f')} times as long "
                f"in single precision and {ends(over_svk('svk_prony', 'double'), '.2f')} in double"),
    ("docs/theory/24_viscosity.md", lambda: "Edge-smoothed tetrahedra take "
                f"{ends(over('svk_smoothed', 'svk_smoothed_prony', 'single'), '.2f')} and "
                f"{ends(over('svk_smoothed', 'svk_smoothed_prony', 'double'), '.2f')} times as long with them"),
    ("docs/theory/24_viscosity.md", lambda: "Two terms of a Prony series take "
                f"{ends(over_svk('svk_prony', 'single'), '.2f')} times as long "
                f"in single precision and {ends(over_svk('svk_prony', 'double'), '.2f')} in double"),
    (GESTURES, lambda: f"for tensor-mass regions {watching('proposed', 10299)} % at 10,299 tetrahedra, "
                f"{watching('proposed', 50247)} % at 50,247"),
    (GESTURES, lambda: f"up to {high(rows('gestures', regions='precomputed-corrected', tets=10299), 'watching') * 100:.0f} % "
                f"({high(rows('gestures', regions='precomputed-corrected', tets=2925), 'watching') * 100:.0f} % at 2,925)"),
    (GESTURES, lambda: f"masses {span(rows('gestures', regions='selective-mass-corrected', tets=[10299, 12022]), 'watching', 1, 100)} % "
                f"at 10,299 and 12,022, {watching('selective-mass-corrected', 50247)} % at 50,247"),
    (REAL_TIME, lambda: f"`page.csv` has {page('p50_ms')[0]} and {page('p95_ms')[0]} ms all by software, and {page('p50_ms')[1]} and "
                f"{page('p95_ms')[1]} ms where only WebGL is by software"),
    (GESTURES, lambda: f"Undeclared ones: {ends(held('liver_undeclared', tets__ge=10000), '.1f')} times the tolerance "
                f"({held('liver_undeclared', tets=2925)[0]:.1f} times at 2,925). The mean error is at most "
                f"{max(held(None, 'mean_error')):.1f} times the tolerance"),
    (GESTURES, lambda: f"It is {ends(held('liver_undeclared', 'speedup'), '.1f')} times as fast in the undeclared scene. The slowest "
                f"frame takes {ends(held(None, 'worst_frame'), '.1f')} times that of all non-linear"),
    (GESTURES, lambda: f"It is expanded in {100 * min(held(None, 'expanded', tets__le=12022)):.0f} to "
                f"{100 * max(held(None, 'expanded', tets__le=12022)):.0f} % of the frames up to 12,022 tetrahedra"),
    (GESTURES, lambda: f"is expanded in {100 * held('liver_undeclared', 'expanded', tets=50247)[0]:.0f} % of the undeclared frames"),
    (GESTURES, lambda: "the same regions are wrong by up to {:.0f} % right after letting go (`precomputed-alone`, "
                "`proposed-precomputed`), at up to {:.1f} times the speed. A frame in which they are cut takes up to {:.0f} "
                "times".format(*(f * high(rows("gestures", regions=["precomputed-alone", "proposed-precomputed"]), column)
                                 for f, column in ((100, "largest_error"), (1, "speedup"), (1, "worst_frame"))))),
    (GESTURES, lambda: f"it makes {ends([more_linear('liver_declared', t) for t in (0.01, 0.02, 0.05)], '.1f')} times as much of the "
                f"volume linear"),
    (GESTURES, lambda: "it is {:.2f} times as much for 1 %, {:.2f} times for 2 % and {:.2f} times for 5 %".format(
        *(more_linear("liver_undeclared", t) for t in (0.01, 0.02, 0.05)))),
    (REAL_TIME, lambda: f"It is {percent(session(2103, 'overhead'))} at 2,103 tetrahedra ({session(2103, 'session_us') - session(2103, 'bare_us'):.0f} "
                f"of {session(2103, 'bare_us'):.0f} µs), {percent(session(10299, 'overhead'))} at 10,299"),
    (REAL_TIME, lambda: f"a picture takes {session(2103, 'publish_us'):.0f} µs, the digest and the record "
                f"{session(2103, 'seal_us') + session(2103, 'keep_us'):.0f} µs"),
    (REAL_TIME, lambda: f"with the page open runs at {span(rows('page'), 'possible_factor')} times real time"),
    (NODAL_PRESSURE, lambda: f"| 0.3 | {beam('ν = 0.3, 2 cells across')} |"),
    (NODAL_PRESSURE, lambda: f"| 0.45 | {beam('ν = 0.45, 2 cells across, locked')} |"),
    (NODAL_PRESSURE, lambda: f"| 0.499 | {beam('ν = 0.499, 2 cells across, locked')} (7.14) | 19.91 | "
                f"{beam('ν = 0.499, 2 cells across, nodal pressure 0.985')} | "
                f"{beam('ν = 0.499, 2 cells across, nodal pressure 1')} ({beam('ν = 0.499, 4 cells across, nodal pressure 1')}) |"),
    (GESTURES, lambda: f"At 2,925 tetrahedra the tolerance is not kept: the largest error is "
                f"{span(corrected(tets=2925), 'largest_error', 1, 100)} %"),
] + claims_choice.CLAIMS + claims_scalpel.CLAIMS

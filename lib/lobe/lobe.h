// What an application usually needs, in one header; contact/ and haptic/ have headers of their own. The
// theory (docs/theory.md) says which section belongs to which folder:
//   mesh/         tetrahedra, topology and surface that follow cuts, quality
//   numerics/     sparse factors, dense products, highest eigenvalues
//   fem/          the mathematics of one element, and the elements of a body
//   setup/        the setup of a world: a body, its loads, its held vertices, its tools
//   region/       tensor-mass, non-linear and corotational regions that share vertices
//   condense/     pre-computed linear regions, condensed to what they share with others
//   lattice/      reduced regions: a lattice moves most of their vertices
//   body/         a body, its state, its loads
//   forces/       what acts on a body: its regions, forces from outside
//   cut/          tetrahedra that an instrument touches
//   scalpel/      blades that divide tetrahedra into grains
//   tool/         grasps, cauteries, scalpels, probes and needles, on paths or moved by hand
//   contact/      contact with tools, with obstacles and of the body with itself
//   time/         the explicit scheme: inertia, stable step, sleep, tangles
//   organ/        a body that edits itself: cuts, changes of region, grasps, and what follows them
//   sim/          World: frames, tools, commands, checkpoints
//   solve/        static equilibrium, implicit steps
//   fit/          parameters of materials from measurements
//   linearity/    errors of linear regions: regions for declared gestures, corrected while they run
//   scene/        JSON to plain structs to a setup
//   io/           meshes in and out
//   file/         files written whole or not at all, and lobe's own binary format
//   diagnostics/  strain, stress, volume, differences between results
//   snapshot/     snapshots of a running simulation, for other threads
//   skin/         a fine textured surface that the tetrahedra carry
//   run/          a scene played, recorded and reported
//   live/         a session: a world that follows the clock while people lead its tools
//   haptic/       forces for haptic devices, 1,000 times a second
//
// Glossary. One word for one thing, here and in docs/README.md:
//   body: what is simulated: one mesh with its materials, regions and loads; an organ.
//   mesh: the tetrahedra of a body and the rest positions of its vertices.
//   label: a whole number that each tetrahedron of a mesh has, by which a scene selects parts of the body.
//   selector: what stands at "where" in a scene: a place, a label or a name that selects tetrahedra,
//     vertices or faces.
//   gate: what a mesh has to pass: angles, altitudes, dt* and distances from the surface.
//   dt*: stable step of a mesh at rest over the time in which a pressure wave runs along the edge of a
//     regular tetrahedron of its mean volume; it depends on shape alone.
//   world: a body that is being simulated: its state, its tools and its time; C++ class World.
//   scene: a JSON file that says what a world starts from and what happens in it.
//   setup: a scene resolved on one mesh, as plain arrays, from which a world is built; C++ struct Setup.
//   rest position: where a vertex is without loads [m].
//   rest shape: the shape of a body without loads; an image shows another one, under weight and pressure.
//   displacement: present position less rest position [m].
//   region: a part of a body that is computed by one model; several regions may have the same model.
//   non-linear region: a region of tetrahedra of a non-linear law (St Venant-Kirchhoff, neo-Hookean, Yeoh,
//     Mooney-Rivlin, Holzapfel), for large displacements and rotations.
//   SVK: the law of St Venant and Kirchhoff, that of materials that name no other.
//   plain tetrahedron: a tetrahedron of four nodes with a strain of its own; P1 in other programs.
//   quadratic tetrahedron: a tetrahedron of ten nodes; static solutions with these stand for the truth of
//     a mesh.
//   edge-smoothed tetrahedron: a tetrahedron whose law is evaluated on averages around its edges; on the same
//     mesh nearer to the truth than a plain one.
//   smoothing domain: an edge with a sixth of each tetrahedron around it, over which edge-smoothed tetrahedra
//     average.
//   nodal pressure: pressure from averages around vertices in place of single tetrahedra, so that nearly
//     incompressible tissue does not lock.
//   linear region: a tensor-mass or a pre-computed region; right for small strains with little rotation, or
//     with a corotated frame also where it turns as a whole.
//   tensor-mass region: a linear region that moves with its own inertia; not the paper's non-linear
//     tensor-mass model, which is another way to compute the forces of a non-linear region.
//   pre-computed region: a linear region that is condensed to its interface; precomputed in scenes.
//   interface: the vertices that a region shares with other regions.
//   condense: to eliminate the interior of a linear region, so that only its interface remains (static
//     condensation).
//   relinearise: to linearise a pre-computed region again about the present displacement.
//   expand: to make a pre-computed region non-linear for a while; an expandable region is set up for
//     that.
//   corotational region: a region of tetrahedra of the linear law in the frame of their rotations; right for
//     small strains however far they turn.
//   reduced region: a region with the law of a non-linear one, whose vertices mostly follow a coarse
//     lattice; for motion that is smooth across a cell.
//   lattice: cubic cells over reduced regions, with nodes at their corners.
//   embedded vertex: a vertex that follows the nodes of a lattice.
//   full: not moved by the lattice: a full vertex moves by itself, a full tetrahedron is evaluated as
//     it is.
//   zone: a connected group of tetrahedra that changes its model as a whole.
//   piece: tetrahedra that are connected by faces; a loose piece is one that nothing holds.
//   contact patch: the tetrahedra around what a haptic tool touches, whose stiffness it feels.
//   patch: up to 512 tetrahedra, or 1024 edges of a tensor-mass region, that are evaluated together; neither
//     a contact patch nor the patch test.
//   own steps: steps whose length differs from part to part of a body, each a power of two of the shortest.
//   level: of a patch with own steps: it steps once in 2^level of the shortest steps.
//   kernel: the loop that computes the forces of one kind of tetrahedra or edges in a patch.
//   held vertex: a vertex whose position the boundary conditions prescribe.
//   partly held vertex: a vertex of which a share lies in what is held ("hold_by"); a spring draws it to its
//     prescribed position.
//   driven vertex: a held vertex whose prescribed position moves.
//   free vertex: a vertex that nothing holds.
//   grasped vertex: a vertex that moves with a tool.
//   tool: a grasp, a cautery, a scalpel, a probe, a clip applier or a needle, on a path or moved by hand.
//   grasp: a tool that takes hold of vertices and moves them.
//   cautery: a tool that burns away the tetrahedra it touches.
//   hook: a straight wire at the tip of a cautery, which burns all along.
//   scalpel: a tool that divides tetrahedra with an edge.
//   lips: the two sides of a cut or slit, where they lie on each other.
//   probe: a rigid tool that presses on tissue and rubs along it, or a pair of jaws.
//   obstacle: a rigid body that does not move, such as a table.
//   held depth: what a contact's law adds to its depth; it grows while the contact is deep, until the
//     contact bears its load at no depth.
//   lead: to move a tool by hand, to a new pose in each frame.
//   hand: what moves one tool in a session; a controller names each of its hands by a number.
//   controller: a person or program that has hands in a session.
//   gesture: a motion or force that acts on the body; a declared gesture stands in the scene, and
//     regions are chosen for it.
//   frame: the simulated time of one call of advance(). Cuts and edits happen at its start; tools move
//     during it. An output frame is a file of a run, and a corotated frame turns with a region.
//   step: one advance of the integrator; with the explicit one a frame takes as many as stability needs.
//   stable step: the longest step in which an error does not grow: 2/ω_max, with ω_max the highest
//     frequency of the body [rad/s].
//   pace: how long a step a part of a body could take if it stepped alone.
//   level: of a tetrahedron or patch: the power of two by which its steps could be longer than those of its
//     body.
//   diagonal stiffness: the stiffness that each vertex feels when it moves while its neighbours are
//     held.
//   force term: a force on a body besides those of its regions, its weight and its loads: contact, threads,
//     attachments, or one of an application.
//   lumped mass: a diagonal mass matrix, a quarter of each tetrahedron's mass at each corner.
//   selective mass: inertia that is larger for short waves, so that steps may be longer.
//   mass floor: mass added where a blade has divided tetrahedra, so that the stable step should not shrink
//     below a set share (cut_step).
//   watch: the part of lobe that estimates an error while a scene runs, and asks for corrections.
//   corrected: of regions or masses that a watch changes while a scene runs, where it estimates too large
//     an error.
//   total error: by how much results differ from those of the same body on a far finer mesh, or one of
//     quadratic tetrahedra: the error of mesh, element, models of regions and of what is held.
//   sleep: the state of parts that do not move, which are not evaluated until they do.
//   guard: an energy that keeps crushed non-linear tetrahedra from collapsing.
//   volume ratio: present over rest volume of a tetrahedron; negative if it is inverted.
//   Prony series: up to three terms, each a share of the moduli at once that relaxes in a time; the
//     viscosity of a material.
//   branch: a spring in series with a dashpot beside a solid: one term of a Prony series.
//   at once: to what is sudden, before anything relaxes: instantaneous moduli; slow ones are those after long
//     rest, long-term moduli.
//   tangle: neighbouring tetrahedra that are crushed or inverted and keep each other so; the world unravels
//     it.
//   surface: the boundary triangles of the tetrahedra, with cut faces; for drawing and contact.
//   skin: a finer textured surface that the tetrahedra carry.
//   snapshot: state, surface, tools and figures of one moment, copied for other threads.
//   attachment: what ties bodies to each other or to the world, and may tear: a set of strands.
//   strand: a straight elastic connection between two points of the tissue, or from one to the world.
//   bite: a point of the tissue through which a thread passes.
//   needle: an arc that punctures the surface, guides the tissue that it goes through, and leaves bites.
//   hold: a point of the tissue that is on a needle: an entry, an exit, or one between them.
//   bed: strands that cover a part of the surface.
//   clip: two legs that hold a duct closed; a clip applier closes it.
//   carrier: a body in which blood or bile flows, and which bleeds or leaks where it is cut.
//   event: what tore, broke, burnt, was clipped or pierced, bleeds or leaks in a frame, with its place and
//     size.
//   grain: a part of a tetrahedron that a scalpel has cut.
//   stroke: the path of a blade from where it begins to cut to where it stops.
//   crumb: a tiny part that a blade would cut off; it stays attached.
//   condition: something unusual that happened in a frame; the report gives its name and text, with a remedy
//     where there is one.
//   checkpoint: all that has changed in a world since it was built; a world of the same setup goes on from
//     it with the same bits.
//   journal: the edits of a world since it was built.
//   same bits: results that are equal to the last digit.
//   digest: a 64-bit number that is computed from a state; if any bit of the state differs, it almost
//     certainly differs.
//   recording: the calls made to a world, with a digest after each, which a replay compares.
//   session: a world that controllers command from any thread, usually in step with the clock.
//   local model: what a haptic loop knows of the tissue until the next frame: a force, its place and a
//     stiffness.
//
// Symbols (SI units):
//   X rest position [m]; x present position [m]; u = x − X displacement [m]; v velocity [m/s]
//   f force that acts ON a vertex [N]
//   α_j gradient of the barycentric coordinate of vertex j [1/m]
//   F = I + Σ u_j ⊗ α_j deformation gradient; E Green's strain; S second Piola-Kirchhoff stress [Pa]
//   λ, μ Lamé coefficients [Pa]; κ volume penalty [Pa]; ρ density [kg/m³]; V rest volume [m³]
// [PDA]: G. Picinbono, H. Delingette, N. Ayache, Real-Time Large Displacement Elasticity for Surgery
// Simulation: Non-Linear Tensor-Mass Model; its errata are in docs/errata.md.
#pragma once

#include "lobe/condense/interface_size.h"
#include "lobe/condense/narrow_interface.h"
#include "lobe/condense/supports.h"
#include "lobe/diagnostics/body_figures.h"
#include "lobe/diagnostics/body_overlap.h"
#include "lobe/diagnostics/compare.h"
#include "lobe/diagnostics/fields.h"
#include "lobe/diagnostics/grain_frame.h"
#include "lobe/diagnostics/locate.h"
#include "lobe/error.h"
#include "lobe/fem/fibre_fields.h"
#include "lobe/fem/law.h"
#include "lobe/fem/law_of.h"
#include "lobe/fit/fit.h"
#include "lobe/fit/sensitivity.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/io/labelled_mesh.h"
#include "lobe/io/mesh_io.h"
#include "lobe/io/surface_io.h"
#include "lobe/linearity/mass_watch.h"
#include "lobe/linearity/proposal.h"
#include "lobe/linearity/reduced_watch.h"
#include "lobe/linearity/total_error.h"
#include "lobe/linearity/trials.h"
#include "lobe/linearity/watch.h"
#include "lobe/live/pick.h"
#include "lobe/live/session_scene.h"
#include "lobe/live/sewing.h"
#include "lobe/mesh/generators.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/mesh/quality.h"
#include "lobe/mesh/refine.h"
#include "lobe/mesh/surface.h"
#include "lobe/run/recording.h"
#include "lobe/run/run.h"
#include "lobe/run/solve.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/check_scene.h"
#include "lobe/scene/default_element.h"
#include "lobe/scene/describe.h"
#include "lobe/scene/frames.h"
#include "lobe/scene/material_constants.h"
#include "lobe/scene/parse_tool.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/rest_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/schema.h"
#include "lobe/scene/select.h"
#include "lobe/scene/tissues.h"
#include "lobe/scene/write_scene.h"
#include "lobe/setup/exclusions.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/rebuild.h"
#include "lobe/sim/rest_time_step.h"
#include "lobe/sim/validate.h"
#include "lobe/sim/world.h"
#include "lobe/skin/skin.h"
#include "lobe/snapshot/snapshot.h"
#include "lobe/snapshot/triple_buffer.h"
#include "lobe/solve/modes.h"
#include "lobe/solve/quadratic_solver.h"
#include "lobe/solve/rest_shape.h"
#include "lobe/solve/static_solver.h"

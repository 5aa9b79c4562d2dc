#include "lobe/scene/resolve.h"

#include <algorithm>
#include <set>

#include "lobe/condense/interface_size.h"
#include "lobe/condense/supports.h"
#include "lobe/lattice/lattice.h"
#include "lobe/scene/check_scene.h"
#include "lobe/scene/default_element.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/setup/exclusions.h"

namespace lobe {
namespace {

// Pre-computed regions have one dense matrix in common, and so one frame.
void resolve_frame(Resolution& resolution) {
  const std::vector<Region>& regions = resolution.scene.regions;
  const Region* first = nullptr;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const bool is_precomputed = regions[i].model == RegionModel::precomputed;
    const std::string place = "/regions/" + std::to_string(i) + "/frame";
    if (!is_precomputed && regions[i].frame == RegionFrame::corotated)
      resolution.fail(place, "\"corotated\" needs \"model\": \"precomputed\"");
    if (!is_precomputed) continue;
    if (!first) first = &regions[i];
    if (regions[i].frame != first->frame)
      resolution.fail(place, "all precomputed regions have one frame in common; give all of them the same");
  }
  if (first) resolution.result.setup.precomputed_frame = first->frame;
}

// Reduced regions have one lattice in common.
void resolve_cell(Resolution& resolution) {
  const std::vector<Region>& regions = resolution.scene.regions;
  const Region* first = nullptr;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const bool is_reduced = regions[i].model == RegionModel::reduced;
    const std::string place = "/regions/" + std::to_string(i);
    if (!is_reduced && regions[i].cell > 0) resolution.fail(place + "/cell", "needs \"model\": \"reduced\"");
    if (!is_reduced && regions[i].tolerance > 0)
      resolution.fail(place + "/tolerance", "needs \"model\": \"reduced\"");
    if (!is_reduced) continue;
    if (!first) first = &regions[i];
    if (regions[i].cell != first->cell)
      resolution.fail(place + "/cell",
                      "all reduced regions have one lattice in common; give all of them the same cells");
    if (regions[i].tolerance != first->tolerance)
      resolution.fail(place + "/tolerance",
                      "the error of all reduced regions is estimated together; give all of them the same");
  }
  if (first) resolution.result.setup.lattice_cell = first->cell;
}

// Cells that do not suit the tetrahedra are refused.
void check_reduced(const Resolution& resolution) {
  const Setup& setup = resolution.result.setup;
  const auto is_reduced = [](const Region& region) { return region.model == RegionModel::reduced; };
  const auto region =
      std::find_if(resolution.scene.regions.begin(), resolution.scene.regions.end(), is_reduced);
  if (region == resolution.scene.regions.end()) return;
  try {
    choose_lattice(Elements(setup), setup.lattice_cell);
  } catch (const InputError& error) {
    throw InputError("/regions/" + std::to_string(region - resolution.scene.regions.begin()) + "/cell",
                     error.faults().front().message);
  }
}

// Warns of an interface that costs more than the tetrahedra behind it. With a frame that turns there is no
// other way, so there is no warning.
void suspect_interface(Resolution& resolution, const Elements& elements) {
  if (resolution.result.setup.precomputed_frame == RegionFrame::corotated) return;
  constexpr double numbers_per_tet = 25;  // of the matrix, that are read in the time of a tensor-mass one
  const InterfaceSize size = interface_size(elements);
  const double components = 3.0 * size.vertices, numbers = components * (components + 1) / 2;
  if (numbers <= 2 * numbers_per_tet * size.tets) return;
  resolution.warn("/regions",
                  "the precomputed region shares " +
                      counted(std::size_t(size.vertices), "vertex", "vertices") +
                      " with others, so that each step reads a matrix of " + rounded(numbers) +
                      " numbers; its " + counted(std::size_t(size.tets), "tetrahedron", "tetrahedra") +
                      " would likely be faster as tensor-mass; let it end at a narrower part, or make it "
                      "tensor-mass");
}

// Refuses a region that nothing holds in place.
void check_precomputed(Resolution& resolution) {
  const Setup& setup = resolution.result.setup;
  if (!std::count(setup.region_of.begin(), setup.region_of.end(), RegionModel::precomputed)) return;
  const Elements elements(setup);
  refuse_unsupported(elements, held_by(setup.prescribed));
  suspect_interface(resolution, elements);
}

std::string triple(const Vec3d& v) {
  return "[" + rounded(v[0]) + ", " + rounded(v[1]) + ", " + rounded(v[2]) + "]";
}

std::string labels_of(const TetMesh& mesh) {
  const std::set<int> labels(mesh.labels.begin(), mesh.labels.end());
  std::string text;
  for (const int label : labels) {
    if (text.size() > 60) return text + ", …";
    text += (text.empty() ? "" : ", ") + std::to_string(label);
  }
  return text;
}

// Distributes tetrahedra among entries; the first match wins. `assign(entry, tet)` for each; returns what is
// left.
template <class Entry, class Assign>
std::vector<char> first_match(Resolution& resolution, const std::vector<Entry>& entries, const char* list,
                              const Assign& assign) {
  std::vector<char> left(static_cast<std::size_t>(resolution.mesh().tet_count()), 1);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i].where) continue;
    const std::string place = list + std::to_string(i) + "/where";
    const std::size_t faults_before = resolution.faults.size();
    const std::vector<Index> tets =
        resolution.selected([&] { return select_tets(*entries[i].where, resolution.mesh(), place); });
    if (resolution.faults.size() > faults_before) continue;
    if (tets.empty()) resolution.fail_empty(place, "tetrahedron");
    std::size_t taken = 0;
    for (const Index t : tets) {
      char& free = left[static_cast<std::size_t>(t)];
      if (!free) continue;
      free = 0;
      assign(i, static_cast<std::size_t>(t));
      ++taken;
    }
    if (taken == 0 && !tets.empty()) {
      resolution.warn(place, "earlier entries have taken all of its " +
                                 counted(tets.size(), "tetrahedron", "tetrahedra"));
    }
  }
  return left;
}

}  // namespace

void Resolution::fail_empty(const std::string& place, const char* what) {
  const auto [low, high] = bounding_box(mesh());
  fail(place, std::string("selects no ") + what + "; the mesh spans " + triple(low) + " to " + triple(high) +
                  " m, its labels are " + labels_of(mesh()));
}

void resolve_materials(Resolution& resolution) {
  const std::vector<Material>& materials = resolution.scene.materials;
  Setup& setup = resolution.result.setup;
  setup.material_of.assign(static_cast<std::size_t>(setup.mesh.tet_count()), 0);
  for (const Material& m : materials)
    setup.materials.push_back(elastic_of(with_default_element(resolution.scene, m)));

  std::size_t standard = materials.size();
  for (std::size_t i = materials.size(); i-- > 0;) {
    if (!materials[i].where) standard = i;
  }
  for (std::size_t i = standard + 1; i < materials.size(); ++i) {
    if (materials[i].where) continue;
    resolution.warn("/materials/" + std::to_string(i),
                    "never used: /materials/" + std::to_string(standard) + " is the default already");
  }
  const std::size_t faults_before = resolution.faults.size();
  const std::vector<char> left =
      first_match(resolution, materials, "/materials/", [&](std::size_t entry, std::size_t tet) {
        setup.material_of[tet] = static_cast<std::uint16_t>(entry);
      });
  std::size_t unmatched = 0, example = 0;
  for (std::size_t t = left.size(); t-- > 0;) {
    if (!left[t]) continue;
    setup.material_of[t] = static_cast<std::uint16_t>(standard);
    ++unmatched;
    example = t;
  }
  if (standard == materials.size() && unmatched > 0 && resolution.faults.size() == faults_before) {
    resolution.fail("/materials", counted(unmatched, "tetrahedron has", "tetrahedra have") +
                                      " no material (the first: " + std::to_string(example) +
                                      "); add one without \"where\" as the default");
  }
}

// An entry without `where` takes all that is left, so later entries get nothing: the first match wins.
void resolve_regions(Resolution& resolution) {
  const std::vector<Region>& regions = resolution.scene.regions;
  Setup& setup = resolution.result.setup;
  setup.region_of.assign(static_cast<std::size_t>(setup.mesh.tet_count()), RegionModel::nonlinear);
  std::vector<Region> reachable;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (!reachable.empty() && !reachable.back().where) {
      resolution.warn("/regions/" + std::to_string(i), "never used: /regions/" +
                                                           std::to_string(reachable.size() - 1) +
                                                           " has no \"where\" and takes everything");
    } else {
      reachable.push_back(regions[i]);
    }
  }
  std::vector<char> left =
      first_match(resolution, reachable, "/regions/",
                  [&](std::size_t entry, std::size_t tet) { setup.region_of[tet] = reachable[entry].model; });
  if (reachable.empty() || reachable.back().where) return;
  for (std::size_t t = 0; t < left.size(); ++t) {
    if (left[t]) setup.region_of[t] = reachable.back().model;
  }
}

namespace {

// Contact or blades may reach a pre-computed region: those of the scene, or of hands in a session of it.
void let_regions_expand(Setup& setup) {
  const Options used = options_of(setup);
  if (!used.has(Option::corotated) && !used.has(Option::nodal_pressure))
    setup.expandable = setup.expandable || used.has(option_of(RegionModel::precomputed));
}

}  // namespace

Resolved resolve(const Scene& scene, TetMesh mesh, const ResolveOptions& options) {
  check_scene(scene);
  if (mesh.tet_count() == 0) throw InputError(scene.mesh.string(), "the mesh has no tetrahedron");
  Resolution resolution{scene, {}, {}};
  Setup& setup = resolution.result.setup;
  setup.mesh = std::move(mesh);
  if (scene.mesh_scale != 1) setup.mesh.points *= scene.mesh_scale;
  setup.mesh.labels.resize(static_cast<std::size_t>(setup.mesh.tet_count()), 0);
  setup.gravity = scene.gravity;
  setup.volume_penalty = scene.volume_penalty;
  setup.guard_below = scene.guard_below;
  setup.loose_pieces = scene.loose_pieces;
  setup.damping = scene.time.damping;
  setup.safety = scene.time.safety;
  setup.cut_step = scene.time.cut_step;
  setup.selective_mass = scene.time.selective_mass;
  setup.integrator = scene.time.integrator;
  setup.implicit_step = scene.time.step;
  setup.spectral_radius = scene.time.spectral_radius;
  setup.ramp = scene.time.ramp;
  setup.load_ramp = scene.time.load_ramp;
  setup.sleep = scene.time.sleep.value_or(0);
  setup.own_steps = scene.time.own_steps;

  check_bodies(resolution);
  refuse_excluded_options(resolution);
  resolve_frame(resolution);
  resolve_cell(resolution);
  resolve_materials(resolution);
  if (resolution.faults.empty()) resolve_fibres(resolution);
  resolve_regions(resolution);
  resolve_boundary(resolution);
  resolve_carriers(resolution);
  resolve_tools(resolution);
  resolve_contact(resolution);
  for_each_kind(scene, [&]<class Force>(const std::vector<Force>& all) {
    if (!all.empty()) Force::resolve(all, resolution);
  });
  resolve_gestures(resolution);
  if (!resolution.faults.empty()) throw InputError(std::move(resolution.faults));
  warn_of_bodies(resolution);
  warn_of_unheld_pieces(resolution);
  warn_of_units(resolution);
  check_precomputed(resolution);
  check_reduced(resolution);
  if (options.choose_regions) choose_regions(resolution, options.progress);
  let_regions_expand(setup);
  return std::move(resolution.result);
}

}  // namespace lobe

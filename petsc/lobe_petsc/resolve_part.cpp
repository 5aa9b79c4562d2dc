#include "lobe_petsc/resolve_part.h"

#include <algorithm>
#include <string>

#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/select.h"
#include "lobe_petsc/ghosted.h"

namespace lobe::petsc {
namespace {

// Rewrites selectors so that on the part they select the same as on the whole mesh.
class Selection {
 public:
  enum class Kind { vertices, tets };

  Selection(const Ranks& ranks, const Part& part) : ranks_(ranks), part_(part), scratch_(ranks, part) {}

  std::vector<Index> tets(const Selector& selector, const std::string& place) {
    return select_tets(localised(selector, Kind::tets, place), part_.mesh, place);
  }
  std::vector<Index> vertices(const Selector& selector, const std::string& place) {
    return select_vertices(localised(selector, Kind::vertices, place), part_.mesh, place);
  }
  std::vector<TetFace> faces(const Selector& selector, const std::string& place) {
    return select_faces(localised(selector, Kind::vertices, place), part_.mesh, part_.outer, place);
  }

 private:
  Selector localised(const Selector& selector, Kind kind, const std::string& place) {
    return std::visit([&](const auto& select) { return local(select, kind, place); }, selector.value);
  }
  template <class Select>  // by position
  Selector local(const Select& select, Kind, const std::string&) {
    return {select};
  }
  Selector local(const SelectAnyOf& any, Kind kind, const std::string& place) {
    return {SelectAnyOf{all(any.parts, kind, place + "/any_of/")}};
  }
  Selector local(const SelectAllOf& every, Kind kind, const std::string& place) {
    return {SelectAllOf{all(every.parts, kind, place + "/all_of/")}};
  }
  Selector local(const SelectNot& negated, Kind kind, const std::string& place) {
    return {SelectNot{{localised(negated.part.at(0), kind, place + "/not")}}};
  }
  Selector local(const SelectLabel& select, Kind kind, const std::string& place) {
    return kind == Kind::tets ? Selector{select} : corners_of(select_tets({select}, part_.mesh, place));
  }
  Selector local(const SelectTetrahedra& select, Kind kind, const std::string& place) {
    std::vector<Index> numbers;
    for (std::size_t i = 0; i < select.tetrahedra.size(); ++i) {
      check_number(select.tetrahedra[i], part_.all_tets, "tetrahedra", i, place);
      if (const Index t = part_.tet_of(select.tetrahedra[i]); t >= 0) numbers.push_back(t);
    }
    return kind == Kind::tets ? Selector{SelectTetrahedra{numbers}} : corners_of(numbers);
  }
  Selector local(const SelectVertices& select, Kind, const std::string& place) {
    std::vector<Index> numbers;
    for (std::size_t i = 0; i < select.vertices.size(); ++i) {
      check_number(select.vertices[i], part_.all_vertices, "vertices", i, place);
      if (const Index v = part_.vertex_of(select.vertices[i]); v >= 0) numbers.push_back(v);
    }
    return {SelectVertices{numbers}};
  }
  Selector local(const SelectNearest& nearest, Kind kind, const std::string&);

  std::vector<Selector> all(const std::vector<Selector>& parts, Kind kind, const std::string& place) {
    std::vector<Selector> result;
    for (std::size_t i = 0; i < parts.size(); ++i)
      result.push_back(localised(parts[i], kind, place + std::to_string(i)));
    return result;
  }
  static void check_number(Index item, Index count, const char* what, std::size_t i,
                           const std::string& place) {
    if (item >= 0 && item < count) return;
    throw InputError(place + "/" + what + "/" + std::to_string(i),
                     std::to_string(item) + ", must be from 0 to " + std::to_string(count - 1) +
                         ": the mesh has " + std::to_string(count) + " " + what);
  }
  Selector corners_of(const std::vector<Index>& tets) {  // whatever rank has such a tetrahedron
    std::vector<char> chosen(std::size_t(part_.mesh.vertex_count()), 0);
    for (Index t : tets)
      for (int c = 0; c < 4; ++c) chosen[part_.mesh.tets(c, t)] = 1;
    chosen = any_rank(scratch_, chosen);
    SelectVertices list;
    for (std::size_t v = 0; v < chosen.size(); ++v)
      if (chosen[v]) list.vertices.push_back(Index(v));
    return {list};
  }

  const Ranks& ranks_;
  const Part& part_;
  Ghosted scratch_;
};

// Finds the nearest of each rank, and then the nearest of these.
Selector Selection::local(const SelectNearest& nearest, Kind kind, const std::string&) {
  struct Candidate {
    double distance;
    Index number;
    auto operator<=>(const Candidate&) const = default;
  };
  const bool vertices = kind == Kind::vertices;
  std::vector<Candidate> found_here;
  const Index count = vertices ? part_.owned : part_.mesh.tet_count();
  for (Index i = 0; i < count; ++i) {
    const Vec3d X = vertices ? Vec3d(part_.mesh.points.col(i)) : barycentre(part_.mesh, i);
    found_here.push_back(
        {(X - nearest.point).norm(), vertices ? part_.vertex_number[i] : part_.tet_number[i]});
  }
  const auto keep = [&](std::vector<Candidate>& list) {
    const std::size_t wanted = std::min(list.size(), std::size_t(std::max(0, nearest.count)));
    std::partial_sort(list.begin(), list.begin() + std::ptrdiff_t(wanted), list.end());
    list.resize(wanted);
  };
  keep(found_here);
  std::vector<Candidate> all = ranks_.gather(found_here);
  keep(all);
  std::vector<Index> here;
  for (const Candidate& c : all)
    if (const Index i = vertices ? part_.vertex_of(c.number) : part_.tet_of(c.number); i >= 0)
      here.push_back(i);
  return vertices ? Selector{SelectVertices{here}} : Selector{SelectTetrahedra{here}};
}

// Resolves the scene on the part by the steps of resolve(), with lists in place of selectors. An entry that
// selects nothing here is left out; one that selects nothing on any rank is a fault.
class PartResolver {
 public:
  PartResolver(const Ranks& ranks, const Scene& scene, const Part& part)
      : ranks_(ranks), scene_(scene), part_(part), selection_(ranks, part), local_(scene) {
    local_.tools.clear();
    local_.auto_regions.reset();
  }

  Setup run() {
    refuse_serial();
    localise_tets(scene_.materials, local_.materials, "/materials/");
    localise_tets(scene_.regions, local_.regions, "/regions/");
    // Ranks have no averages of several tetrahedra; materials that ask for one are refused above.
    for (Material& material : local_.materials) {
      material.element = ElementType::tetrahedron;
      material.nodal_pressure = 0;
    }
    for (Region& region : local_.regions)
      if (region.model == RegionModel::precomputed) region.model = RegionModel::tensor_mass;
    refuse_bare();
    localise_boundary();
    Resolution resolution{local_, {}, {}};
    Setup& setup = resolution.result.setup;
    setup.mesh = part_.mesh;
    setup.gravity = scene_.gravity;
    setup.volume_penalty = scene_.volume_penalty;
    setup.guard_below = scene_.guard_below;
    ranks_.together([&] {
      resolve_materials(resolution);
      if (resolution.faults.empty()) resolve_fibres(resolution);
      resolve_regions(resolution);
      resolve_boundary(resolution);
      if (!resolution.faults.empty()) throw InputError(std::move(resolution.faults));
    });
    setup.face_loads = std::move(face_loads_);
    std::erase_if(setup.vertex_loads, [&](const VertexLoad& load) { return load.vertex >= part_.owned; });
    return std::move(setup);
  }

 private:
  void refuse_serial() const {
    std::vector<Fault> faults;
    if (scene_.auto_regions)
      faults.push_back(
          {"/regions", "\"auto\" is chosen on one machine; list the regions, or solve with --solver eigen"});
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const std::string place = "/materials/" + std::to_string(i);
      if (scene_.materials[i].nodal_pressure > 0)
        faults.push_back({place + "/nodal_pressure",
                          "is not available with --solver petsc; solve with --solver eigen, or set it to 0"});
      if (scene_.materials[i].element == ElementType::edge_smoothed)
        faults.push_back(
            {place + "/element",
             "\"edge-smoothed\" is not available with --solver petsc; solve with --solver eigen"});
      if (scene_.materials[i].fibre && std::holds_alternative<FibreHarmonic>(*scene_.materials[i].fibre))
        faults.push_back({place + "/fibre/harmonic",
                          "is computed on one machine; write the directions to the mesh as the cell array "
                          "\"fibre\" and say \"array\""});
    }
    for (std::size_t i = 0; i < scene_.regions.size(); ++i)
      if (scene_.regions[i].frame == RegionFrame::corotated)
        faults.push_back({"/regions/" + std::to_string(i) + "/frame",
                          "an equilibrium has no motion that a frame could follow; leave \"corotated\" out"});
    if (!faults.empty()) throw InputError(std::move(faults));
  }

  template <class Item>
  void expect_some(std::int64_t count, const Item& what, const std::string& place) {
    if (count > 0) return;
    std::string box;
    for (int side = 0; side < 2; ++side) {
      box += side == 0 ? "[" : " to [";
      for (int i = 0; i < 3; ++i) {
        const double bound = side == 0 ? ranks_.min(part_.mesh.points.row(i).minCoeff())
                                       : ranks_.max(part_.mesh.points.row(i).maxCoeff());
        box += (i ? ", " : "") + rounded(bound);
      }
      box += "]";
    }
    throw InputError(place, std::string("selects no ") + what + "; the mesh spans " + box + " m");
  }

  template <class Entry>
  void localise_tets(const std::vector<Entry>& entries, std::vector<Entry>& local, const std::string& list) {
    local.clear();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      Entry entry = entries[i];
      if (entry.where) {
        const std::string place = list + std::to_string(i) + "/where";
        std::vector<Index> tets = selection_.tets(*entry.where, place);
        expect_some(ranks_.sum(std::int64_t(tets.size())), "tetrahedron", place);
        if (tets.empty()) continue;
        entry.where = Selector{SelectTetrahedra{std::move(tets)}};
      }
      local.push_back(std::move(entry));
    }
  }

  // Every tetrahedron needs a material.
  void refuse_bare() const {
    std::vector<char> bare(std::size_t(part_.mesh.tet_count()), 1);
    for (const Material& material : local_.materials) {
      if (!material.where) return;
      for (Index t : std::get<SelectTetrahedra>(material.where->value).tetrahedra) bare[t] = 0;
    }
    const auto count = ranks_.sum(std::int64_t(std::count(bare.begin(), bare.end(), 1)));
    const auto at = std::find(bare.begin(), bare.end(), 1);
    const double first =
        ranks_.min(at == bare.end() ? 1e18 : part_.tet_number[std::size_t(at - bare.begin())]);
    if (count > 0)
      throw InputError("/materials", counted(std::size_t(count), "tetrahedron has", "tetrahedra have") +
                                         " no material (the first: " + std::to_string(Index(first)) +
                                         "); add one without \"where\" as the default");
  }

  void localise_boundary() {
    local_.boundary.clear();
    for (std::size_t i = 0; i < scene_.boundary.size(); ++i) {
      Boundary entry = scene_.boundary[i];
      const std::string place = "/boundary/" + std::to_string(i) + "/where";
      if (entry.kind == Boundary::Kind::pressure)
        throw InputError("/boundary/" + std::to_string(i),
                         "lobe-petsc knows no pressure that turns with the body");
      if (entry.kind == Boundary::Kind::traction) {
        const std::vector<TetFace> faces = selection_.faces(entry.where, place);
        expect_some(ranks_.sum(std::int64_t(faces.size())), "boundary face", place);
        for (const TetFace& face : faces) face_loads_.push_back({face.tet, face.face, entry.value});
        continue;
      }
      std::vector<Index> vertices = selection_.vertices(entry.where, place);
      const auto owned = std::lower_bound(vertices.begin(), vertices.end(), part_.owned) - vertices.begin();
      const std::int64_t all = ranks_.sum(std::int64_t(owned));
      expect_some(all, "vertex", place);
      if (vertices.empty()) continue;
      // All vertices of the selection have an equal share of a force. resolve() would share it among those of
      // this rank only.
      if (entry.kind == Boundary::Kind::force) entry.value *= double(vertices.size()) / double(all);
      entry.where = Selector{SelectVertices{std::move(vertices)}};
      local_.boundary.push_back(std::move(entry));
    }
  }

  const Ranks& ranks_;
  const Scene& scene_;
  const Part& part_;
  Selection selection_;
  Scene local_;
  std::vector<FaceLoad> face_loads_;
};

}  // namespace

Setup resolve_part(const Ranks& ranks, const Scene& scene, const Part& part) {
  return PartResolver(ranks, scene, part).run();
}

Setup restrict_setup(const Setup& whole, const Part& part) {
  Setup setup;
  static_cast<Body&>(setup) = whole;
  setup.mesh = part.mesh;
  setup.gravity = whole.gravity;
  setup.material_of.clear();
  setup.region_of.clear();
  setup.shares.clear();
  for (Index t : part.tet_number) {
    setup.material_of.push_back(whole.material_of[t]);
    setup.region_of.push_back(whole.region_of[t]);
    if (!whole.shares.empty()) setup.shares.push_back(whole.shares[t]);
  }
  for (RegionModel& model : setup.region_of)
    if (model == RegionModel::precomputed) model = RegionModel::tensor_mass;
  for (PrescribedVertex held : whole.prescribed)
    if (const Index v = part.vertex_of(held.vertex); v >= 0) {
      held.vertex = v;
      setup.prescribed.push_back(held);
    }
  for (FaceLoad load : whole.face_loads)
    if (const Index t = part.tet_of(load.tet); t >= 0) {
      load.tet = t;
      setup.face_loads.push_back(load);
    }
  for (VertexLoad load : whole.vertex_loads)
    if (const Index v = part.vertex_of(load.vertex); v >= 0 && v < part.owned) {
      load.vertex = v;
      setup.vertex_loads.push_back(load);
    }
  return setup;
}

}  // namespace lobe::petsc

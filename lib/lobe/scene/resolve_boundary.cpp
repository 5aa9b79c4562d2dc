#include <algorithm>
#include <array>

#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/select_shares.h"

namespace lobe {
namespace {

constexpr int nobody = -1;

class BoundaryResolver {
 public:
  explicit BoundaryResolver(Resolution& resolution)
      : resolution_(resolution),
        setup_(resolution.result.setup),
        holder_(static_cast<std::size_t>(setup_.mesh.vertex_count()), {nobody, nobody, nobody}) {}

  void run() {
    const std::vector<Boundary>& entries = resolution_.scene.boundary;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (is_held(entries[i]))
        prescribe(entries[i], static_cast<int>(i));
      else if (entries[i].hold_by != HoldBy::vertices)
        resolution_.fail(place(i) + "/hold_by", "only \"fix\" and \"displacement\" hold");
    }
    write_prescribed();
    write_entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].kind == Boundary::Kind::force) share_force(entries[i], place(i));
      if (entries[i].kind == Boundary::Kind::traction) load_faces(entries[i], place(i));
      if (entries[i].kind == Boundary::Kind::pressure) press_faces(entries[i], place(i));
    }
  }

 private:
  static bool is_held(const Boundary& entry) {
    return entry.kind == Boundary::Kind::fix || entry.kind == Boundary::Kind::displacement;
  }
  static Vec3d displacement(const Boundary& entry) {
    return entry.kind == Boundary::Kind::fix ? Vec3d::Zero().eval() : entry.value;
  }
  static std::string place(std::size_t entry) { return "/boundary/" + std::to_string(entry); }
  bool is_held(Index vertex) const {
    const auto& holder = holder_[static_cast<std::size_t>(vertex)];
    return std::count(holder.begin(), holder.end(), nobody) == 0;
  }

  std::vector<Index> vertices_of(const Boundary& entry, const std::string& where) {
    const std::size_t before = resolution_.faults.size();
    auto vertices = resolution_.selected([&] { return select_vertices(entry.where, setup_.mesh, where); });
    if (vertices.empty() && resolution_.faults.size() == before) resolution_.fail_empty(where, "vertex");
    return vertices;
  }

  // Returns what an entry holds wholly, and lists what it holds by a share.
  std::vector<Index> held_wholly(const Boundary& entry, int index, const std::string& where) {
    if (entry.hold_by == HoldBy::vertices) return vertices_of(entry, where);
    const std::size_t before = resolution_.faults.size();
    const auto shares =
        resolution_.selected([&] { return select_shares(entry.where, setup_.mesh, entry.hold_by, where); });
    if (shares.empty() && resolution_.faults.size() == before)
      resolution_.fail_empty(where, "part of the body");
    std::vector<Index> wholly;
    for (const auto& [vertex, share] : shares) {
      if (share == 1) {
        wholly.push_back(vertex);
        continue;
      }
      setup_.partly_held.push_back({vertex, share, displacement(entry), entry.axes});
      partly_held_by_.push_back(index);
    }
    return wholly;
  }

  // The first entry wins at each component of a vertex. Springs of several entries add up.
  void prescribe(const Boundary& entry, int index) {
    const std::string here = place(static_cast<std::size_t>(index));
    const Vec3d value = displacement(entry);
    std::size_t conflicts = 0;
    Index first = 0;
    int winner = nobody;
    for (const Index v : held_wholly(entry, index, here + "/where")) {
      const int before = conflict(v, entry, value);
      for (int i = 0; i < 3; ++i)
        if (int& holder = holder_[std::size_t(v)][i]; entry.axes[i] && holder == nobody) holder = index;
      if (before == nobody || conflicts++ > 0) continue;
      first = v;
      winner = before;
    }
    if (conflicts == 0) return;
    resolution_.warn(here, counted(conflicts, "vertex is", "vertices are") +
                               " moved differently by earlier entries, which win (vertex " +
                               std::to_string(first) + " by " + place(static_cast<std::size_t>(winner)) +
                               ")");
  }

  // The earlier entry that moves a component of v elsewhere.
  int conflict(Index v, const Boundary& entry, const Vec3d& value) const {
    for (int i = 0; i < 3; ++i) {
      const int holder = holder_[std::size_t(v)][i];
      if (entry.axes[i] && holder != nobody &&
          displacement(resolution_.scene.boundary[std::size_t(holder)])[i] != value[i])
        return holder;
    }
    return nobody;
  }

  void write_entries() {
    const std::vector<Boundary>& entries = resolution_.scene.boundary;
    std::vector<HeldEntry> held(entries.size());
    for (Index v = 0; v < setup_.mesh.vertex_count(); ++v)
      for (int i = 0; i < 3; ++i) {
        const int holder = holder_[std::size_t(v)][i];
        if (holder == nobody) continue;
        HeldEntry& entry = held[std::size_t(holder)];
        if (entry.vertices.empty() || entry.vertices.back() != v) {
          entry.vertices.push_back(v);
          entry.axes.push_back({});
        }
        entry.axes.back()[std::size_t(i)] = true;
      }
    add_partly_held(held);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (!is_held(entries[i])) continue;
      held[i].pointer = place(i);
      held[i].mesh_vertices = setup_.mesh.vertex_count();
      resolution_.result.held.push_back(std::move(held[i]));
    }
  }

  // A force on a component counts for the first entry that holds it, wholly or by a share.
  void add_partly_held(std::vector<HeldEntry>& held) const {
    auto holder = holder_;
    for (std::size_t p = 0; p < partly_held_by_.size(); ++p) {
      const PartlyHeldVertex& partly = setup_.partly_held[p];
      Axes first{};
      for (int i = 0; i < 3; ++i) {
        int& by = holder[std::size_t(partly.vertex)][i];
        first[i] = partly.axes[i] && by == nobody;
        if (first[i]) by = partly_held_by_[p];
      }
      if (first == Axes{}) continue;
      HeldEntry& entry = held[std::size_t(partly_held_by_[p])];
      const auto at = std::lower_bound(entry.vertices.begin(), entry.vertices.end(), partly.vertex);
      entry.axes.insert(entry.axes.begin() + (at - entry.vertices.begin()), first);
      entry.vertices.insert(at, partly.vertex);
    }
  }

  bool is_tied_to_world() const {
    const std::vector<SceneAttachment>& attachments = resolution_.scene.attachments;
    return std::any_of(attachments.begin(), attachments.end(), [](const SceneAttachment& attachment) {
      if (const auto* bed = std::get_if<SceneBed>(&attachment.what)) return !bed->to;
      return std::get<SceneLigament>(attachment.what).ends_in_world;
    });
  }

  void write_prescribed() {
    for (Index v = 0; v < setup_.mesh.vertex_count(); ++v) {
      PrescribedVertex prescribed{v, Vec3d::Zero(), {}};
      for (int i = 0; i < 3; ++i) {
        const int holder = holder_[std::size_t(v)][i];
        if (holder == nobody) continue;
        prescribed.axes[i] = true;
        prescribed.displacement[i] = displacement(resolution_.scene.boundary[std::size_t(holder)])[i];
      }
      if (prescribed.axes != Axes{}) setup_.prescribed.push_back(prescribed);
    }
    if (setup_.prescribed.empty() && setup_.partly_held.empty() && !is_tied_to_world()) {
      resolution_.warn(
          "", "nothing is fixed: the body floats; add {\"fix\": true, \"where\": …} to \"boundary\"");
    }
  }

  void share_force(const Boundary& entry, const std::string& here) {
    const std::vector<Index> vertices = vertices_of(entry, here + "/where");
    const Vec3d share = entry.value / static_cast<double>(std::max<std::size_t>(1, vertices.size()));
    std::size_t held = 0;
    for (const Index v : vertices) {
      setup_.vertex_loads.push_back({v, share});
      held += is_held(v);
    }
    if (held == 0) return;
    resolution_.warn(here, std::to_string(held) + " of the " +
                               counted(vertices.size(), "vertex", "vertices") +
                               " that share the force are fixed: their share has no effect");
  }

  void load_faces(const Boundary& entry, const std::string& here) {
    const std::vector<TetFace> faces = loaded_faces(entry, here);
    for (const TetFace& face : faces) setup_.face_loads.push_back({face.tet, face.face, entry.value});
    warn_of_held(faces, here);
  }

  void press_faces(const Boundary& entry, const std::string& here) {
    const std::vector<TetFace> faces = loaded_faces(entry, here);
    std::size_t condensed = 0;
    for (const TetFace& face : faces) {
      setup_.pressures.push_back({face.tet, face.face, entry.pressure});
      condensed += setup_.region_of[std::size_t(face.tet)] == RegionModel::precomputed;
    }
    if (condensed > 0)
      resolution_.fail(here, counted(condensed, "face under pressure is", "faces under pressure are") +
                                 " in a precomputed region, whose inside bears no load that follows it: make "
                                 "that part tensor-mass or nonlinear");
    warn_of_held(faces, here);
  }

  std::vector<TetFace> loaded_faces(const Boundary& entry, const std::string& here) {
    if (outer_.empty()) outer_ = outer_faces(setup_.mesh);
    const std::size_t before = resolution_.faults.size();
    auto faces =
        resolution_.selected([&] { return select_faces(entry.where, setup_.mesh, outer_, here + "/where"); });
    if (faces.empty() && resolution_.faults.size() == before) {
      resolution_.fail_empty(here + "/where", "boundary face");
    }
    return faces;
  }

  void warn_of_held(const std::vector<TetFace>& faces, const std::string& here) {
    std::size_t held = 0;
    for (const TetFace& face : faces) {
      const auto& corners = face_corners[face.face];
      held += std::all_of(std::begin(corners), std::end(corners),
                          [&](int corner) { return is_held(setup_.mesh.tets(corner, face.tet)); });
    }
    if (held == 0) return;
    resolution_.warn(here, std::to_string(held) + " of the " +
                               counted(faces.size(), "loaded face", "loaded faces") +
                               " have only fixed vertices: their load has no effect");
  }

  Resolution& resolution_;
  Setup& setup_;
  std::vector<std::array<int, 3>> holder_;  // per vertex and component: the entry that holds it
  std::vector<int> partly_held_by_;         // entries, of each of Setup::partly_held
  std::vector<TetFace> outer_;
};

}  // namespace

void resolve_boundary(Resolution& resolution) { BoundaryResolver(resolution).run(); }

}  // namespace lobe

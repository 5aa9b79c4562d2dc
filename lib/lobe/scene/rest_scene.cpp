#include "lobe/scene/rest_scene.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <tuple>

#include "lobe/diagnostics/locate.h"
#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/io/grouped_mesh.h"
#include "lobe/mesh/joined_mesh.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/scene/select.h"
#include "lobe/scene/write_scene.h"
#include "lobe/text.h"

namespace lobe {
namespace {

constexpr int most_shape_rounds = 8;  // in which shares and fibres follow the shape

template <class T>
bool alike(const T& a, const T& b) {
  return std::apply([&](auto... member) { return ((a.*member == b.*member) && ...); }, T::fields);
}
template <class T>
bool alike(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return alike(x, y); });
}

// Makes selections by place that take something else of the mesh at rest the numbers of what they take of the
// image.
class Freezer {
 public:
  Freezer(const TetMesh& image, const TetMesh& rest)
      : image_(image), rest_(rest), faces_(outer_faces(image)) {}

  std::vector<std::string> freeze(Scene& scene) {
    for_each_selector(scene, [&](Selector& selector, Selects what, const std::string& entry, auto&&) {
      place_ = entry;
      if (what == Selects::vertices) vertices(selector);
      if (what == Selects::faces) faces(selector);
      if (what == Selects::tets) tets(selector);
    });
    return std::move(notes_);
  }

 private:
  void note(const std::string& what) {
    notes_.push_back(place_ + ": names the numbers of its " + what +
                     ", since its place has others of the unloaded shape");
  }
  void tets(Selector& selector) {
    std::vector<Index> taken = select_tets(selector, image_);
    if (taken == select_tets(selector, rest_)) return;
    note(counted(taken.size(), "tetrahedron", "tetrahedra"));
    selector.value = SelectTetrahedra{std::move(taken)};
  }
  void vertices(Selector& selector) {
    std::vector<Index> taken = select_vertices(selector, image_);
    if (taken == select_vertices(selector, rest_)) return;
    note(counted(taken.size(), "vertex", "vertices"));
    selector.value = SelectVertices{std::move(taken)};
  }
  void faces(Selector& selector) {
    const std::vector<TetFace> taken = select_faces(selector, image_, faces_);
    if (taken == select_faces(selector, rest_, faces_)) return;
    note("vertices of " + counted(taken.size(), "face", "faces"));
    std::vector<Index> corners;
    for (const TetFace& face : taken)
      for (const int k : face_corners[face.face]) corners.push_back(image_.tets(k, face.tet));
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    selector.value = SelectVertices{std::move(corners)};
  }

  const TetMesh &image_, &rest_;
  std::vector<TetFace> faces_;
  std::string place_;
  std::vector<std::string> notes_;
};

// Moves points that scenes give in the tissue at rest.
void move_points(const TetMesh& image, const TetMesh& rest, Scene& scene) {
  if (scene.force_keys().empty()) return;
  const Locator locator(image);
  const auto move = [&](Vec3d& p) {
    const Index tet = locator.nearest(p).tet;
    p = tet_points(rest, tet) * barycentric(image, tet, p);
  };
  for_each_kind(scene, [&](auto& all) {
    for (auto& force : all) force.for_each_point(move);
  });
}

bool statically_alike(const Setup& a, const Setup& b) {
  return a.material_of == b.material_of && a.region_of == b.region_of && alike(a.prescribed, b.prescribed) &&
         alike(a.partly_held, b.partly_held) && alike(a.face_loads, b.face_loads) &&
         alike(a.vertex_loads, b.vertex_loads) && alike(a.pressures, b.pressures) &&
         a.mesh.fibres.cols() == b.mesh.fibres.cols() && a.mesh.fibres == b.mesh.fibres;
}

// What numbers cannot say.
std::vector<std::string> differences(const Setup& image, const Setup& rest) {
  std::vector<std::string> found;
  const auto expect = [&](bool is_alike, const std::string& what) {
    if (!is_alike)
      found.push_back(what +
                      " of the unloaded shape than of the given one; the shape that was found is for " +
                      "what the scene that is written says; select by labels or surfaces in its place");
  };
  const auto faces_alike = [](const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return x.tet == y.tet && x.face == y.face; });
  };
  expect(alike(image.prescribed, rest.prescribed), "the \"boundary\" holds other vertices");
  expect(image.material_of == rest.material_of, "the \"materials\" take other tetrahedra");
  expect(image.region_of == rest.region_of, "the \"regions\" take other tetrahedra");
  expect(faces_alike(image.face_loads, rest.face_loads) && faces_alike(image.pressures, rest.pressures),
         "the \"boundary\" loads other faces");
  expect(alike(image.vertex_loads, rest.vertex_loads), "the \"boundary\" loads other vertices");
  return found;
}

TetMesh rest_mesh(const MeshFile& file, const Mat3X<double>& points) {
  TetMesh mesh = file.mesh;
  mesh.points = points;
  return mesh;
}

std::vector<DataArray> arrays_of(const std::map<std::string, Eigen::MatrixXd>& data) {
  std::vector<DataArray> arrays;
  for (const auto& [name, values] : data)
    if (name != "displacement") arrays.push_back({name, values});
  return arrays;
}

std::vector<DataArray> point_arrays(const RestScene& rest, const MeshFile& file) {
  std::vector<DataArray> arrays = arrays_of(file.point_data);
  arrays.push_back({"displacement", rest.shape.u});
  return arrays;
}

// The groups of a file that lie in vertices from `first` on.
Groups groups_of(const MeshFile& file, const std::string& body, Index first, Index count) {
  Groups groups{{}, file.label_names};
  for (const BodyLabelName& known : file.body_label_names)
    if (known.body == body) groups.label_names[known.label] = known.name;
  for (const SurfaceGroup& group : file.surfaces) {
    SurfaceGroup part{group.number, group.name, {}};
    for (std::array<Index, 3> triangle : group.triangles) {
      for (Index& v : triangle) v -= first;
      const auto [least, most] = std::minmax_element(triangle.begin(), triangle.end());
      if (*least >= 0 && *most < count) part.triangles.push_back(triangle);
    }
    if (!part.triangles.empty()) groups.surfaces.push_back(std::move(part));
  }
  return groups;
}

// Writes an OBJ file whose vertices have moved with the tissue. Nothing else in it depends on where they are:
// lobe takes normals from triangles.
void write_skin(const std::filesystem::path& from, const std::filesystem::path& to, const RestScene& rest) {
  TetMesh image = rest.mesh;
  image.points += rest.shape.u;
  const Locator locator(image);
  std::ifstream in(from);
  if (!in) throw InputError(from.string(), "cannot be read");
  std::string text, line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string keyword;
    Vec3d p = Vec3d::Zero();
    words >> keyword;
    if (keyword == "v") {
      if (!(words >> p[0] >> p[1] >> p[2]))
        throw InputError(from.string(), "\"" + line + "\": three numbers expected");
      const Index tet = locator.nearest(p).tet;
      p = tet_points(rest.mesh, tet) * barycentric(image, tet, p);
      line = "v " + exact(p[0]) + ' ' + exact(p[1]) + ' ' + exact(p[2]);
    }
    text += line + '\n';
  }
  io::write_file(to, text);
}

}  // namespace

RestScene find_rest_scene(const Scene& scene, const MeshFile& file, const Setup& loaded,
                          const RestShapeOptions& options) {
  Setup setup = loaded;
  RestShapeOptions search = options;
  RestScene result;
  int iterations = 0, factorisations = 0;
  for (int round = 0; round < most_shape_rounds; ++round) {
    result.shape = find_rest_shape(setup, search);
    iterations += result.shape.iterations;
    factorisations += result.shape.factorisations;
    result.mesh = rest_mesh(file, result.shape.points);
    result.scene = scene;
    result.scene.mesh_scale = 1;
    result.notes = Freezer(loaded.mesh, result.mesh).freeze(result.scene);
    move_points(loaded.mesh, result.mesh, result.scene);
    if (!result.shape.converged) break;
    Setup there = resolve(result.scene, result.mesh, {false}).setup;
    result.warnings = differences(loaded, there);
    const bool has_settled = round > 0 && result.shape.iterations == 1;
    if (has_settled || statically_alike(setup, there)) break;
    there.mesh.points = loaded.mesh.points;
    setup = std::move(there);
    search.start = &result.mesh.points;
  }
  result.shape.iterations = iterations;
  result.shape.factorisations = factorisations;
  return result;
}

void write_rest_mesh(const std::filesystem::path& vtu, const RestScene& rest, const MeshFile& file) {
  write_vtu(vtu, rest.mesh, point_arrays(rest, file), arrays_of(file.cell_data));
}

std::vector<std::filesystem::path> write_rest_scene(const std::filesystem::path& json, const RestScene& rest,
                                                    const MeshFile& file) {
  std::vector<std::filesystem::path> files{json};
  const std::filesystem::path folder = json.parent_path();
  Scene scene = with_absolute_paths(rest.scene);
  // Writes STEM.vtu or STEM.msh; returns its name.
  const auto write = [&](const std::string& stem, const TetMesh& mesh, const Groups& groups,
                         const std::vector<DataArray>& of_points, const std::vector<DataArray>& of_cells) {
    const std::filesystem::path name = stem + (groups.empty() ? ".vtu" : ".msh");
    files.push_back(folder / name);
    if (groups.empty())
      write_vtu(folder / name, mesh, of_points, of_cells);
    else
      write_grouped_mesh(folder / name, mesh, groups);
    return name;
  };
  const std::string stem = json.stem().string();
  if (scene.bodies.empty())
    scene.mesh = write(stem, rest.mesh, groups_of(file, "", 0, rest.mesh.vertex_count()),
                       point_arrays(rest, file), arrays_of(file.cell_data));
  Index first = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    SceneBody& body = scene.bodies[i];
    const TetMesh mesh = mesh_of_body(rest.mesh, int(i));
    const Index count = mesh.vertex_count();
    SceneBody placed{body.name,
                     write(stem + "_" + std::to_string(i + 1), mesh, groups_of(file, body.name, first, count),
                           {{"displacement", rest.shape.u.middleCols(first, count)}}, {})};
    placed.carries = body.carries;
    body = std::move(placed);
    first += count;
  }
  if (!scene.skin.empty()) {
    const std::filesystem::path name = stem + "_skin.obj";
    files.push_back(folder / name);
    write_skin(scene.skin, files.back(), rest);
    scene.skin = name;
  }
  io::write_file(json, to_json(scene) + '\n');
  return files;
}

}  // namespace lobe

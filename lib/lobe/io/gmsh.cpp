// Gmsh .msh 1 (ascii), 2.2 and 4.1 (ascii and binary). The last two share their sections and differ in their
// layout; the same code reads text and binary numbers. Version 1 has $NOD and $ELM instead, and no
// $MeshFormat.
#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <unordered_map>

#include "lobe/io/raw_mesh.h"

namespace lobe::io {
namespace {

// Gmsh's numbers of element types.
constexpr int triangle = 2, tetrahedron = 4, six_node_triangle = 9, ten_node_tetrahedron = 11;

// Nodes of each element type (gmsh.info, "MSH file format").
const std::map<std::int64_t, std::size_t> nodes_of_type = {
    {1, 2},   {2, 3},   {3, 4},   {4, 4},   {5, 8},   {6, 6},   {7, 5},   {8, 3},   {9, 6},
    {10, 9},  {11, 10}, {12, 27}, {13, 18}, {14, 14}, {15, 1},  {16, 8},  {17, 20}, {18, 15},
    {19, 13}, {20, 9},  {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}, {26, 4},  {27, 5},
    {28, 6},  {29, 20}, {30, 35}, {31, 56}, {92, 64}, {93, 125}};

std::string kind_of(std::int64_t type) {
  static const std::map<std::int64_t, std::string> kinds = {{1, "line"},
                                                            {2, "triangle"},
                                                            {3, "quadrangle"},
                                                            {5, "hexahedron"},
                                                            {6, "wedge"},
                                                            {7, "pyramid"},
                                                            {8, "three-node line"},
                                                            {9, "six-node triangle"},
                                                            {15, "vertex"},
                                                            {12, "twenty-seven-node hexahedron"},
                                                            {17, "twenty-node hexahedron"},
                                                            {29, "tetrahedron of 20 nodes"},
                                                            {30, "tetrahedron of 35 nodes"}};
  const auto known = kinds.find(type);
  return known == kinds.end() ? "element of type " + std::to_string(type) : known->second;
}

bool is_tetrahedron(std::int64_t type) { return type == tetrahedron || type == ten_node_tetrahedron; }
bool is_triangle(std::int64_t type) { return type == triangle || type == six_node_triangle; }

class GmshReader {
 public:
  GmshReader(const std::string& name, std::string_view bytes) : scan_(name, bytes) {}

  RawMesh read() {
    while (!scan_.at_end()) {
      const std::string section(scan_.word("a section"));
      if (section.size() < 2 || section[0] != '$')
        scan_.fail("expected a section, such as $Nodes; is this a Gmsh file?");
      if (version_ == 0 && (section == "$NOD" || section == "$ELM")) version_ = 1;
      if (section == "$MeshFormat")
        read_format();
      else if (version_ == 0)
        scan_.fail("expected $MeshFormat before any other section, or $NOD (Gmsh 1)");
      else
        read_section(section);
    }
    if (raw_.coordinates.empty())
      scan_.fail("the file has no " + nodes_section() + " section; it is truncated");
    label_by_entities();
    drop_copies();
    name_groups();
    return std::move(raw_);
  }

 private:
  std::string nodes_section() const { return version_ == 1 ? "$NOD" : "$Nodes"; }

  void read_format() {
    if (version_ == 1) scan_.fail("$MeshFormat after a section of Gmsh 1, expected it first or not at all");
    const double version = scan_.real("the version");
    if (version != 4.1 && !(version >= 2 && version < 3))
      scan_.fail("Gmsh format " + std::to_string(version).substr(0, 3) +
                 ", expected 1, 2.2 or 4.1; convert it: gmsh in.msh -save -format msh41 -o out.msh");
    version_ = version > 4 ? 4 : 2;
    const bool binary = scan_.integer("the file type", 0, 1) == 1;
    scan_.integer("the size of a number", version_ == 4 && binary ? 8 : 4, 8);
    if (binary) {
      scan_.line();
      const auto one = scan_.binary<std::int32_t>("the byte order");
      if (one != 1 && one != 0x01000000) scan_.fail("the byte order mark is neither 1 nor swapped 1");
      scan_.set_binary(one != 1);
    }
    scan_.expect("$EndMeshFormat");
  }

  void read_section(const std::string& section) {
    const std::string end = (version_ == 1 ? "$END" : "$End") + section.substr(1);
    if (section == "$PartitionedEntities")
      scan_.fail("the mesh is partitioned; save it in one piece (Gmsh: Mesh > Unpartition)");
    const bool known = version_ == 1
                           ? section == "$NOD" || section == "$ELM"
                           : section == "$Nodes" || section == "$Elements" || section == "$Entities";
    if (section == "$PhysicalNames") {
      read_names();
      return scan_.expect(end);
    }
    if (!known) {  // results, comments
      if (!scan_.skip_past_line(end)) scan_.fail("expected " + end + "; the file is truncated");
      return;
    }
    if (scan_.is_binary()) scan_.line();
    if (section == "$Entities")
      read_entities();
    else if (section == nodes_section())
      version_ == 4 ? read_nodes_4() : read_nodes_2();
    else if (version_ == 1)
      read_elements_1();
    else
      version_ == 4 ? read_elements_4() : read_elements_2();
    scan_.expect(end);
  }

  // Each: dimension, number, name in quotes. Text in binary files, too.
  void read_names() {
    const std::int64_t count = scan_.integer("the number of names");
    for (std::int64_t i = 0; i < count && !scan_.at_end(); ++i) {
      const std::int64_t dimension = scan_.integer("the dimension of a group"),
                         group = scan_.integer("the number of a group");
      const std::string_view rest = scan_.line();
      const std::size_t begin = rest.find('"'), last = rest.rfind('"');
      if (begin == last) scan_.fail("expected the name of a group in quotes");
      names_.push_back({dimension, label(group), std::string(rest.substr(begin + 1, last - begin - 1))});
    }
  }

  // ---- Numbers, text or binary.
  std::int64_t integer(const char* what) {
    return scan_.is_binary() ? scan_.binary<std::int32_t>(what) : scan_.integer(what);
  }
  std::int64_t tag(const char* what) {
    return scan_.is_binary() ? scan_.binary<std::int64_t>(what) : scan_.integer(what);
  }
  double real(const char* what) { return scan_.is_binary() ? scan_.binary<double>(what) : scan_.real(what); }

  // Sizes count at least `text` bytes each in a text file and `binary` in a binary one.
  std::size_t count(const char* what, std::size_t text, std::size_t binary) {
    const std::int64_t value = tag(what);
    if (value < 0) scan_.fail(std::string("a negative number of ") + what);
    scan_.require_room(static_cast<std::uint64_t>(value), scan_.is_binary() ? binary : text, what);
    return static_cast<std::size_t>(value);
  }

  // ---- Vertices.
  void add_node(std::int64_t node) {
    if (!vertex_of_.emplace(node, static_cast<Index>(vertex_of_.size())).second)
      scan_.fail("node " + std::to_string(node) + " is given twice; node numbers must be unique");
  }

  void add_position() {
    for (int k = 0; k < 3; ++k) raw_.coordinates.push_back(real("a coordinate"));
  }

  void read_nodes_2() {  // and 1
    const std::size_t nodes = scan_.count("nodes", scan_.is_binary() ? 28 : 8);
    if (scan_.is_binary()) scan_.line();
    for (std::size_t i = 0; i < nodes; ++i) {
      add_node(integer("the number of a node"));
      add_position();
    }
  }

  void read_nodes_4() {
    const std::size_t blocks = count("blocks of nodes", 8, 20);
    for (int k = 0; k < 3; ++k) tag("the number and range of nodes");
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::int64_t dimension = integer("the dimension of an entity");
      integer("the number of an entity");
      const bool parametric = integer("the parametric flag") != 0;
      const std::size_t nodes = count("nodes", 8, 32);
      for (std::size_t i = 0; i < nodes; ++i) add_node(tag("the number of a node"));
      for (std::size_t i = 0; i < nodes; ++i) {
        add_position();
        if (parametric)
          for (std::int64_t k = 0; k < std::min<std::int64_t>(dimension, 3); ++k) real("a parameter");
      }
    }
  }

  // ---- Physical groups of the volumes (4.1): label of each entity.
  void read_entities() {
    std::size_t entities[4];
    for (std::size_t& n : entities) n = count("entities", 4, 16);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < entities[dimension]; ++i) read_entity(dimension);
  }

  void read_entity(int dimension) {
    const std::int64_t entity = integer("the number of an entity");
    for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) real("a coordinate of an entity");
    const std::size_t groups = count("physical groups", 2, 4);
    for (std::size_t g = 0; g < groups; ++g) {
      const std::int64_t group = integer("a physical group");
      if (dimension == 3 && g == 0) label_of_volume_[entity] = label(group < 0 ? -group : group);
      if (dimension == 2) groups_of_surface_[entity].push_back(label(group < 0 ? -group : group));
    }
    if (dimension == 0) return;
    const std::size_t bounds = count("bounding entities", 2, 4);
    for (std::size_t b = 0; b < bounds; ++b) integer("a bounding entity");
  }

  int label(std::int64_t group) const {
    if (group < -max_index || group > max_index)
      scan_.fail("physical group " + std::to_string(group) + ", expected a number below 2^31");
    return static_cast<int>(group);
  }

  // ---- Elements.
  std::size_t nodes_of(std::int64_t type) const {
    const auto found = nodes_of_type.find(type);
    if (found == nodes_of_type.end()) scan_.fail("unknown element type " + std::to_string(type));
    return found->second;
  }

  Index vertex(std::int64_t element, std::int64_t node) const {
    const auto found = vertex_of_.find(node);
    if (found == vertex_of_.end())
      scan_.fail("element " + std::to_string(element) + " uses node " + std::to_string(node) + ", which " +
                 nodes_section() + " does not have");
    return found->second;
  }

  // `next_node` reads the number of a node; `groups` are those of a triangle.
  template <class NextNode>
  void add_nodes(std::int64_t element, std::int64_t type, const std::vector<int>& groups,
                 const NextNode& next_node) {
    const std::size_t nodes = nodes_of(type);
    if (is_triangle(type) && !groups.empty()) {
      std::array<Index, 3> corners{};
      for (std::size_t k = 0; k < nodes; ++k)
        if (const std::int64_t node = next_node(); k < 3) corners[k] = vertex(element, node);
      for (const int group : groups) raw_.surfaces[group].triangles.push_back(corners);
      return;
    }
    if (!is_tetrahedron(type)) {
      for (std::size_t k = 0; k < nodes; ++k) next_node();
      ++raw_.ignored[kind_of(type)];
      return;
    }
    vertices_.clear();
    for (std::size_t k = 0; k < nodes; ++k) vertices_.push_back(vertex(element, next_node()));
    if (type == tetrahedron)
      raw_.corners.insert(raw_.corners.end(), vertices_.begin(), vertices_.end());
    else
      add_ten_node(vertices_, raw_);
  }

  // Where no tetrahedron has a group, and they are of several entities, these are the labels.
  void label_by_entities() {
    const auto is_0 = [](int label) { return label == 0; };
    if (!std::all_of(raw_.labels.begin(), raw_.labels.end(), is_0)) return;
    if (std::adjacent_find(entities_.begin(), entities_.end(), std::not_equal_to<>()) == entities_.end())
      return;
    for (std::size_t t = 0; t < entities_.size(); ++t) raw_.labels[t] = label(entities_[t]);
    raw_.notes.push_back("no tetrahedron is in a physical group: labels are the numbers of the volumes");
  }

  // Gmsh writes an element once for each of its groups where it cannot name several (1, 2.2). The first one
  // stays, with its label.
  void drop_copies() {
    std::set<std::array<Index, 4>> seen;
    const std::size_t tets = raw_.labels.size();
    std::size_t kept = 0;
    for (std::size_t t = 0; t < tets; ++t) {
      std::array<Index, 4> corners{};
      std::copy_n(&raw_.corners[4 * t], 4, corners.begin());
      std::sort(corners.begin(), corners.end());
      if (!seen.insert(corners).second) continue;
      std::copy_n(&raw_.corners[4 * t], 4, &raw_.corners[4 * kept]);
      raw_.labels[kept++] = raw_.labels[t];
    }
    if (kept == tets) return;
    raw_.corners.resize(4 * kept);
    raw_.labels.resize(kept);
    raw_.notes.push_back(std::to_string(tets - kept) + " of " + std::to_string(tets) +
                         " tetrahedra are copies of others, as of volumes in several groups: the first of "
                         "each is kept, with its label");
  }

  void name_groups() {
    for (const Name& name : names_) {
      if (name.dimension == 3) raw_.label_names[name.group] = name.text;
      if (name.dimension != 2) continue;
      const auto group = raw_.surfaces.find(name.group);
      if (group != raw_.surfaces.end()) group->second.name = name.text;
    }
  }

  // Each: number, type, physical group, entity, number of nodes, nodes.
  void read_elements_1() {
    const std::size_t elements = scan_.count("elements", 12);
    for (std::size_t i = 0; i < elements; ++i) {
      const std::int64_t element = scan_.integer("an element"), type = scan_.integer("an element type"),
                         group = scan_.integer("a physical group");
      const std::int64_t entity = scan_.integer("the number of an entity");
      const auto nodes = static_cast<std::int64_t>(nodes_of(type));
      if (const std::int64_t given = scan_.integer("the number of nodes"); given != nodes)
        scan_.fail("element " + std::to_string(element) + " has " + std::to_string(given) +
                   " nodes, expected " + std::to_string(nodes) + " of type " + std::to_string(type));
      add_element(element, type, group, entity);
    }
  }

  void read_elements_2() {
    const std::size_t elements = scan_.count("elements", scan_.is_binary() ? 8 : 6);
    if (scan_.is_binary()) scan_.line();
    for (std::size_t done = 0; done < elements;) {
      if (scan_.is_binary()) {
        const std::int64_t type = integer("an element type"), block = integer("the elements of a block"),
                           tags = integer("the number of tags");
        if (block < 1) scan_.fail("a block of " + std::to_string(block) + " elements, expected 1 or more");
        scan_.require_room(static_cast<std::uint64_t>(block), 8, "elements");
        for (std::int64_t i = 0; i < block; ++i) read_element_2(integer("an element"), type, tags);
        done += static_cast<std::size_t>(block);
      } else {
        const std::int64_t element = scan_.integer("an element"), type = scan_.integer("an element type");
        read_element_2(element, type, scan_.integer("the number of tags"));
        ++done;
      }
    }
  }

  void read_element_2(std::int64_t element, std::int64_t type, std::int64_t tags) {
    if (tags < 0) scan_.fail(std::to_string(tags) + " tags, expected 0 or more");
    std::int64_t group = 0, entity = 0;
    for (std::int64_t k = 0; k < tags; ++k) {
      const std::int64_t value = integer("a tag");
      if (k == 0) group = value;
      if (k == 1) entity = value;
    }
    add_element(element, type, group, entity);
  }

  void add_element(std::int64_t element, std::int64_t type, std::int64_t group, std::int64_t entity) {
    if (is_tetrahedron(type)) {
      raw_.labels.push_back(label(group));
      entities_.push_back(entity);
    }
    const std::vector<int> groups = group == 0 ? std::vector<int>{} : std::vector<int>{label(group)};
    add_nodes(element, type, groups, [&] { return integer("a node of an element"); });
  }

  void read_elements_4() {
    const std::size_t blocks = count("blocks of elements", 8, 20);
    for (int k = 0; k < 3; ++k) tag("the number and range of elements");
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::int64_t dimension = integer("the dimension of an entity");
      const std::int64_t entity = integer("the number of an entity");
      const std::int64_t type = integer("an element type");
      const std::size_t nodes = nodes_of(type);
      const std::size_t elements = count("elements", 2 + 2 * nodes, 8 + 8 * nodes);
      const auto volume = label_of_volume_.find(entity);
      const auto surface = groups_of_surface_.find(entity);
      const std::vector<int> groups =
          dimension == 2 && surface != groups_of_surface_.end() ? surface->second : std::vector<int>{};
      const int group = dimension == 3 && volume != label_of_volume_.end() ? volume->second : 0;
      for (std::size_t i = 0; i < elements; ++i) {
        const std::int64_t element = tag("an element");
        if (is_tetrahedron(type)) {
          raw_.labels.push_back(group);
          entities_.push_back(entity);
        }
        add_nodes(element, type, groups, [&] { return tag("a node of an element"); });
      }
    }
  }

  Scanner scan_;
  RawMesh raw_;
  int version_ = 0;
  std::unordered_map<std::int64_t, Index> vertex_of_;
  std::unordered_map<std::int64_t, int> label_of_volume_;
  std::unordered_map<std::int64_t, std::vector<int>> groups_of_surface_;
  struct Name {
    std::int64_t dimension;
    int group;
    std::string text;
  };
  std::vector<Name> names_;
  std::vector<std::int64_t> entities_;  // of each tetrahedron
  std::vector<Index> vertices_;         // of the element that is read
};

}  // namespace

RawMesh read_gmsh(const std::string& name, std::string_view bytes) { return GmshReader(name, bytes).read(); }

}  // namespace lobe::io

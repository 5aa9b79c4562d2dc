#include "lobe/mesh/outer_faces.h"

#include <algorithm>
#include <array>

namespace lobe {

std::vector<TetFace> outer_faces(const TetMesh& mesh) {
  struct Entry {
    std::array<Index, 3> vertices;
    TetFace face;
  };
  std::vector<Entry> entries;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) {
      Entry entry{{}, {t, k}};
      for (std::size_t i = 0; i < 3; ++i) entry.vertices[i] = mesh.tets(face_corners[k][i], t);
      std::sort(entry.vertices.begin(), entry.vertices.end());
      entries.push_back(entry);
    }
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.vertices < b.vertices; });
  std::vector<TetFace> faces;
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i + 1;
    while (end < entries.size() && entries[end].vertices == entries[i].vertices) ++end;
    if (end == i + 1) faces.push_back(entries[i].face);
    i = end;
  }
  std::sort(faces.begin(), faces.end(), [](const TetFace& a, const TetFace& b) {
    return std::pair(a.tet, a.face) < std::pair(b.tet, b.face);
  });
  return faces;
}

}  // namespace lobe

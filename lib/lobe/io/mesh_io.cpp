#include "lobe/io/mesh_io.h"

#include "lobe/error.h"
#include "lobe/io/labelled_mesh.h"
#include "lobe/io/raw_mesh.h"

namespace lobe {
namespace {

MeshFile read_tetgen_pair(const std::filesystem::path& either) {
  const auto bytes_of = [&](const char* extension, std::string& name) {
    std::filesystem::path file = either;
    name = file.replace_extension(extension).string();
    if (!std::filesystem::exists(file))
      throw InputError(name, "no such file; TetGen's .node and .ele belong together");
    return io::read_file(file);
  };
  std::string node, ele;
  const std::string node_bytes = bytes_of(".node", node), ele_bytes = bytes_of(".ele", ele);
  return io::finish(io::read_tetgen(node, node_bytes, ele, ele_bytes), ele);
}

}  // namespace

std::vector<std::string> MeshFile::warnings() const {
  std::vector<std::string> lines = notes;
  for (std::string& line : prepared.warnings()) lines.push_back(std::move(line));
  return lines;
}

MeshFile read_mesh(const std::filesystem::path& file) {
  const std::string name = file.string(), extension = io::lower_case(file.extension().string());
  if (extension == ".node" || extension == ".ele") return read_tetgen_pair(file);
  const auto bytes = [&] { return io::read_file(file); };
  if (extension == ".vtu") return io::read_vtu(name, bytes());
  if (extension == ".vtk") return io::finish(io::read_vtk_legacy(name, bytes()), name);
  if (extension == ".msh" || extension == ".msh2") return io::finish(io::read_gmsh(name, bytes()), name);
  if (extension == ".mesh") return io::finish(io::read_medit(name, bytes()), name);
  throw InputError(name,
                   "unknown extension '" + extension +
                       "', expected .vtu, .vtk, .msh, .msh2, .mesh, .node or .ele; surfaces (.stl, .obj, "
                       ".ply, .off, .vtp) are meshed by lobe-mesh");
}

MeshFile read_labelled_mesh(const std::filesystem::path& file, const std::string& labels) {
  const std::string name = file.string(), extension = io::lower_case(file.extension().string());
  if (extension == ".vtu") return io::read_vtu(name, io::read_file(file), labels);
  if (extension == ".vtk") return io::finish(io::read_vtk_legacy(name, io::read_file(file), labels), name);
  throw InputError(name, "only .vtu and .vtk have cell arrays to take labels from");
}

}  // namespace lobe

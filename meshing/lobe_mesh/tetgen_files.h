// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
//
// What lobe-mesh and its helper lobe-tetgen exchange: files of the machine's own byte order that never leave
// the machine. Input: points and triangles; output: points, tetrahedra and a region number per tetrahedron.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace lobe::meshing {

struct TetgenFile {
  std::vector<double> points;         // 3 per point
  std::vector<std::int32_t> cells;    // 3 per triangle or 4 per tetrahedron
  std::vector<std::int32_t> regions;  // one per tetrahedron

  bool write(const std::string& file) const {
    std::ofstream out(file, std::ios::binary);
    put(out, points);
    put(out, cells);
    put(out, regions);
    return static_cast<bool>(out.flush());
  }
  bool read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return get(in, points) && get(in, cells) && get(in, regions);
  }

 private:
  template <class T>
  static void put(std::ofstream& out, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    out.write(reinterpret_cast<const char*>(&count), sizeof count);
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  }
  template <class T>
  static bool get(std::ifstream& in, std::vector<T>& values) {
    std::uint64_t count = 0;
    if (!in.read(reinterpret_cast<char*>(&count), sizeof count)) return false;
    values.resize(count);
    return static_cast<bool>(
        in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T))));
  }
};

}  // namespace lobe::meshing

// What scenes need to know of a kind of tool: KindOf<the struct of Tool::kind>, in a file of each kind
// (cautery_kind.h, …), and the table of its keys. tool_kinds.h has all. Internal, not part of the public
// interface.
//
//   ToolSetup                           its struct of setup/tool_setups.h
//   row                                 what a row of its path has, in words
//   read_row(row, tool)                 reads the rest of a row. The last point of the path has its time and
//                                       position already. False if it is no such row
//   write_row(tool, number, row)        appends the rest of the row of this number, after time and place
//   resolve(resolution, tool, place)    finds the rest of its setup, its faults and warnings
//   bring(resolution, tool, place)      the command by which a hand brings it to the first point of its path;
//                                       not of kinds with which hands take hold
//   summarise(setup, entry)             adds what `lobe check` says of it
//   describe(entry)                     the same in words
//   from_setup(setup, vertices)         what a scene whose mesh has so many vertices says of it; not of kinds
//                                       that add nothing to their setup
#pragma once

#include <nlohmann/json.hpp>

#include "lobe/scene/key_table.h"
#include "lobe/scene/resolve_parts.h"
#include "lobe/tool/tool_lists.h"

namespace lobe {

template <class Said>
struct KindOf;

// Rows of 4 numbers, time and place, or of 8 with a quaternion.
struct TurningRows {
  template <class Said>
  static bool read_row(const nlohmann::json& row, Said& tool) {
    if (row.size() == 8) read_turn(row, tool.path.back());
    return row.size() == 4 || row.size() == 8;
  }
  template <class Said>
  static void write_row(const Said& tool, std::size_t number, nlohmann::ordered_json& row) {
    write_turn(tool.path[number], row);
  }
  static void read_turn(const nlohmann::json& row, PathPoint& point) {
    for (int i = 0; i < 4; ++i) point.orientation[i] = row[std::size_t(4 + i)].get<double>();
  }
  static void write_turn(const PathPoint& point, nlohmann::ordered_json& row) {
    if (const Eigen::Vector4d& q = point.orientation; q != PathPoint().orientation)
      row.insert(row.end(), {q[0], q[1], q[2], q[3]});
  }
};

namespace keys {

// The row for a path, which tool_kinds.cpp reads.
constexpr auto path_key(const char* schema, const char* sentence) {
  return Key("path", NotKept<std::vector<double>>{}, any.required().as(schema, "rows"), sentence);
}
constexpr auto turning_path_key(const char* sentence) {
  return path_key(R"({"$ref": "#/definitions/turning_path"})", sentence);
}

}  // namespace keys
}  // namespace lobe

#include "lobe/scene/tool_kinds.h"

namespace lobe {

void keys::Form<Tool>::read(const nlohmann::json& given, Tool& tool, const std::string& place) {
  tool.pointer = place;
  const std::string type = given["type"];  // the schema knows no others
  for_each_kind_in_scenes([&](const auto& kind) {
    if (type == kind.type) tool.kind = kind;
  });
  const auto read = [&]<class Said>(Said& said) {
    said.name = given.value("name", type);
    read_keys(given, said, place);
    for (const nlohmann::json& row : given["path"]) {
      PathPoint& point = said.path.emplace_back();
      point.time = row[0].get<double>();
      point.position = read_vector(row, 1);
      if (!KindOf<Said>::read_row(row, said))
        throw InputError(
            place + "/path/" + std::to_string(said.path.size() - 1),
            "a row has " + std::string(KindOf<Said>::row) + ", not " + std::to_string(row.size()));
    }
  };
  std::visit(read, tool.kind);
}

nlohmann::ordered_json keys::Form<Tool>::write(const Tool& tool) {
  nlohmann::ordered_json entry = {{"name", tool.name()}, {"type", tool.type()}};
  const auto write = [&]<class Said>(const Said& said) {
    write_keys(said, entry);
    nlohmann::ordered_json& path = entry["path"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < said.path.size(); ++i) {
      const PathPoint& point = said.path[i];
      path.push_back({point.time, point.position[0], point.position[1], point.position[2]});
      KindOf<Said>::write_row(said, i, path.back());
    }
  };
  std::visit(write, tool.kind);
  return entry;
}

void summarise(const ToolSetups& setups, const Tool& tool, std::size_t number,
               nlohmann::ordered_json& entry) {
  std::visit(
      [&]<class Said>(const Said&) {
        KindOf<Said>::summarise(list_of<typename KindOf<Said>::ToolSetup>(setups)[number], entry);
      },
      tool.kind);
}

std::string describe_tool(const nlohmann::ordered_json& entry) {
  std::string words;
  for_each_kind_in_scenes([&]<class Said>(const Said&) {
    if (entry["type"] == Said::type) words = KindOf<Said>::describe(entry);
  });
  return words;
}

void append_tools(const ToolSetups& done, Index mesh_vertices, std::vector<Tool>& tools) {
  for_each_kind_in_scenes([&]<class Said>(const Said&) {
    for (const auto& setup : list_of<typename KindOf<Said>::ToolSetup>(done)) {
      if constexpr (requires { KindOf<Said>::from_setup(setup, mesh_vertices); })
        tools.push_back({KindOf<Said>::from_setup(setup, mesh_vertices), ""});
      else
        tools.push_back({Said{setup}, ""});
    }
  });
}

}  // namespace lobe

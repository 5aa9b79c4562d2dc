// The only unit that includes valijson.
#include "scene/validator.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "lobe/scene/schema.h"

bool lobe::test::satisfies_scene_schema(const nlohmann::json& document) {
  using valijson::adapters::NlohmannJsonAdapter;
  static const std::unique_ptr<valijson::Schema> schema = [] {
    static const auto text = nlohmann::json::parse(scene_schema());
    auto made = std::make_unique<valijson::Schema>();
    valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(NlohmannJsonAdapter(text), *made);
    return made;
  }();
  return valijson::Validator().validate(*schema, NlohmannJsonAdapter(document), nullptr);
}

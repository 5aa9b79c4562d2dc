// The only unit that includes valijson: 443 MB and ten seconds to compile.
#include "lobe/scene/validate.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "lobe/scene/explain.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/schema.h"

namespace lobe {
namespace {

using nlohmann::json;
using valijson::adapters::NlohmannJsonAdapter;

struct SceneSchema {
  json document;
  valijson::Schema compiled;
};

const SceneSchema& schema() {
  static const auto instance = [] {
    auto made = std::make_unique<SceneSchema>();
    made->document = json::parse(scene_schema());
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(NlohmannJsonAdapter(made->document), made->compiled);
    return made;
  }();
  return *instance;
}

bool validate(const json& document, valijson::ValidationResults* results) {
  valijson::Validator validator;
  return validator.validate(schema().compiled, NlohmannJsonAdapter(document), results);
}

// {"<root>", "[boundary]", "[0]"} to "/boundary/0"
std::string pointer(const std::vector<std::string>& context) {
  std::string text;
  for (std::size_t i = 1; i < context.size(); ++i) {
    text = child_pointer(text, context[i].substr(1, context[i].size() - 2));
  }
  return text;
}

}  // namespace

bool satisfies_scene_schema(const nlohmann::json& document) { return validate(document, nullptr); }

std::vector<Fault> schema_faults(const nlohmann::json& document, const std::string& name) {
  if (satisfies_scene_schema(document)) return {};
  std::vector<Fault> faults = explain(document, schema().document);
  if (faults.empty()) {  // explain() has nothing to say: take the validator's messages
    valijson::ValidationResults results;
    validate(document, &results);
    for (const auto& error : results) faults.push_back({pointer(error.context), error.description});
  }
  for (Fault& fault : faults) {
    if (fault.place.empty()) fault.place = name;
  }
  return faults;
}

}  // namespace lobe

// The verdict of a validator of JSON documents (valijson), with which that of explain() is compared.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace lobe::test {

bool satisfies_scene_schema(const nlohmann::json& document);

}  // namespace lobe::test

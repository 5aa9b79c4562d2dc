#include "lobe/scene/tissues.h"

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "console.h"
#include "lobe/text.h"

namespace lobe::program {
namespace {

using Json = nlohmann::ordered_json;

Json tissue_json(const Tissue& tissue) {
  Json entry{{"name", tissue.name},
             {"young_modulus_Pa", tissue.young_modulus},
             {"standard_deviation_Pa", nullptr},
             {"poisson_ratio", tissue_poisson_ratio},
             {"density_kg_m3", tissue.density},
             {"measured", tissue.measured},
             {"source", tissue.source},
             {"density_source", tissue.density_source}};
  if (tissue.spread > 0) entry["standard_deviation_Pa"] = tissue.spread;
  return entry;
}

std::string kilopascals(double pascals) { return rounded(pascals / 1000); }

}  // namespace

int print_tissues(const TissuesOptions& options) {
  if (options.json) {
    Json list = Json::array();
    for (const Tissue& tissue : tissues()) list.push_back(tissue_json(tissue));
    std::cout << list.dump(1) << '\n';
    return done;
  }
  std::printf("%-20s %-16s %-8s %s\n", "tissue", "E [kPa]", "density", "measured; source");
  for (const Tissue& tissue : tissues()) {
    std::string modulus = kilopascals(tissue.young_modulus);
    if (tissue.spread > 0) modulus += " ± " + kilopascals(tissue.spread);
    const int wide = tissue.spread > 0 ? 17 : 16;  // ± has two bytes
    std::printf("%-20s %-*s %-8g %s; %s\n", std::string(tissue.name).c_str(), wide, modulus.c_str(),
                tissue.density, std::string(tissue.measured).c_str(), std::string(tissue.source).c_str());
  }
  std::printf("Poisson's ratio %g in all of them, density in kg/m³\n", tissue_poisson_ratio);
  return done;
}

}  // namespace lobe::program

// Internal: the steps of resolve(). Not part of the public interface.
#pragma once

#include <string>
#include <vector>

#include "lobe/error.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/select.h"
#include "lobe/setup/exclusions.h"
#include "lobe/text.h"

namespace lobe {

struct Resolution {
  const Scene& scene;
  Resolved result;
  std::vector<Fault> faults;

  const TetMesh& mesh() const { return result.setup.mesh; }
  void warn(const std::string& place, const std::string& message) {
    result.warnings.push_back(place.empty() ? message : place + ": " + message);
  }
  void fail(const std::string& place, const std::string& message) { faults.push_back({place, message}); }

  // "selects no vertex; the mesh spans [0, 0, 0] to [1, 1, 1] m"
  void fail_empty(const std::string& place, const char* what);
  // Runs a selection; one that names an index beyond the mesh becomes a fault, and selects nothing.
  template <class Select>
  auto selected(const Select& select) -> decltype(select()) {
    try {
      return select();
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
      return {};
    }
  }
};

// "1 vertex", "2 vertices"
inline std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// Poisson's ratio above which linear tetrahedra lock volumetrically: they respond too stiffly.
inline constexpr double locks_above = 0.45;

Options options_of(const Scene& scene);  // options that it asks for
void refuse_excluded_options(Resolution& resolution);
void check_bodies(Resolution& resolution);
void resolve_carriers(Resolution& resolution);
void warn_of_bodies(Resolution& resolution);
void resolve_materials(Resolution& resolution);
void resolve_fibres(Resolution& resolution);
void resolve_regions(Resolution& resolution);
void resolve_boundary(Resolution& resolution);
void resolve_tools(Resolution& resolution);
void warn_of_unheld_pieces(Resolution& resolution);
void resolve_contact(Resolution& resolution);
void resolve_gestures(Resolution& resolution);
void warn_of_units(Resolution& resolution);

// Chooses automatic regions. Warnings say what was found.
void choose_regions(Resolution& resolution, const std::function<void(double fraction)>& progress);

}  // namespace lobe

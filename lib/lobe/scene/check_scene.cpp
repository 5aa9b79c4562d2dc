#include "lobe/scene/check_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "lobe/scene/each_selector.h"
#include "lobe/scene/explain.h"
#include "lobe/scene/json_text.h"
#include "lobe/scene/scene_document.h"
#include "lobe/setup/exclusions.h"
#include "lobe/text.h"

namespace lobe {
namespace {

class MeaningChecker {
 public:
  explicit MeaningChecker(const Scene& scene) : scene_(scene) {}

  std::vector<Fault> check() {
    check_bodies();
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      check_material(scene_.materials[i], child_pointer("/materials", i));
    }
    for (std::size_t i = 0; i < scene_.boundary.size(); ++i) {
      check_boundary(scene_.boundary[i], child_pointer("/boundary", i));
    }
    for (std::size_t i = 0; i < scene_.tools.size(); ++i)
      check_path(scene_.tools[i].path(), child_pointer("/tools", i) + "/path");
    check_names(scene_.attachments, "/attachments");
    for_each_selector(scene_, [&](const Selector& selector, Selects, const std::string& entry,
                                  const char* key) { check_selector(selector, entry + key); });
    constexpr double most_frames = 1e7;
    if (scene_.time.duration / scene_.time.frame > most_frames) {
      add("/time/frame", exact(scene_.time.frame) + ", makes more than 10 million frames of the duration, " +
                             exact(scene_.time.duration));
    }
    for (std::size_t i = 0; i < scene_.output.pictures.size(); ++i) {
      const double time = scene_.output.pictures[i];
      if (time > scene_.time.duration) {
        add(child_pointer("/output/pictures", i),
            exact(time) + ", must be at most the duration, " + exact(scene_.time.duration));
      }
    }
    return std::move(faults_);
  }

 private:
  void add(const std::string& place, const std::string& message) { faults_.push_back({place, message}); }

  void add(std::vector<Fault> faults) {
    std::move(faults.begin(), faults.end(), std::back_inserter(faults_));
  }

  void check_bodies() {
    check_names(scene_.bodies, "/bodies");
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      check_unit(scene_.bodies[i].orientation, child_pointer("/bodies", i) + "/orientation");
  }

  template <class Entry>
  void check_names(const std::vector<Entry>& entries, const std::string& list) {
    for (std::size_t i = 0; i < entries.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (entries[j].name == entries[i].name) {
          add(child_pointer(list, i) + "/name",
              "\"" + entries[i].name + "\" is the name of " + child_pointer(list, j) + " already");
          break;
        }
  }

  void check_unit(const Eigen::Vector4d& quaternion, const std::string& place) {
    if (const double length = quaternion.stableNorm(); !(std::abs(length - 1) < 1e-6))
      add(place, "the quaternion has length " + exact(length) + ", must be 1");
  }

  // Positive definite: μ > 0 and the bulk modulus λ + 2μ/3 > 0.
  void check_material(const Material& material, const std::string& place) {
    add(find_material_exclusions(material.law, material.transverse.has_value(), place + "/law"));
    if (material.transverse) return check_fibres(material, place);
    const double lambda = material.lame_lambda, mu = material.lame_mu;
    if (!std::isfinite(lambda + 2 * mu)) {
      add(place, "too stiff for double precision");
    } else if (3 * lambda + 2 * mu <= 0) {
      add(place + "/lame_lambda",
          exact(lambda) + ", must be above -2/3 lame_mu = " + exact(-2 * mu / 3) + " (unstable material)");
    } else if (material.nodal_pressure > 0 && lambda < 0) {
      add(place + "/nodal_pressure",
          "needs lame_lambda of at least 0, not " + exact(lambda) + "; leave it out");
    }
    if (material.fibre) check_field(material, place);
  }

  void check_fibres(const Material& material, const std::string& place) {
    add(transverse_faults(*material.transverse, place));
    if (faults_.empty() && !is_positive_definite(elastic_of(material)))
      add(place, "its constants are not positive definite to rounding");
    if (faults_.empty() && material.nodal_pressure > 0 && elastic_of(material).lambda < 0)
      add(place + "/nodal_pressure", "needs a stiffness across of at least its shear's; leave it out");
    if (!material.fibre) return add(place + "/fibre", "is missing: which way the fibres run");
    check_field(material, place);
  }

  void check_field(const Material& material, const std::string& place) {
    const std::string at = place + "/fibre";
    if (const auto* constant = std::get_if<FibreDirection>(&*material.fibre)) {
      check_length(constant->direction, at + "/direction");
    } else if (const auto* around = std::get_if<FibreAround>(&*material.fibre)) {
      check_length(around->axis, at + "/axis/direction");
    }
  }

  void check_length(const Vec3d& direction, const std::string& place) {
    const double length = direction.stableNorm();
    if (!(length > 0 && std::isfinite(length)))
      add(place, "has length " + exact(length) + ", must be above 0");
  }

  void check_boundary(const Boundary& boundary, const std::string& place) {
    if (boundary.kind == Boundary::Kind::displacement && boundary.axes == Axes{})
      add(place + "/displacement", "every component is null, so that nothing is prescribed");
  }

  void check_path(const std::vector<PathPoint>& path, const std::string& place) {
    for (std::size_t i = 0; i < path.size(); ++i)
      check_unit(path[i].orientation, child_pointer(place, i) + "/4");
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (path[i].time > path[i - 1].time) continue;
      const bool same = path[i].time == path[i - 1].time;
      add(child_pointer(place, i) + "/0",
          "time " + exact(path[i].time) +
              (same ? " is given twice; times must increase"
                    : " goes back (previous " + exact(path[i - 1].time) + ")"));
    }
  }

  void check_selector(const Selector& selector, const std::string& place) {
    if (const auto* box = std::get_if<SelectBox>(&selector.value)) {
      for (int i = 0; i < 3; ++i) {
        if (box->min[i] <= box->max[i]) continue;
        add(place + "/box/max/" + std::to_string(i),
            exact(box->max[i]) + ", must be at least min, " + exact(box->min[i]));
      }
    } else if (const auto* plane = std::get_if<SelectPlane>(&selector.value)) {
      const double length = plane->normal.stableNorm();
      if (!(length > 0 && std::isfinite(length))) {
        add(place + "/plane/normal", "has length " + exact(length) + ", must be above 0");
      }
    } else if (const auto* any = std::get_if<SelectAnyOf>(&selector.value)) {
      check_parts(any->parts, place + "/any_of");
    } else if (const auto* all = std::get_if<SelectAllOf>(&selector.value)) {
      check_parts(all->parts, place + "/all_of");
    } else if (const auto* negated = std::get_if<SelectNot>(&selector.value)) {
      for (const Selector& part : negated->part) check_selector(part, place + "/not");
    }
  }

  void check_parts(const std::vector<Selector>& parts, const std::string& place) {
    for (std::size_t i = 0; i < parts.size(); ++i) check_selector(parts[i], child_pointer(place, i));
  }

  const Scene& scene_;
  std::vector<Fault> faults_;
};

}  // namespace

std::vector<Fault> semantic_faults(const Scene& scene) { return MeaningChecker(scene).check(); }

void check_scene(const Scene& scene) {
  const std::string name = scene.file.empty() ? "scene" : scene.file.string();
  std::vector<Fault> faults = schema_faults(write_document(scene), name);
  if (faults.empty()) faults = semantic_faults(scene);
  if (!faults.empty()) throw InputError(std::move(faults));
}

}  // namespace lobe

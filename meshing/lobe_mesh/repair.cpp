// This file is part of lobe's meshing folder: GPL-3.0-or-later, see meshing/LICENSE.
#include "lobe_mesh/repair.h"
#include "lobe/numerics/symmetric_eigen.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "lobe/error.h"
#include "lobe/text.h"
#include "lobe_mesh/area.h"
#include "lobe_mesh/clean.h"
#include "lobe_mesh/diagnose.h"
#include "lobe_mesh/errors.h"
#include "lobe_mesh/nearest.h"
#include "lobe_mesh/orient.h"
#include "lobe_mesh/steps.h"

namespace lobe::meshing {
namespace {

void refuse_hopeless(const Surface& surface) {
  for (Index i = 0; i < surface.point_count(); ++i) {
    if (usable(surface.points.col(i))) continue;
    throw InputError("vertex " + std::to_string(i), "a coordinate is not a finite number (below 1e50)");
  }
  if (surface.triangle_count() < 4) {
    throw InputError("surface", std::to_string(surface.triangle_count()) +
                                    (surface.triangle_count() == 1 ? " triangle" : " triangles") +
                                    " cannot enclose a volume, at least 4 are needed");
  }
  if (!(box_diagonal(surface) > 1e-50)) throw InputError("surface", "has no extent");
  const UnitBox unit(surface);
  Mat3<double> spread = Mat3<double>::Zero();
  Vec3d mean = Vec3d::Zero();
  const Mat3X<double> points = unit.to_unit(surface.points);
  for (const Index v : surface.triangles.reshaped()) mean += points.col(v) / (3.0 * surface.triangle_count());
  for (const Index v : surface.triangles.reshaped()) {
    spread += (points.col(v) - mean) * (points.col(v) - mean).transpose() / (3.0 * surface.triangle_count());
  }
  const Vec3d variances = symmetric_eigenvalues(spread);
  if (!(variances[0] > 1e-14 * variances[2])) {
    throw InputError("surface", "flat: all its vertices lie in one plane, so it encloses no volume");
  }
}

// What keeps a surface from being meshed: at least one entry.
std::vector<std::string> faults_of(const Diagnosis& d) {
  std::vector<std::string> faults;
  for (const Finding* finding : d.findings()) {
    if (finding->count == 0 || finding == &d.duplicate_points || (d.inverted && finding == &d.wrong_sides))
      continue;
    faults.push_back(finding->counted() + ", first: " + finding->places.front());
  }
  if (faults.empty())
    faults.emplace_back(d.inverted ? "inverted: its triangles face inwards" : "encloses no volume");
  return faults;
}

void refuse_unless_meshable(const Diagnosis& d, const std::string& remedy) {
  if (d.meshable()) return;
  std::vector<Fault> faults;
  for (const std::string& fault : faults_of(d)) faults.push_back({"surface", fault + "; " + remedy});
  throw InputError(std::move(faults));
}

void note(RepairReport& report, const std::string& name, Index count, const std::string& done) {
  if (count > 0) report.steps.push_back({name, count, std::to_string(count) + " " + done});
}

Surface clean_up(const Surface& surface, RepairReport& report) {
  CleanReport cleaned;
  Surface result = clean(surface, cleaned);
  note(report, "weld", cleaned.welded, "duplicate vertices welded");
  note(report, "repeated", cleaned.repeated, "triangles that used a vertex twice dropped");
  note(report, "duplicates", cleaned.duplicates, "duplicate triangles dropped");
  note(report, "unused", cleaned.unused, "vertices without a triangle dropped");
  const Index near = weld_open_edges(result, 1e-6);
  note(report, "weld near", near, "vertices of open edges welded within 1e-6 of the size");
  CleanReport again;
  return near > 0 ? clean(result, again) : result;
}

// Measures what each step of the repair did. Surfaces are in the box of unit size.
class Ladder {
 public:
  Ladder(const Surface& input, double size, RepairReport& report)
      : input_(input), size_(size), volume_(enclosed_volume(input)), report_(report) {}

  // Forgets all but the first `steps` steps, of which `now` is the result.
  void step_down(std::size_t steps, const Surface& now) {
    report_.steps.resize(steps);
    measured_ = steps;
    volume_ = enclosed_volume(now);
  }

  void measure(const Surface& now) {
    if (measured_ == report_.steps.size()) return;
    const double volume = enclosed_volume(now), distance = sampled_distance(input_, now);
    for (; measured_ < report_.steps.size(); ++measured_) {
      RepairStep& step = report_.steps[measured_];
      step.volume_before = std::pow(size_, 3) * volume_;
      step.volume_after = std::pow(size_, 3) * volume;
      step.distance = size_ * distance;
    }
    volume_ = volume;
  }

 private:
  const Surface& input_;
  double size_, volume_;
  RepairReport& report_;
  std::size_t measured_ = 0;
};

void compare(const Surface& input, const Surface& result, const Diagnosis& after, RepairReport& report) {
  report.volume_after = enclosed_volume(result);
  if (!report.steps.empty()) {
    const UnitBox unit(input);
    report.max_distance = unit.size * sampled_distance({unit.to_unit(input.points), input.triangles},
                                                       {unit.to_unit(result.points), result.triangles});
  }
  report.cavities = after.cavities;
  report.pieces = after.components - after.cavities;
  if (report.pieces > 1) {
    report.warnings.push_back(std::to_string(report.pieces) + " separate pieces: each of them is meshed");
  }
  // The enclosed volume means nothing while triangles disagree about the outside.
  const auto turned = std::find_if(report.steps.begin(), report.steps.end(),
                                   [](const RepairStep& step) { return step.name == "orient"; });
  const double before = turned == report.steps.end() ? report.volume_before : turned->volume_after;
  const double change = 100 * (report.volume_after / std::abs(before) - 1);
  if (std::abs(change) > 1) {
    std::ostringstream text;
    text << "the repair changed the enclosed volume by " << std::round(10 * change) / 10 << " %";
    report.warnings.push_back(text.str());
  }
}

// If a gap is wider than alpha, the wrapping enters the body and leaves a hollow shell, which has two sides
// where the surface has one. Then a larger alpha is tried, unless the user chose alpha.
Surface wrap(const Surface& surface, const UnitBox& unit, const RepairOptions& options,
             RepairReport& report) {
  const double diagonal = box_diagonal(surface);
  double alpha = options.wrap_alpha > 0 ? options.wrap_alpha / unit.size : diagonal / 60;
  const double least_volume = 0.5 * std::abs(enclosed_volume(surface)), most_area = 1.75 * area(surface);
  for (;; alpha *= 2) {
    const double offset = options.wrap_offset > 0 ? options.wrap_offset / unit.size : alpha / 30;
    const Surface result = alpha_wrap(surface, alpha, offset);
    if (enclosed_volume(result) >= least_volume && area(result) <= most_area) {
      std::ostringstream text;
      text << "wrapped: a new surface of " << result.triangle_count() << " triangles, " << offset * unit.size
           << " outside the old one, bridging gaps below " << alpha * unit.size;
      report.steps.push_back({"wrap", result.triangle_count(), text.str()});
      return result;
    }
    if (options.wrap_alpha > 0 || alpha > diagonal / 2) {
      throw InputError("surface",
                       "the wrapping falls through a gap and leaves a hollow shell; use a --wrap-alpha "
                       "wider than the gap, or close it by hand");
    }
  }
}

struct Repaired {
  Surface surface;  // [m]
  Diagnosis diagnosis;
};

Surface scaled_back(Surface surface, const UnitBox& unit) {
  surface.points = unit.from_unit(surface.points);
  return surface;
}

// The three ways to repair a surface that was cleaned, in the box of unit size.
class Climb {
 public:
  Climb(const Surface& cleaned, const UnitBox& unit, const RepairOptions& options, Ladder& ladder,
        RepairReport& report)
      : cleaned_(cleaned), unit_(unit), options_(options), ladder_(ladder), report_(report) {}

  // Triangles that only just do not intersect may intersect after they are rounded in another box. Then the
  // repair is done again there.
  Repaired basic() {
    constexpr int most_climbs = 3;
    Repaired result = by_rungs(cleaned_, unit_);
    for (int climb = 1; climb < most_climbs && !result.diagnosis.meshable(); ++climb) {
      const UnitBox box(result.surface);
      result = by_rungs({box.to_unit(result.surface.points), result.surface.triangles}, box);
    }
    refuse_unless_meshable(result.diagnosis, "this is left after the repair: use --repair wrap");
    return result;
  }

  Repaired wrapped() {
    const Surface wrapping = wrap(cleaned_, unit_, options_, report_);
    ladder_.measure(wrapping);
    const Surface result = scaled_back(wrapping, unit_);
    const Diagnosis diagnosis = diagnose(result);
    refuse_unless_meshable(diagnosis, "this is left after the wrapping: use another --wrap-alpha");
    return {result, diagnosis};
  }

  Repaired basic_or_wrapped() {
    const std::size_t steps = report_.steps.size();
    std::string reason;
    try {
      return basic();
    } catch (const InputError& error) {
      reason = error.faults().front().place + ": " + error.faults().front().message;
    } catch (const MeshingFailure& failure) {
      reason = failure.what();
    }
    ladder_.step_down(steps, cleaned_);
    for (const char* remedy : {"; this is left after the repair", ": use --repair wrap"})
      reason = reason.substr(0, reason.find(remedy));
    report_.warnings.push_back("wrapped, because the repair did not succeed (" + reason + ")");
    return wrapped();
  }

 private:
  Repaired by_rungs(const Surface& surface, const UnitBox& box) {
    const auto measure = [&](const Surface& now) {
      ladder_.measure({unit_.to_unit(box.from_unit(now.points)), now.triangles});
    };
    if (std::optional<Repaired> turned = by_turning(surface, box)) return std::move(*turned);
    try {
      const Surface result =
          scaled_back(repair_in_steps(surface, options_.largest_hole, report_, measure), box);
      return {result, diagnose(result)};
    } catch (const MeshingFailure& failure) {
      std::string text;
      for (const std::string& fault : faults_of(diagnose(scaled_back(surface, box)))) text += fault + "; ";
      throw MeshingFailure(text + failure.what());
    }
  }

  // Enough where triangles face the wrong way, and nothing else is wrong. None where it is not.
  std::optional<Repaired> by_turning(const Surface& surface, const UnitBox& box) {
    Turned turned;
    const std::optional<Surface> upright = turned_outwards(surface, turned);
    if (!upright) return {};
    Repaired result{scaled_back(*upright, box), {}};
    result.diagnosis = diagnose(result.surface);
    if (!result.diagnosis.meshable()) return {};
    const auto note_turned = [&](const std::string& name, Index count, const std::string& why) {
      const std::string triangles = count == 1 ? " triangle " : " triangles ";
      if (count > 0)
        report_.steps.push_back({name, count, "turned " + std::to_string(count) + triangles + why});
      ladder_.measure({unit_.to_unit(result.surface.points), result.surface.triangles});
    };
    note_turned("orient", turned.to_agree, "to agree with the neighbours");
    note_turned("inverted", turned.outwards, "of an inverted piece to face outwards");
    return result;
  }

  const Surface& cleaned_;
  const UnitBox& unit_;
  const RepairOptions& options_;
  Ladder& ladder_;
  RepairReport& report_;
};

}  // namespace

std::string RepairStep::in_words() const {
  return message + " (" + rounded(volume_before) + " → " + rounded(volume_after) + " m³, at most " +
         rounded(distance) + " m from the input)";
}

Surface repair_surface(const Surface& surface, const RepairOptions& options, RepairReport& report) {
  refuse_hopeless(surface);
  report = {};
  report.volume_before = enclosed_volume(surface);
  const Diagnosis before = diagnose(surface);
  if (options.level == Repair::none) refuse_unless_meshable(before, "use --repair basic");
  const bool wraps = options.level == Repair::wrap;
  if (!wraps && before.meshable() && (options.level == Repair::none || before.components == 1)) {
    CleanReport ignored;
    const Surface same = before.unused_points > 0 ? clean(surface, ignored) : surface;
    compare(surface, same, before, report);
    return same;
  }
  const UnitBox unit(surface);
  const Surface input{unit.to_unit(surface.points), surface.triangles};
  Ladder ladder(input, unit.size, report);
  const Surface cleaned = clean_up(input, report);
  ladder.measure(cleaned);
  Climb climb(cleaned, unit, options, ladder, report);
  const Repaired result = wraps                                     ? climb.wrapped()
                          : options.level == Repair::wrap_if_needed ? climb.basic_or_wrapped()
                                                                    : climb.basic();
  compare(surface, result.surface, result.diagnosis, report);
  return result.surface;
}

}  // namespace lobe::meshing

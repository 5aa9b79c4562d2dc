#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "lobe/forces/embedded.h"
#include "lobe/scene/resolve_parts.h"

namespace lobe {
namespace {

class ThreadResolver {
 public:
  ThreadResolver(Resolution& resolution)
      : resolution_(resolution), setup_(resolution.result.setup), locator_(setup_.mesh) {}

  void resolve(const SceneThread& thread, const std::string& place) {
    for (std::size_t i = 0; i < thread.stitches.size(); ++i) {
      const std::string here = place + "/stitches/" + std::to_string(i);
      StitchSetup stitch = resolve(thread.stitches[i], here);
      stitch.name = thread.name;
      if (thread.stitches.size() > 1) stitch.name += ", stitch " + std::to_string(i + 1);
      stitch.material = thread.material;
      setup_.stitches.push_back(std::move(stitch));
    }
  }

 private:
  StitchSetup resolve(const SceneStitch& entry, const std::string& here) {
    StitchSetup stitch;
    stitch.at = entry.at;
    for (std::size_t k = 0; k < entry.through.size(); ++k)
      stitch.bites.push_back(find(entry.through[k], here + "/through/" + std::to_string(k)));
    for (std::size_t k = 0; k < entry.ties.size(); ++k) {
      const auto last = Index(entry.through.size()) - 1;
      const std::array<Index, 2> between = entry.ties[k].between.value_or(std::array<Index, 2>{0, last});
      const SceneTie& tie = entry.ties[k];
      stitch.ties.push_back({between[0], between[1], tie.at, tie.tighten, tie.over});
      check(entry, stitch.ties, here + "/tie" + (entry.ties.size() > 1 ? "/" + std::to_string(k) : ""));
    }
    const double duration = resolution_.scene.time.duration;
    if (entry.at > duration)
      resolution_.warn(here + "/at", rounded(entry.at) + " s, after the run's duration of " +
                                         rounded(duration) + " s: it is never sewn");
    return stitch;
  }

  EmbeddedPoint find(const Vec3d& X, const std::string& place) {
    const double rounding = 1e-6 * (bounding_box(setup_.mesh).max - bounding_box(setup_.mesh).min).norm();
    const FoundPoint found = embed(locator_, X);
    if (found.distance > rounding)
      resolution_.fail(place, "is " + rounded(found.distance) +
                                  " m outside of every tetrahedron: a thread passes through tissue");
    if (setup_.region_of[std::size_t(found.point.tet)] == RegionModel::precomputed)
      resolution_.fail(place, "lies in tetrahedron " + std::to_string(found.point.tet) +
                                  " of a precomputed region, where nothing can pull: make it \"nonlinear\" "
                                  "or \"tensor-mass\" there");
    return found.point;
  }

  // The last of the knots.
  void check(const SceneStitch& stitch, const std::vector<TieSetup>& ties, const std::string& place) {
    const TieSetup& tie = ties.back();
    const auto count = Index(stitch.through.size());
    if (tie.from >= tie.to || tie.to >= count)
      return resolution_.fail(place + "/between",
                              "must be two of the " + std::to_string(count) +
                                  " points of the stitch, numbered from 0, in their order");
    if (tie.at < stitch.at)
      resolution_.fail(place + "/at",
                       rounded(tie.at) + " s, before the stitch is sewn, at " + rounded(stitch.at) + " s");
    for (std::size_t i = 0; i + 1 < ties.size(); ++i)
      if (tie.from < ties[i].to && ties[i].from < tie.to)
        resolution_.fail(place + "/between", "its loop and that of an earlier knot overlap");
    const auto point = [&](Index i) { return stitch.through[std::size_t(i)]; };
    double path = (point(tie.to) - point(tie.from)).norm();
    for (Index i = tie.from; i < tie.to; ++i) path += (point(i + 1) - point(i)).norm();
    if (tie.tighten > path / 2)
      resolution_.fail(place + "/tighten", rounded(tie.tighten) + " m, leaves less than half of the loop's " +
                                               rounded(path) + " m");
  }

  Resolution& resolution_;
  Setup& setup_;
  Locator locator_;
};

}  // namespace

void SceneThread::resolve(const std::vector<SceneThread>& all, Resolution& resolution) {
  ThreadResolver resolver(resolution);
  for (std::size_t i = 0; i < all.size(); ++i) resolver.resolve(all[i], "/threads/" + std::to_string(i));
}

template <class Json>
Json SceneThread::summary(const Setup&, std::size_t) const {
  std::size_t bites = 0, knots = 0;
  for (const SceneStitch& stitch : stitches) {
    bites += stitch.through.size();
    knots += stitch.ties.size();
  }
  Json entry = {{"name", name},
                {"stiffness_N", material.stiffness},
                {"friction", material.friction},
                {"stitches", stitches.size()},
                {"bites", bites},
                {"knots", knots}};
  if (material.strength < unlimited) entry["strength_N"] = material.strength;
  if (material.holds < unlimited) entry["holds_N"] = material.holds;
  return entry;
}
template nlohmann::ordered_json SceneThread::summary(const Setup&, std::size_t) const;

template <class Json>
void SceneThread::print(const Json& thread, std::ostream& out) {
  out << "thread     " << thread["name"].template get<std::string>() << ": EA "
      << rounded(thread["stiffness_N"]) << " N, friction " << rounded(thread["friction"]) << ", "
      << thread["stitches"] << " stitches, " << thread["bites"] << " bites, " << thread["knots"] << " knots";
  if (thread.contains("strength_N")) out << ", breaks at " << rounded(thread["strength_N"]) << " N";
  if (thread.contains("holds_N")) out << ", tissue holds " << rounded(thread["holds_N"]) << " N";
}
template void SceneThread::print(const nlohmann::ordered_json&, std::ostream&);

}  // namespace lobe

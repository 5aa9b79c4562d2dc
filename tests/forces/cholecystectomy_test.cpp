// The shipped scene of an operation: a gallbladder is peeled off its bed, its duct and artery are cut.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>

#include "lobe/scene/read_scene.h"
#include "lobe/scene/resolve.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/sim/world.h"
#include "near.h"

using namespace lobe;
using namespace lobe::test;

namespace {

constexpr double frame_of_operation = 0.04;  // [s]

struct Operation {
  double duration = 0;  // [s]
  Setup setup;

  explicit Operation(const std::string& name = "cholecystectomy") {
    const Scene scene = read_scene(std::filesystem::path(LOBE_DATA_DIR) / "scenes" / (name + ".json"));
    Resolved resolved = resolve(scene, read_scene_mesh(scene).mesh);
    CHECK(resolved.warnings.empty());
    duration = scene.time.duration;
    setup = std::move(resolved.setup);
    setup.contact.self = false;  // the organs are apart, so that it would only cost time
  }
  // Leaves out what is before `start`, and plays the rest so many times as fast.
  void play_from(double start, double pace) {
    ToolSetups& tools = setup;
    for_each_tool(tools, [&](auto& tool) {
      std::erase_if(tool.path, [&](const PathPoint& row) { return row.time < start; });
      for (PathPoint& row : tool.path) row.time = (row.time - start) / pace;
    });
    for_each_kind(tools,
                  [](auto& list) { std::erase_if(list, [](auto& tool) { return tool.path.empty(); }); });
    duration = (duration - start) / pace;
  }
};

struct Outcome {
  std::map<Event::Kind, int> events;
  std::map<int, double> open;  // area of open faces that are fed, of each body that carries something [m²]
  std::vector<Index> clips;    // pairs that each clip holds
  AttachmentFigures bed;
  double raised = 0;  // of the middle of the gallbladder [m]
};

Outcome outcome_of(const Operation& operation) {
  World<float> world(operation.setup);
  Outcome outcome;
  const auto height = [&] {
    const Elements& elements = world.elements();
    double sum = 0, count = 0;
    for (Index t = 0; t < elements.topology.tet_count(); ++t) {
      if (!elements.topology.alive(t) || elements.bodies.body_of(t) != 1) continue;
      for (const Index v : elements.topology.corners(t))
        sum += elements.points.col(v)[2] + world.displacements()(2, v);
      count += 4;
    }
    return sum / count;
  };
  const double before = height();
  while (world.time() < operation.duration - 1e-9) {
    const Report report = world.advance(frame_of_operation);
    REQUIRE(report.ok);
    for (const Event& event : report.events) ++outcome.events[event.kind];
  }
  outcome.raised = height() - before;
  for (const ClipFigures& clip : clip_figures(world)) outcome.clips.push_back(clip.pairs);
  for (const CarrierFigures& carrier : carrier_figures(world)) outcome.open[carrier.body] = carrier.open;
  outcome.bed = attachment_figures(world).front();
  return outcome;
}

}  // namespace

TEST_CASE("a gallbladder is peeled off its bed by a hook, and comes away between clips without bleeding") {
  Operation operation;
  operation.play_from(0, 4);
  Index strands = 0;
  double area = 0;
  for (const StrandSetup& strand : operation.setup.attachments[0].strands) {
    ++strands;
    area += strand.area;
  }
  CHECK(area > 5e-4);
  Outcome outcome = outcome_of(operation);
  CHECK(outcome.bed.strands == 0);
  CHECK(outcome.bed.torn.count == 0);  // the hook has burnt all of them
  CHECK(outcome.bed.cut.count == strands);
  CHECK(outcome.bed.cut.area == near(area, 1e-9));
  CHECK(outcome.clips.size() == 5);  // three on the duct, two on the artery
  for (const Index pairs : outcome.clips) CHECK(pairs >= 6);
  CHECK(outcome.events[Event::Kind::clipped] == 5);
  CHECK(outcome.events[Event::Kind::bleeding] == 0);
  CHECK(outcome.events[Event::Kind::leak] == 0);
  CHECK(outcome.raised > 0.05);  // duct and artery are cut through
}

TEST_CASE("without clips the artery bleeds and the duct leaks") {
  for (const bool is_clipped : {true, false}) {
    CAPTURE(is_clipped);
    Operation operation;
    operation.play_from(22.6, 4);
    operation.setup.attachments.erase(
        operation.setup.attachments.begin());  // the bed, which was peeled by then
    GraspSetup& forceps = operation.setup.grasps[0];
    forceps.path.insert(forceps.path.begin(), PathPoint{});
    if (!is_clipped) operation.setup.clip_appliers.clear();
    Outcome outcome = outcome_of(operation);
    CHECK(outcome.events[Event::Kind::clipped] == (is_clipped ? 5 : 0));
    CHECK((outcome.events[Event::Kind::bleeding] > 0) == !is_clipped);
    CHECK((outcome.events[Event::Kind::leak] > 0) == !is_clipped);
    for (const int body : {1, 2}) CHECK((outcome.open[body] > 5e-6) == !is_clipped);
  }
}

TEST_CASE("hands find the same gallbladder, and no tool") {
  const Setup played = Operation().setup, hands = Operation("gallbladder_hands").setup;
  for_each_tool(static_cast<const ToolSetups&>(hands), [](const auto& tool) { FAIL(tool.name); });
  CHECK(hands.mesh.points == played.mesh.points);
  CHECK(hands.mesh.tets == played.mesh.tets);
  CHECK(hands.material_of == played.material_of);
  CHECK(hands.attachments == played.attachments);
  CHECK(hands.carriers.size() == 2);
}

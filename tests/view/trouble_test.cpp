// Exceptions in the threads behind a page: each is told, and ends nothing.
#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>

#include "fake_haply.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::view;
using namespace lobe::test;

namespace {

Json status_of(Live& live) {
  Told told;
  BlockWriter out;
  Json status;
  live.write("none", told, out, status);
  return status;
}

bool says(const Json& status, const char* name) {
  for (const Json& message : status["messages"])
    if (message["name"] == name &&
        message["text"].get<std::string>().find("as you wish") != std::string::npos)
      return true;
  return false;
}

}  // namespace

TEST_CASE("what fails with a picture, or with a measurement, is told, and the simulation goes on") {
  const Viewed viewed;
  const Scene scene = read_scene(viewed.folder.path / "block.json");
  const Resolved resolved = resolve(scene, read_mesh(mesh_path(scene)).mesh);
  std::atomic<bool> fails = false;
  LiveOptions options;
  options.published = [&] {
    if (fails) throw std::runtime_error("as you wish");
  };
  const std::unique_ptr<Live> live = start_live(scene, resolved, options);
  CHECK(comes_to([&] { return status_of(*live).contains("energy"); }));
  fails = true;
  CHECK(comes_to([&] { return says(status_of(*live), "failed"); }));
  std::vector<std::string> troubles;
  CHECK(comes_to([&] {
    const std::vector<std::string> more = live->take_troubles();
    troubles.insert(troubles.end(), more.begin(), more.end());
    return !troubles.empty();
  }));
  CHECK(troubles.front().find("as you wish") != std::string::npos);
  fails = false;
  const double time = status_of(*live)["time"].get<double>();
  live->measure("von_mises");  // another quantity is tried again
  CHECK(comes_to([&] { return status_of(*live)["time"].get<double>() > time + 0.1; }));
  const double measured = status_of(*live)["energy"]["time"].get<double>();
  CHECK(comes_to([&] { return status_of(*live)["energy"]["time"].get<double>() > measured; }));
}

TEST_CASE("a haptic device has one owner: what is simulated anew gets it, and it is never driven twice") {
  FakeService service;
  Viewed viewed(false, "haply", {}, [&](ViewerOptions& options) {
    options.haptic.haply_host = "127.0.0.1";
    options.haptic.haply_port = service.port;
  });
  service.x = 0.04;
  viewed.viewer->opened(1);
  const auto is_felt = [](const Json& status, const Json&) {
    return status.contains("haptic") && status["haptic"].value("there", false);
  };
  REQUIRE(viewed.comes_to(1, is_felt));
  viewed.ask(1, {{"do", "edit"}, {"on", true}});
  viewed.ask(1, {{"do", "paint"}, {"at", {0, 0, 0.06}}, {"radius", 0.02}, {"as", "tensor-mass"}});
  viewed.ask(1, {{"do", "apply"}});
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // it is ready, but no page has asked for it
  // One that has lost its connection waits for a moment, another owner until the first one is gone.
  CHECK(service.longest_wait < 50);
  REQUIRE(viewed.comes_to(1, [](const Json& status, const Json&) { return status["mode"] == "live"; }));
  CHECK(viewed.comes_to(1, is_felt));
  const int forces = service.forces;
  CHECK(comes_to([&] { return service.forces > forces + 100; }));
  // One that has lost its connection waits for a moment, another owner until the first one is gone.
  CHECK(service.longest_wait < 50);
}

TEST_CASE("a page's hand through a device goes on after what was painted is simulated") {
  Viewed viewed(false, "mouse");
  viewed.viewer->opened(1);
  viewed.take(1, 0, 0.03, 0.03);
  REQUIRE(viewed.holds(1, 1));
  viewed.ask(1, {{"do", "edit"}, {"on", true}});
  viewed.ask(1, {{"do", "paint"}, {"at", {0, 0, 0.06}}, {"radius", 0.02}, {"as", "tensor-mass"}});
  viewed.ask(1, {{"do", "apply"}});
  REQUIRE(viewed.comes_to(
      1, [](const Json& status, const Json& tools) { return status["mode"] == "live" && tools.empty(); }));
  viewed.take(1, 0, 0.03, 0.03);
  viewed.lead(1, 0, 0.03, 0.03, 0.07);
  CHECK(viewed.comes_to(1, [](const Json& status, const Json& tools) {
    return tools.size() == 1 && tools[0]["position"][2].get<double>() > 0.064 &&
           status["haptic"]["force"][2].get<double>() < -0.02;
  }));
}

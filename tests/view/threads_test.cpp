// Everything of lobe view at once, as fast as it can: meant for the thread sanitizer.
#include <doctest/doctest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

#include "page_files.h"
#include "socket_client.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// What a program does around a viewer: a server, its thread, and one that looks for news.
struct Served {
  explicit Served(view::Viewer& viewer)
      : viewer_(viewer), server_({.port = 0, .token = "secret"}, view::page_files(), viewer) {
    viewer.set_server(&server_);
    serving_ = std::thread([this] { server_.run(); });
    waking_ = std::thread([this] {
      for (std::uint64_t known = 0; !ends_; std::this_thread::sleep_for(std::chrono::milliseconds(1)))
        if (const std::uint64_t news = viewer_.news(); std::exchange(known, news) != news) server_.wake();
    });
  }
  ~Served() {
    ends_ = true;
    waking_.join();
    server_.stop();
    serving_.join();
    viewer_.set_server(nullptr);
  }
  int port() const { return server_.port(); }

 private:
  view::Viewer& viewer_;
  view::Server server_;
  std::atomic<bool> ends_ = false;
  std::thread serving_, waking_;
};

// A page that takes frames and asks for this and that, then goes without a word.
// Returns how many frames it has seen.
int visit(int port, unsigned seed) {
  std::mt19937 random(seed);
  Client client(port);
  if (!client.upgrade("/live?token=secret").starts_with("HTTP/1.1 101")) return 0;
  const std::vector<Json> requests = {
      {{"do", "control"}},
      {{"do", "hand_over"}},
      {{"do", "keep"}},
      {{"do", "take"}, {"hand", 0}, {"from", {0.03, 0.03, 1}}, {"along", {0, 0, -1}}, {"radius", 0.02}},
      {{"do", "lead"}, {"hand", 0}, {"to", {0.03, 0.035, 0.065}}},
      {{"do", "bring"},
       {"hand", 1},
       {"tool", {{"type", "cautery"}, {"radius", 0.005}, {"at", {0.01, 0.01, 0.06}}}}},
      {{"do", "turn_on"}, {"hand", 1}, {"on", true}},
      {{"do", "let_go"}, {"hand", 0}},
      {{"do", "show"}, {"what", "von_mises"}},
      {{"do", "show"}, {"what", "linear_error"}},
      {{"do", "skin"}, {"on", true}},
      {{"do", "back"}, {"seconds", 0.05}},
      {{"do", "edit"}, {"on", true}},
      {{"do", "paint"}, {"at", {0, 0, 0.06}}, {"radius", 0.02}, {"as", "tensor-mass"}},
      {{"do", "apply"}},
      {{"do", "edit"}, {"on", false}},
      {{"do", "export"}, {"to", "hands"}},
      {{"do", "speed"}, {"factor", 2}}};
  int frames = 0;
  for (int i = 0; i < 60; ++i) {
    client.say(requests[random() % requests.size()].dump());
    const int kind = client.hear().first;
    if (kind == 0) break;
    frames += kind == 2;
    if (kind == 2) client.say(R"({"do": "seen"})");
  }
  return frames;
}

#ifdef LOBE_SANITIZED
constexpr unsigned rounds = 4;
#else  // in which only a crash or a wait without an end would be seen
constexpr unsigned rounds = 1;
#endif

void visit_all(Viewed& viewed) {
  {
    Served served(*viewed.viewer);
    std::vector<std::thread> pages;
    std::atomic<int> frames = 0;
    for (unsigned page = 0; page < 3; ++page)
      pages.emplace_back([&, page] {
        for (unsigned round = 0; round < rounds; ++round) frames += visit(served.port(), 10 * page + round);
      });
    for (std::thread& page : pages) page.join();
    CHECK(frames > 5);  // each page has seen some, however busy the machine is
  }
  // A simulation that is still being prepared has the viewer's own threads.
  for (int i = 0; i < 2000 && viewed.viewer->is_preparing(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK_FALSE(viewed.viewer->is_preparing());
  CHECK(!viewed.viewer->write_recordings().empty());
}

}  // namespace

TEST_CASE("pages that come, ask, take over and go, while the simulation is measured, painted and replaced") {
  Viewed viewed(true);
  visit_all(viewed);
}

TEST_CASE("the same with a haptic device, which passes from one simulation to the next") {
  Viewed viewed(true, "mouse");
  visit_all(viewed);
}

// lobe-view serves a page on which hands move an organ (docs/live.md). `lobe view` starts it.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <random>
#include <thread>

#include "console.h"
#include "lobe/error.h"
#include "lobe/haptic/trial.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/read_scene.h"
#include "page_files.h"
#include "viewer.h"

namespace {

using namespace lobe;
using namespace lobe::program;

struct Arguments {
  std::filesystem::path scene, mesh, record, folder = ".";
  view::ServerOptions server;
  view::LiveOptions live;
  bool no_open = false, has_frame = false;
};

std::atomic<bool> is_asked_to_end = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // as a signal handler wants it

extern "C" void ask_to_end(int) { is_asked_to_end = true; }

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 24; ++i) token += "abcdefghijklmnopqrstuvwxyz234567"[device() % 32];
  return token;
}

// The token is the same from run to run, so that an open page finds the next run. It is in a file that nobody
// else can read.
std::string kept_token() {
  const char *state = std::getenv("XDG_STATE_HOME"), *home = std::getenv("HOME");
  if (!state && !home) return random_token();
  const std::filesystem::path folder =
      (state ? std::filesystem::path(state) : std::filesystem::path(home) / ".local/state") / "lobe";
  const std::filesystem::path file = folder / "view_token";
  std::string token;
  if (std::ifstream(file) >> token && token.size() >= 24) return token;
  token = random_token();
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  std::ofstream out(file);
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write,
                               ignored);
  out << token << '\n';
  return token;
}

void add_options(CLI::App& app, Arguments& options) {
  app.add_option("SCENE", options.scene, "scene file (docs/scene.md)")->required();
  app.add_option("--mesh", options.mesh, "mesh to use in place of the scene's");
  app.add_option("--port", options.server.port, "port of the page; 0: a free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--host", options.server.host,
                 "address to listen on; with another than this machine's own, others can connect")
      ->capture_default_str();
  app.add_option("--token", options.server.token,
                 "key to the page, in its address; otherwise one is made and stored");
  app.add_option("--record", options.record, "file to record the session in, for `lobe replay`");
  app.add_option("--speed", options.live.speed, "simulated seconds per second")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  app.add_option(
         "--frame", options.live.frame,
         "simulated time between two pictures [s]; with a haptic device 0.001 where that is fast enough")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str()
      ->each([&](const std::string&) { options.has_frame = true; });
  app.add_option("--haptic", options.live.haptic.device,
                 "device that holds what the page takes hold of: none, mouse, hand (simulated), or haply, "
                 "which takes hold by its own button (docs/haptics.md)")
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(view::haptic_devices), std::end(view::haptic_devices))))
      ->capture_default_str();
  app.add_option("--threads", options.live.threads, "threads of the simulation")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--save-to", options.folder, "folder for scenes that are saved")->capture_default_str();
  app.add_flag("--no-open", options.no_open, "open no browser");
}

std::pair<Scene, Resolved> load(const Arguments& options) {
  Scene scene = read_scene(options.scene);
  if (!options.mesh.empty()) scene.mesh = std::filesystem::absolute(options.mesh);
  MeshFile mesh = read_mesh(mesh_path(scene));
  print_warnings(mesh.prepared.warnings());
  const auto resolved_with_progress = [&] {
    ProgressBar bar("choosing regions");
    return resolve(scene, std::move(mesh.mesh), {true, [&](double fraction) { bar.show(fraction); }});
  };
  Resolved resolved = resolved_with_progress();
  print_warnings(resolved.warnings);
  return {std::move(scene), std::move(resolved)};
}

// Opens a browser, if there is a display.
void open_browser(const std::string& address) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  if (fork() == 0) {
    if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) _exit(127);
    execlp("xdg-open", "xdg-open", address.c_str(), nullptr);
    _exit(127);
  }
}

std::string address_of(const Arguments& options, int port) {
  std::string host = options.server.host;
  if (host == "127.0.0.1" || host == "::1") host = "localhost";
  if (host == "0.0.0.0" || host == "::") {
    char name[256] = "localhost";
    gethostname(name, sizeof name - 1);
    host = name;
  }
  return "http://" + host + ":" + std::to_string(port) + "/?token=" + options.server.token;
}

// Takes frames of 1 ms if the machine is fast enough, so that the simulation itself answers the hand.
void choose_frame(const Scene& scene, const Setup& setup, Arguments& options) {
  if (!options.has_frame) {
    const HapticTrial trial = scene.in_double() ? try_direct<double>(setup, options.live.threads)
                                                : try_direct<float>(setup, options.live.threads);
    if (trial.is_direct) options.live.frame = direct_frame;
    std::printf("haptic: a frame of 1 ms takes %.2f ms, 99 %% of them at most %.2f ms\n", 1e3 * trial.p50,
                1e3 * trial.p99);
  }
  options.live.haptic.is_direct = options.live.frame <= direct_frame;
  std::printf("haptic: %s, frames of %.1f ms, forces at 1 kHz\n",
              options.live.haptic.is_direct ? "direct" : "extrapolated by the local stiffness",
              1e3 * options.live.frame);
}

int serve(Arguments& options) {
  if (options.server.token.empty()) options.server.token = kept_token();
  auto [scene, resolved] = load(options);
  if (options.live.haptic.device != "none") choose_frame(scene, resolved.setup, options);
  std::unique_ptr<view::Viewer> viewer;
  {
    ProgressBar bar("condensing");
    view::ViewerOptions viewer_options{options.live, options.folder};
    viewer_options.live.condensing = [&](double fraction) { bar.show(fraction); };
    viewer = std::make_unique<view::Viewer>(std::move(scene), std::move(resolved), viewer_options);
  }
  view::Server server(options.server, view::page_files(), *viewer);
  viewer->set_server(&server);
  std::signal(SIGINT, ask_to_end);  // before anybody knows that there is something to end
  std::signal(SIGTERM, ask_to_end);
  const std::string address = address_of(options, server.port());
  std::printf("%s\nCtrl+C ends it.\n", address.c_str());
  std::fflush(stdout);
  if (!options.no_open) open_browser(address);

  std::thread waker([&] {
    for (std::uint64_t known = 0; !is_asked_to_end;
         std::this_thread::sleep_for(std::chrono::milliseconds(20)))
      if (const std::uint64_t news = viewer->news(); std::exchange(known, news) != news) server.wake();
    server.stop();
  });
  server.run();
  waker.join();
  viewer->set_server(nullptr);
  if (!options.record.empty()) {
    viewer->write_recording(options.record);
    std::printf("recorded in %s\n", options.record.c_str());
  }
  std::fflush(stdout);
  if (viewer->is_preparing()) std::_Exit(done);  // what nobody will see need not be waited for
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Simulates an organ live, in a web page"};
  Arguments options;
  add_options(app, options);
  try {
    app.parse(argc, argv);
    return serve(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? done : bad_input;
  } catch (const std::exception& error) {
    print_errors(error.what());
  }
  return bad_input;
}

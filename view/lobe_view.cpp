// lobe-view serves a page on which hands move an organ (docs/live.md). `lobe view` starts it.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <optional>
#include <stop_token>
#include <thread>

#include "browser.h"
#include "console.h"
#include "lobe/error.h"
#include "lobe/haptic/trial.h"
#include "lobe/io/mesh_io.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "pace.h"
#include "page_files.h"
#include "token.h"
#include "viewer.h"

namespace {

using namespace lobe;
using namespace lobe::program;

struct Arguments {
  std::filesystem::path scene, mesh;
  view::ServerOptions server;
  view::ViewerOptions viewer;
  double patience = 1e-3 * double(view::ViewerOptions{}.patience.count());  // [s]
  bool no_open = false, has_frame = false, is_temporary = false;
};

std::atomic<bool> is_asked_to_end = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // as a signal handler wants it

extern "C" void ask_to_end(int) { is_asked_to_end = true; }

// Ctrl+C, `kill`, and a terminal that is closed end the program as it should; one that no longer reads does
// not end it.
void listen_to_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, ask_to_end);
  std::signal(SIGPIPE, SIG_IGN);
}

// The token is the same from run to run, so that an open page finds the next run.
std::string own_token() {
  const std::filesystem::path file = view::token_file();
  return file.empty() ? view::random_token() : view::kept_token(file);
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
  app.add_option("--record", options.viewer.record, "file to record the session in, for `lobe replay`");
  app.add_option("--speed", options.viewer.live.speed, "simulated seconds per second")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  app.add_option(
         "--frame", options.viewer.live.frame,
         "simulated time between two pictures [s]; with a haptic device 0.001 where that is fast enough")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str()
      ->each([&](const std::string&) { options.has_frame = true; });
  app.add_option("--haptic", options.viewer.haptic.device,
                 "device that holds what the page takes hold of: none, mouse, hand (simulated), or haply, "
                 "which takes hold by its own button (docs/haptics.md)")
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(view::haptic_devices), std::end(view::haptic_devices))))
      ->capture_default_str();
  app.add_option(
         "--patience", options.patience,
         "time after which the instruments go to a page that has asked for them, if the one that has them "
         "holds nothing and does not answer [s]")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.add_option("--threads", options.viewer.live.threads, "threads of the simulation")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--save-to", options.viewer.folder, "folder for scenes that are saved")
      ->capture_default_str();
  app.add_flag("--no-open", options.no_open, "open no browser");
  app.add_option("--made-from", options.viewer.origin.files,
                 "file that `lobe scene` has made the scene from: the page can then make it anew")
      ->allow_extra_args(false);
  app.add_option("--made-warning", options.viewer.origin.warnings,
                 "what lobe-mesh has said of its mesh, for the page to show")
      ->allow_extra_args(false);
  app.add_option("--made-scale", options.viewer.origin.scale, "the --scale that it was made with");
  app.add_flag(
      "--temporary", options.is_temporary,
      "remove the scene file, and a mesh beside it, as soon as they are read: for programs that have "
      "written them for this call");
}

// The meshes of a scene that lie in its folder.
std::vector<std::filesystem::path> meshes_beside(const Scene& scene) {
  std::vector<std::filesystem::path> found;
  const auto add = [&](const std::filesystem::path& mesh) {
    if (!mesh.empty() && mesh.is_relative() && !mesh.has_parent_path())
      found.push_back(scene.file.parent_path() / mesh);
  };
  add(scene.mesh);
  for (const SceneBody& body : scene.bodies) add(body.mesh);
  return found;
}

// Removes a scene that was written for this call alone, meshes beside it, and their folder if it is empty
// then; also where they cannot be read.
struct TemporaryScene {
  explicit TemporaryScene(const std::filesystem::path& scene) : file(scene) {}
  TemporaryScene(const TemporaryScene&) = delete;
  TemporaryScene& operator=(const TemporaryScene&) = delete;
  ~TemporaryScene() {
    std::error_code ignored;  // the system removes its temporary files some day
    meshes.insert(meshes.end(), {file, file.parent_path()});
    for (const auto& path : meshes)
      if (!path.empty()) std::filesystem::remove(path, ignored);
  }
  std::filesystem::path file;
  std::vector<std::filesystem::path> meshes;
};

std::pair<Scene, Resolved> load(const Arguments& options) {
  std::optional<TemporaryScene> temporary;
  if (options.is_temporary) temporary.emplace(options.scene);
  Scene scene = read_scene(options.scene);
  if (temporary) temporary->meshes = meshes_beside(scene);
  if (!options.mesh.empty()) replace_mesh(options.mesh, scene);
  MeshFile mesh = read_scene_mesh(scene);
  bind_groups(mesh, scene);
  print_warnings(mesh.warnings());
  const auto resolved_with_progress = [&] {
    ProgressBar bar("choosing regions");
    return resolve(scene, std::move(mesh.mesh), {true, [&](double fraction) { bar.show(fraction); }});
  };
  Resolved resolved = resolved_with_progress();
  print_warnings(resolved.warnings);
  return {std::move(scene), std::move(resolved)};
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
    const HapticTrial trial = scene.in_double() ? try_direct<double>(setup, options.viewer.live.threads)
                                                : try_direct<float>(setup, options.viewer.live.threads);
    if (trial.is_direct) options.viewer.live.frame = direct_frame;
    std::printf("haptic: a frame of 1 ms takes %.2f ms, 99 %% of them at most %.2f ms\n", 1e3 * trial.p50,
                1e3 * trial.p99);
  }
  options.viewer.haptic.is_direct = options.viewer.live.frame <= direct_frame;
  std::printf("haptic: %s, frames of %.1f ms, forces at 1 kHz\n",
              options.viewer.haptic.is_direct ? "direct" : "extrapolated by the local stiffness",
              1e3 * options.viewer.live.frame);
}

std::unique_ptr<view::Viewer> begin(Arguments& options) {
  auto [scene, resolved] = load(options);
  if (options.viewer.haptic.device != "none") choose_frame(scene, resolved.setup, options);
  ProgressBar bar("condensing");
  view::ViewerOptions viewer_options = options.viewer;
  viewer_options.saves_mesh = options.is_temporary && !meshes_beside(scene).empty();
  viewer_options.live.running = false;  // it begins with the first page
  viewer_options.pace = view::measured_pace(options.viewer.live.threads);
  viewer_options.patience = std::chrono::milliseconds(std::lround(1e3 * options.patience));
  viewer_options.live.condensing = [&](double fraction) { bar.show(fraction); };
  return std::make_unique<view::Viewer>(std::move(scene), std::move(resolved), viewer_options);
}

// Until somebody asks it to end.
void serve_pages(view::Server& server, const view::Viewer& viewer) {
  const std::jthread waker([&](const std::stop_token& stop) {
    for (std::uint64_t known = 0; !is_asked_to_end && !stop.stop_requested();
         std::this_thread::sleep_for(std::chrono::milliseconds(20)))
      if (const std::uint64_t news = viewer.news(); std::exchange(known, news) != news) server.wake();
    server.stop();
  });
  server.run();
}

void write_recordings(const Arguments& options, view::Viewer& viewer) {
  if (options.viewer.record.empty()) return;
  for (const auto& [scene, recording] : viewer.write_recordings())
    std::printf(
        "recorded; to compare: lobe replay %s %s%s\n", scene.c_str(), recording.c_str(),
        scene == options.scene && !options.mesh.empty() ? (" --mesh " + options.mesh.string()).c_str() : "");
}

// What was done is recorded whatever ends the program.
int serve(Arguments& options) {
  if (options.server.token.empty()) options.server.token = own_token();
  const std::unique_ptr<view::Viewer> viewer = begin(options);
  view::Server server(options.server, view::page_files(), *viewer);
  viewer->set_server(&server);
  listen_to_signals();  // before anybody knows that there is something to end
  const std::string address = address_of(options, server.port());
  std::printf("%s\nCtrl+C ends it.\n", address.c_str());
  std::fflush(stdout);
  if (!options.no_open) view::open_browser(address);

  Status status = done;
  const auto attempt = [&](const auto& work) {
    try {
      work();
    } catch (const std::exception& error) {
      print_errors(error.what());
      status = bad_input;
    }
  };
  attempt([&] { serve_pages(server, *viewer); });
  viewer->set_server(nullptr);
  attempt([&] { write_recordings(options, *viewer); });
  std::fflush(stdout);
  if (!viewer->abandon()) std::_Exit(status);  // what nobody will see need not be waited for
  return status;
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

#include "session.h"

#include <filesystem>

#include "lobe/file/atomic_file.h"
#include "lobe/haptic/haptic_hand.h"
#include "lobe/io/mesh_io.h"
#include "lobe/live/session_scene.h"
#include "lobe/run/recording.h"
#include "lobe/scene/bind_groups.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "lobe/text.h"

std::unique_ptr<lobe_session::Buffers> lobe_session::take_buffers() {
  const std::lock_guard lock(mutex_);
  if (free_.empty()) return std::make_unique<Buffers>();
  std::unique_ptr<Buffers> buffers = std::move(free_.back());
  free_.pop_back();
  return buffers;
}

void lobe_session::give_back(std::unique_ptr<Buffers> buffers) {
  const std::lock_guard lock(mutex_);
  free_.push_back(std::move(buffers));
}

namespace lobe::c {
namespace {

constexpr std::uint32_t most_threads = 256;

// Throws InputError for what the header does not allow.
SessionOptions session_options(const lobe_options& options) {
  const auto expect = [](bool is_met, const char* field, double given, const char* range) {
    if (!is_met)
      throw InputError(std::string("lobe_options.") + field, rounded(given) + ", must be " + range);
  };
  expect(options.threads <= most_threads, "threads", options.threads, "from 1 to 256, or 0 for 1");
  expect(options.frame == 0 || (options.frame > 0 && options.frame <= 1), "frame", options.frame,
         "above 0 and at most 1 s, or 0 for 1/120 s");
  expect(options.speed == 0 || is_session_speed(options.speed), "speed", options.speed,
         "from 0.001 to 100, or 0 for 1");
  SessionOptions made;
  if (options.threads > 0) made.threads = static_cast<int>(options.threads);
  if (options.frame != 0) made.frame = options.frame;
  if (options.speed != 0) made.speed = options.speed;
  made.paced = options.unpaced == 0;
  made.running = options.paused == 0;
  return made;
}

template <class Real>
class SessionOf : public lobe_session {
 public:
  SessionOf(Scene scene, Resolved resolved, const SessionOptions& options)
      : scene_(std::move(scene)),
        setup_(session_setup(scene_, std::move(resolved.setup))),
        session_(setup_, options),
        controller_(session_.connect("engine")),
        sewing_(session_, [this](const HandCommand& command) { return controller_.send(command); }) {}

  ~SessionOf() override { haptic_tools.clear(); }

  std::shared_ptr<void> lead_by(HapticTool& tool) override {
    return std::make_shared<HapticHand<Real>>(
        session_, tool.link,
        typename HapticHand<Real>::Settings{.controller = controller_.number(), .hand = tool.tool});
  }
  lobe_status send(const HandCommand& command) override {
    return controller_.send(command) ? LOBE_OK : LOBE_BUSY;
  }
  void start() override { session_.start(); }
  void stop() override { session_.stop(); }
  bool is_started() const override { return session_.is_started(); }
  void step_frame() override { session_.step_frame(); }
  TripleBuffer<SessionStatus>::View status() const override { return session_.status(); }
  int controller() const override { return controller_.number(); }
  Index tet_count() const override {
    const auto picture = session_.pictures().latest();
    return picture ? picture->figures.tets : setup_.mesh.tet_count();
  }
  bool fill(lobe_surface& surface) override;
  SewingHand& sewing() override { return sewing_; }
  std::vector<LinesSnapshot> lines() const override {
    const auto picture = session_.pictures().latest();
    return picture ? picture->lines : std::vector<LinesSnapshot>();
  }
  void save_scene(const std::string& file) override {
    between([&] { io::write_file(file, to_json(session_scene(scene_, setup_, session_))); });
  }
  void save_recording(const std::string& file) override {
    between([&] { write_recording(file, session_.recording()); });
  }
  void save(const std::string& file) override {
    between([&] { session_.save(file); });
  }
  void restore(const std::string& file) override {
    between([&] { session_.restore(file); });
  }

 private:
  void between(const std::function<void()>& work) {
    session_.is_started() ? session_.between_frames(work) : work();
  }

  Scene scene_;
  Setup setup_;
  Session<Real> session_;
  Controller controller_;
  Sewing<Real> sewing_;
};

template <class Real>
bool SessionOf<Real>::fill(lobe_surface& surface) {
  const auto picture = session_.pictures().latest();
  if (!picture) return false;
  const SurfaceSnapshot<Real>& from = picture->surface;
  std::unique_ptr<Buffers> to = take_buffers();
  const auto vertices = std::size_t(from.mesh->vertex_count()),
             triangles = std::size_t(from.mesh->triangle_count());
  to->position.resize(3 * vertices);
  to->normal.resize(3 * vertices);
  Eigen::Map<Mat3X<float>> x(to->position.data(), 3, Index(vertices)),
      n(to->normal.data(), 3, Index(vertices));
  for (Index v = 0; v < Index(vertices); ++v) {
    x.col(v) = axes.point_out(from.x.col(v).template cast<double>()).template cast<float>();
    n.col(v) = axes.direction_out(from.normals.col(v).template cast<double>()).template cast<float>();
  }
  const int second = axes.is_mirrored() ? 2 : 1;
  to->index.resize(3 * triangles);
  to->region.resize(triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const Eigen::Vector3i& corners = from.mesh->triangles[t];
    to->index[3 * t] = static_cast<std::uint32_t>(corners[0]);
    to->index[3 * t + 1] = static_cast<std::uint32_t>(corners[second]);
    to->index[3 * t + 2] = static_cast<std::uint32_t>(corners[3 - second]);
    to->region[t] = static_cast<std::uint8_t>(from.mesh->region[t]);
  }
  to->cut = from.mesh->cut;
  to->body = from.mesh->body;
  surface = {
      sizeof(lobe_surface), std::uint32_t(vertices), std::uint32_t(triangles), std::uint64_t(picture->frame),
      from.mesh->revision,  picture->time,           to->position.data(),      to->normal.data(),
      to->index.data(),     to->region.data(),       to->cut.data(),           to.get()};
  to.release();  // until lobe_surface_release()
  return true;
}

}  // namespace

std::unique_ptr<lobe_session> open(Scene scene, const lobe_options& options) {
  const Axes axes(options.axes);
  const SessionOptions chosen = session_options(options);
  MeshFile mesh = read_scene_mesh(scene);
  bind_groups(mesh, scene);
  Resolved resolved = resolve(scene, std::move(mesh.mesh));
  std::vector<std::string> bodies = resolved.setup.mesh.bodies.names;
  std::unique_ptr<lobe_session> made;
  if (scene.in_double())
    made = std::make_unique<SessionOf<double>>(std::move(scene), std::move(resolved), chosen);
  else
    made = std::make_unique<SessionOf<float>>(std::move(scene), std::move(resolved), chosen);
  made->axes = axes;
  made->bodies = std::move(bodies);
  return made;
}

}  // namespace lobe::c

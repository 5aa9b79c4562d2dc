// The C functions. They check their arguments, and turn exceptions into a status and a text.
#include "lobe_c.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "lobe/error.h"
#include "lobe/scene/parse_tool.h"
#include "lobe/scene/read_scene.h"
#include "lobe/text.h"
#include "session.h"

using lobe::HandCommand;
using lobe::InputError;
using lobe::Vec3d;

namespace {

thread_local std::string last_error;

lobe_status fail(lobe_status status, const std::string& text) {
  last_error = text;
  return status;
}

// Runs work() and returns what it throws as a status.
template <class Work>
lobe_status guarded(Work&& work) noexcept {
  try {
    try {
      return work();
    } catch (const InputError& error) {
      return fail(LOBE_BAD_INPUT, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
      return fail(LOBE_BAD_INPUT, error.what());
    } catch (const std::exception& error) {
      return fail(LOBE_FAILED, error.what());
    }
  } catch (...) {
    return LOBE_FAILED;  // no memory for the text
  }
}

void require(const void* pointer, const char* name) {
  if (pointer == nullptr) throw InputError(name, "is NULL");
}

// Reads a struct of a caller that may know fewer fields than this library. The missing ones are 0.
template <class Struct>
Struct of_caller(const Struct* given, const char* name) {
  Struct copy{};
  if (given->size < sizeof(std::uint32_t) || given->size > 4096)
    throw InputError(std::string(name) + ".size",
                     std::to_string(given->size) + ", must be sizeof(" + name + ")");
  std::memcpy(&copy, given, std::min<std::size_t>(given->size, sizeof(Struct)));
  return copy;
}
template <class Struct>
void give(const Struct& copy, Struct* to) {
  const std::uint32_t size = to->size;
  std::memcpy(to, &copy, std::min<std::size_t>(size, sizeof(Struct)));
  to->size = size;
}

Vec3d vector_of(const double* values, const char* name) {
  require(values, name);
  return {values[0], values[1], values[2]};
}

// Opens a session of what read() returns, a scene. *session is NULL after a failure.
template <class Read>
lobe_status opened(const Read& read, const lobe_options* options, lobe_session** session) {
  return guarded([&] {
    require(session, "session");
    *session = nullptr;
    lobe_options chosen{};
    if (options != nullptr) chosen = of_caller(options, "lobe_options");
    *session = lobe::c::open(read(), chosen).release();
    return LOBE_OK;
  });
}

lobe_status send(lobe_session* session, HandCommand command) {
  return guarded([&] {
    require(session, "session");
    const lobe_status status = session->send(command);
    return status == LOBE_OK ? status : fail(status, "the queue of commands is full");
  });
}

lobe_status not_started(const lobe_session& session, const char* what) {
  return session.is_started()
             ? fail(LOBE_WRONG_STATE, std::string(what) + ": the session runs in its own thread")
             : LOBE_OK;
}

}  // namespace

uint32_t lobe_abi_version(void) { return LOBE_ABI_VERSION; }
const char* lobe_last_error(void) { return last_error.c_str(); }

lobe_status lobe_open(const char* file, const lobe_options* options, lobe_session** session) {
  const auto read = [&] {
    require(file, "scene_file");
    return lobe::read_scene(file);
  };
  return opened(read, options, session);
}

lobe_status lobe_open_text(const char* scene, const char* folder, const lobe_options* options,
                           lobe_session** session) {
  const auto read = [&] {
    require(scene, "scene");
    return lobe::parse_scene(scene, std::filesystem::path(folder ? folder : ".") / "scene.json");
  };
  return opened(read, options, session);
}

void lobe_close(lobe_session* session) { delete session; }

lobe_status lobe_start(lobe_session* session) {
  return guarded([&] {
    require(session, "session");
    const std::lock_guard lock(session->driving);
    const lobe_status status = not_started(*session, "lobe_start");
    if (status == LOBE_OK) session->start();
    return status;
  });
}

lobe_status lobe_stop(lobe_session* session) {
  return guarded([&] {
    require(session, "session");
    const std::lock_guard lock(session->driving);
    session->stop();
    return LOBE_OK;
  });
}

lobe_status lobe_advance(lobe_session* session, uint32_t frames) {
  return guarded([&] {
    require(session, "session");
    const std::unique_lock lock(session->driving, std::try_to_lock);
    if (!lock) return fail(LOBE_WRONG_STATE, "lobe_advance: another thread drives the session");
    const lobe_status status = not_started(*session, "lobe_advance");
    for (uint32_t i = 0; status == LOBE_OK && i < frames; ++i) session->step_frame();
    return status;
  });
}

lobe_status lobe_pause(lobe_session* session, int paused) {
  return send(session, {.kind = HandCommand::Kind::run, .on = paused == 0});
}
lobe_status lobe_set_speed(lobe_session* session, double speed) {
  return guarded([&] {
    require(session, "session");
    if (!lobe::is_session_speed(speed))
      throw InputError("speed", lobe::rounded(speed) + ", must be from 0.001 to 100");
    return send(session, {.kind = HandCommand::Kind::speed, .value = speed});
  });
}
lobe_status lobe_restart(lobe_session* session) {
  return send(session, {.kind = HandCommand::Kind::restart});
}
lobe_status lobe_back(lobe_session* session, double seconds) {
  return send(session, {.kind = HandCommand::Kind::back, .value = seconds});
}

lobe_status lobe_get_state(lobe_session* session, lobe_state* state) {
  return guarded([&] {
    require(session, "session");
    require(state, "state");
    lobe_state result = of_caller(state, "lobe_state");
    const auto status = session->status();
    if (!status) return fail(LOBE_NOT_YET, "no frame was simulated yet");
    result.tetrahedra = static_cast<std::uint32_t>(session->tet_count());
    result.frame = static_cast<std::uint64_t>(status->picture);
    result.time = status->time;
    result.real_time_factor = status->real_time_factor;
    result.running = status->is_running;
    result.stands_still = status->stands_still;
    give(result, state);
    return LOBE_OK;
  });
}

uint64_t lobe_messages(lobe_session* session, uint64_t after, char* text, uint32_t capacity) {
  std::uint64_t last = after;
  guarded([&] {
    require(session, "session");
    require(text, "text");
    if (capacity == 0) return LOBE_OK;
    text[0] = 0;
    const auto status = session->status();
    if (!status || !status->messages) return LOBE_OK;
    std::size_t used = 0;
    for (const lobe::SessionMessage& message : *status->messages) {
      if (message.number <= after) continue;
      const std::string line =
          std::to_string(message.number) + ' ' + message.name + ": " + message.text + '\n';
      if (used + line.size() + 1 > capacity) break;
      std::memcpy(text + used, line.c_str(), line.size() + 1);
      used += line.size();
      last = message.number;
    }
    return LOBE_OK;
  });
  return last;
}

lobe_status lobe_grasp(lobe_session* session, uint32_t tool, const double point[3], double radius) {
  return guarded([&] {
    require(session, "session");
    return send(session, {.kind = HandCommand::Kind::take_at_point,
                          .hand = tool,
                          .position = session->axes.point_in(vector_of(point, "point")),
                          .radius = session->axes.length_in(radius)});
  });
}

lobe_status lobe_grasp_ray(lobe_session* session, uint32_t tool, const double origin[3],
                           const double direction[3], double radius) {
  return guarded([&] {
    require(session, "session");
    return send(session, {.kind = HandCommand::Kind::take_at_ray,
                          .hand = tool,
                          .position = session->axes.point_in(vector_of(origin, "origin")),
                          .direction = session->axes.direction_in(vector_of(direction, "direction")),
                          .radius = session->axes.length_in(radius)});
  });
}

lobe_status lobe_cautery(lobe_session* session, uint32_t tool, const double tip[3], double radius) {
  return guarded([&] {
    require(session, "session");
    const lobe::Vec3d position = session->axes.point_in(vector_of(tip, "tip"));
    return send(session, lobe::bring_tool(tool, position,
                                          lobe::BringCautery{"", session->axes.length_in(radius), position}));
  });
}

lobe_status lobe_scalpel(lobe_session* session, uint32_t tool, const double tip[3], const double heel[3]) {
  return guarded([&] {
    require(session, "session");
    const lobe::Vec3d position = session->axes.point_in(vector_of(tip, "tip"));
    const lobe::Vec3d end = session->axes.point_in(vector_of(heel, "heel"));
    return send(session, lobe::bring_tool(tool, position, lobe::BringScalpel{"", {position, end}}));
  });
}

lobe_status lobe_bring(lobe_session* session, uint32_t tool, const char* json) {
  return guarded([&] {
    require(session, "session");
    require(json, "json");
    lobe::ParsedTool parsed = lobe::parse_tool(json);
    return send(session, lobe::bring_tool(tool, parsed.position, std::move(parsed.command)));
  });
}

lobe_status lobe_switch(lobe_session* session, uint32_t tool, int on) {
  return send(session, {.kind = HandCommand::Kind::turn_on, .on = on != 0, .hand = tool});
}

lobe_status lobe_move(lobe_session* session, uint32_t tool, const double pose[7]) {
  return guarded([&] {
    require(session, "session");
    require(pose, "pose");
    return send(session, {.kind = HandCommand::Kind::lead,
                          .hand = tool,
                          .position = session->axes.point_in({pose[0], pose[1], pose[2]}),
                          .orientation = session->axes.rotation_in({pose[3], pose[4], pose[5], pose[6]})});
  });
}

lobe_status lobe_release(lobe_session* session, uint32_t tool) {
  return send(session, {.kind = HandCommand::Kind::let_go, .hand = tool});
}

lobe_status lobe_get_tool(lobe_session* session, uint32_t tool, lobe_tool* state) {
  return guarded([&] {
    require(session, "session");
    require(state, "state");
    lobe_tool result = of_caller(state, "lobe_tool");
    const auto status = session->status();
    if (!status) return LOBE_NOT_YET;
    const auto mine = [&](const lobe::HandStatus& hand) {
      return hand.controller == session->controller() && hand.hand == tool;
    };
    const auto found = std::find_if(status->hands.begin(), status->hands.end(), mine);
    if (found == status->hands.end()) return LOBE_NOT_YET;
    const lobe::c::Axes& axes = session->axes;
    result.holds = found->holds;
    result.vertices = static_cast<std::uint32_t>(found->vertices);
    Eigen::Map<Vec3d>(result.pose) = axes.point_out(found->pose.position);
    Eigen::Map<Eigen::Vector4d>(result.pose + 3) = axes.rotation_out(found->pose.orientation);
    Eigen::Map<Vec3d>(result.force) = axes.direction_out(found->force);
    Eigen::Map<Vec3d>(result.torque) = axes.torque_out(found->torque);
    give(result, state);
    return LOBE_OK;
  });
}

// ---- Thread

namespace {

// Does something with a thread; false: the queue is full.
template <class Sew>
lobe_status sewn(lobe_session* session, const Sew& sew) {
  return guarded([&] {
    require(session, "session");
    return sew(session->sewing(), session->axes) ? LOBE_OK : fail(LOBE_BUSY, "the queue of commands is full");
  });
}

lobe::ThreadMaterial material_of(const lobe_thread_material* given) {
  lobe::ThreadMaterial material;
  if (given == nullptr) return material;
  const lobe_thread_material asked = of_caller(given, "lobe_thread_material");
  if (asked.stiffness != 0) material.stiffness = asked.stiffness;
  if (asked.friction != 0) material.friction = std::max(0.0, asked.friction);
  if (asked.strength != 0) material.strength = asked.strength;
  if (asked.holds != 0) material.holds = asked.holds;
  material.check(
      [](bool holds, const std::string& fault) {
        if (!holds) throw InputError("lobe_thread_material", fault);
      },
      "a thread");
  return material;
}

}  // namespace

lobe_status lobe_thread(lobe_session* session, uint32_t thread, const lobe_thread_material* material) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes&) {
    return hand.bring(int(thread), material_of(material));
  });
}

lobe_status lobe_bite(lobe_session* session, uint32_t thread, const double point[3]) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes& axes) {
    return hand.bite_at(int(thread), axes.point_in(vector_of(point, "point")));
  });
}

lobe_status lobe_bite_ray(lobe_session* session, uint32_t thread, const double origin[3],
                          const double direction[3], double depth) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes& axes) {
    return hand.bite_below(int(thread), axes.point_in(vector_of(origin, "origin")),
                           axes.direction_in(vector_of(direction, "direction")), axes.length_in(depth));
  });
}

lobe_status lobe_pull(lobe_session* session, uint32_t thread, const double point[3]) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes& axes) {
    if (point == nullptr) return hand.let_go(int(thread));
    return hand.pull(int(thread), axes.point_in(vector_of(point, "point")));
  });
}

lobe_status lobe_pull_on(lobe_session* session, uint32_t thread, const double direction[3], double force,
                         double speed) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes& axes) {
    return hand.pull_on(int(thread), axes.direction_in(vector_of(direction, "direction")), force,
                        axes.length_in(speed));
  });
}

lobe_status lobe_tie(lobe_session* session, uint32_t thread, int32_t from, int32_t to, double tighten,
                     double over) {
  return sewn(session, [&](lobe::SewingHand& hand, const lobe::c::Axes& axes) {
    return hand.tie(int(thread), from, to, axes.length_in(tighten), over);
  });
}

lobe_status lobe_cut_thread(lobe_session* session, uint32_t thread, int32_t after) {
  return sewn(session,
              [&](lobe::SewingHand& hand, const lobe::c::Axes&) { return hand.cut(int(thread), after); });
}

lobe_status lobe_remove_thread(lobe_session* session, uint32_t thread) {
  return sewn(session,
              [&](lobe::SewingHand& hand, const lobe::c::Axes&) { return hand.remove(int(thread)); });
}

uint32_t lobe_thread_lines(lobe_session* session, uint32_t capacity, float* ends, float* tensions) {
  std::uint32_t count = 0;
  guarded([&] {
    require(session, "session");
    for (const lobe::LinesSnapshot& line : session->lines()) {
      if (line.term != lobe::Threads<float>::term_name) continue;
      for (std::size_t i = 0; i < line.tensions.size(); ++i, ++count) {
        if (count >= capacity) continue;
        for (int k = 0; ends != nullptr && k < 2; ++k)
          Eigen::Map<Eigen::Vector3f>(ends + 6 * std::size_t(count) + 3 * k) =
              session->axes.point_out(line.ends.col(Eigen::Index(2 * i) + k).cast<double>()).cast<float>();
        if (tensions != nullptr) tensions[count] = line.tensions[i];
      }
    }
    return LOBE_OK;
  });
  return count;
}

// ---- Haptics

namespace {

lobe::DeviceLimits limits_of(const lobe_haptic_device* device) {
  lobe::DeviceLimits limits;
  if (device == nullptr) return limits;
  const lobe_haptic_device asked = of_caller(device, "lobe_haptic_device");
  const auto take = [](double given, double& limit) {
    if (given != 0) limit = given;
  };
  take(asked.force, limits.force);
  take(asked.torque, limits.torque);
  take(asked.slew, limits.slew);
  take(asked.stiffness, limits.stiffness);
  take(asked.damping, limits.damping);
  return limits;
}

lobe_status no_device(std::uint32_t tool) {
  return fail(LOBE_WRONG_STATE, "tool " + std::to_string(tool) + " has no device");
}

}  // namespace

lobe_status lobe_haptic_attach(lobe_session* session, uint32_t tool, const lobe_haptic_device* device) {
  return guarded([&] {
    require(session, "session");
    const std::lock_guard lock(session->driving);
    if (session->haptic_tools.has(tool))
      return fail(LOBE_WRONG_STATE, "tool " + std::to_string(tool) + " has a device");
    auto made = std::make_unique<lobe::c::HapticTool>(tool, limits_of(device));
    made->hand = session->lead_by(*made);
    session->haptic_tools.add(std::move(made));
    return LOBE_OK;
  });
}

lobe_status lobe_haptic_detach(lobe_session* session, uint32_t tool) {
  return guarded([&] {
    require(session, "session");
    const std::lock_guard lock(session->driving);
    return session->haptic_tools.remove(tool) ? LOBE_OK : no_device(tool);
  });
}

lobe_status lobe_haptic_force(lobe_session* session, uint32_t tool, const double x[3], const double v[3],
                              double f[3]) {
  return guarded([&] {
    require(session, "session");
    require(f, "f");
    const lobe::c::Axes& axes = session->axes;
    lobe::DeviceState state;
    if (x != nullptr) state.position = axes.point_in(Eigen::Map<const Vec3d>(x));
    if (v != nullptr)
      state.velocity = axes.point_in(Eigen::Map<const Vec3d>(v)) - axes.point_in(Vec3d::Zero());
    Eigen::Map<Vec3d> out(f);
    const bool is_led = session->haptic_tools.use(tool, [&](lobe::c::HapticTool& led) {
      out = axes.direction_out(led.device.force(x == nullptr ? nullptr : &state).force);
    });
    if (!is_led) return no_device(tool);
    if (x != nullptr && !state.is_finite())
      return fail(LOBE_BAD_INPUT, "x or v is not finite: the force fades");
    return LOBE_OK;
  });
}

lobe_status lobe_surface_acquire(lobe_session* session, lobe_surface* surface) {
  return guarded([&] {
    require(session, "session");
    require(surface, "surface");
    lobe_surface result = of_caller(surface, "lobe_surface");
    if (surface->size < sizeof(lobe_surface)) throw InputError("lobe_surface.size", "is of an older version");
    if (!session->fill(result)) return fail(LOBE_NOT_YET, "no frame was simulated yet");
    give(result, surface);
    return LOBE_OK;
  });
}

const uint8_t* lobe_surface_bodies(const lobe_surface* surface) {
  if (surface == nullptr || surface->owner == nullptr) return nullptr;
  return static_cast<const lobe_session::Buffers*>(surface->owner)->body.data();
}

uint32_t lobe_body_count(lobe_session* session) {
  return session == nullptr ? 0 : std::max(1u, std::uint32_t(session->bodies.size()));
}

const char* lobe_body_name(lobe_session* session, uint32_t body) {
  return session == nullptr || body >= session->bodies.size() ? "" : session->bodies[body].c_str();
}

void lobe_surface_release(lobe_session* session, lobe_surface* surface) {
  guarded([&] {
    if (session == nullptr || surface == nullptr || surface->owner == nullptr) return LOBE_OK;
    session->give_back(
        std::unique_ptr<lobe_session::Buffers>(static_cast<lobe_session::Buffers*>(surface->owner)));
    surface->owner = nullptr;
    surface->position = surface->normal = nullptr;
    surface->index = nullptr;
    surface->region = surface->cut = nullptr;
    return LOBE_OK;
  });
}

namespace {

// Does something with a file between two frames.
lobe_status with_file(lobe_session* session, const char* file,
                      void (lobe_session::*work)(const std::string&)) {
  return guarded([&] {
    require(session, "session");
    require(file, "file");
    const std::lock_guard lock(session->driving);
    (session->*work)(file);
    return LOBE_OK;
  });
}

}  // namespace

lobe_status lobe_save_scene(lobe_session* session, const char* file) {
  return with_file(session, file, &lobe_session::save_scene);
}
lobe_status lobe_save_recording(lobe_session* session, const char* file) {
  return with_file(session, file, &lobe_session::save_recording);
}
lobe_status lobe_save(lobe_session* session, const char* file) {
  return with_file(session, file, &lobe_session::save);
}
lobe_status lobe_restore(lobe_session* session, const char* file) {
  return with_file(session, file, &lobe_session::restore);
}

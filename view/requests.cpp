// How the viewer answers requests.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/live/session_scene.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/write_scene.h"
#include "viewer.h"

namespace lobe::view {
namespace {

using Kind = HandCommand::Kind;

std::optional<RegionModel> model_of(const std::string& word) {
  for (std::size_t i = 0; i < region_model_names.size(); ++i)
    if (word == region_model_names[i]) return RegionModel(i);
  return std::nullopt;
}

std::string names_of_models() {
  std::string names;
  for (const char* name : region_model_names) names += std::string(name) + ", ";
  return names;
}

void check_radius(double radius) {
  constexpr double largest = 1;  // [m]
  if (!(radius > 0) || radius > largest) throw InputError("/radius", "must be above 0 and at most 1 m");
}

}  // namespace

void Viewer::perform(ClientId client, const request::Seen&) {
  if (server_) server_->acknowledged(client);
}

// ---- Hands

void Viewer::perform(ClientId, const request::Take& what) {
  check_radius(what.radius);
  send({.kind = Kind::take_at_ray,
        .hand = static_cast<HandNumber>(what.hand),
        .position = what.from,
        .direction = what.along,
        .radius = what.radius});
}

void Viewer::perform(ClientId, const request::Bring& what) {
  send(bring_tool(static_cast<HandNumber>(what.hand), what.tool.position, what.tool.command));
}

void Viewer::perform(ClientId, const request::TurnOn& what) {
  send({.kind = Kind::turn_on, .on = what.on, .hand = static_cast<HandNumber>(what.hand)});
}

void Viewer::perform(ClientId, const request::Lead& what) {
  send({.kind = Kind::lead, .hand = static_cast<HandNumber>(what.hand), .position = what.to});
}

void Viewer::perform(ClientId, const request::LetGo& what) {
  send({.kind = Kind::let_go, .hand = static_cast<HandNumber>(what.hand)});
}

// ---- Thread

void Viewer::perform(ClientId, const request::TakeThread& what) {
  const ThreadMaterial material{what.stiffness, what.friction, what.strength, what.holds};
  sew([&](SewingHand& hand) { return hand.bring(what.thread.value, material); });
}

void Viewer::perform(ClientId, const request::Stitch& what) {
  sew([&](SewingHand& hand) {
    return hand.bite_below(what.thread.value, what.from, what.along, what.depth);
  });
}

void Viewer::perform(ClientId, const request::PullThread& what) {
  sew([&](SewingHand& hand) { return hand.pull(what.thread.value, what.to); });
}

void Viewer::perform(ClientId, const request::DropThread& what) {
  sew([&](SewingHand& hand) { return hand.let_go(what.thread.value); });
}

void Viewer::perform(ClientId, const request::TieThread& what) {
  sew([&](SewingHand& hand) {
    return hand.tie(what.thread.value, what.first.value, what.last.value, what.tighten);
  });
}

void Viewer::perform(ClientId, const request::CutThreadNear& what) {
  sew([&](SewingHand& hand) { return hand.cut_near(what.from, what.along, what.within); });
}

// ---- Time

void Viewer::perform(ClientId, const request::Pause& what) { send({.kind = Kind::run, .on = !what.on}); }
void Viewer::perform(ClientId, const request::Step&) { send({.kind = Kind::step}); }
void Viewer::perform(ClientId, const request::Speed& what) {
  send({.kind = Kind::speed, .value = what.factor});
}
void Viewer::perform(ClientId, const request::Restart&) { send({.kind = Kind::restart}); }
void Viewer::perform(ClientId, const request::Back& what) {
  send({.kind = Kind::back, .value = what.seconds});
}

// ---- Pages

void Viewer::perform(ClientId client, const request::Show& what) {
  static constexpr std::array known = {"none", "von_mises", "volume_ratio", "linear_error"};
  if (std::find(known.begin(), known.end(), what.what) == known.end())
    throw InputError("/what", "must be none, von_mises, volume_ratio or linear_error");
  clients_[client].scalar = what.what;
  measure_what_is_shown();
}

void Viewer::perform(ClientId client, const request::Skin& what) {
  if (!live_->has_skin()) throw InputError("/on", "the scene has no skin");
  clients_[client].wants_skin = what.on;
  clients_[client].told.skin = 0;
  show_skins();
  changed();
}

void Viewer::perform(ClientId client, const request::Control&) {
  control_.ask(client, Clock::now());
  control_changed();
}

void Viewer::perform(ClientId, const request::HandOver&) {
  control_.grant();
  control_changed();
}

void Viewer::perform(ClientId, const request::Keep&) {
  for (const ClientId page : control_.refuse(Clock::now()))
    tell(page, "note", "The page that holds the instruments keeps them.");
  control_changed();
}

// Throws InputError for an invalid name, or one of files that another program has made.
void Viewer::claim(const std::string& name) {
  check_file_name(name);
  if (saved_.contains(name)) return;
  for (const char* extension : {".json", ".vtu", "_1.vtu"}) {  // the last: of the first of several bodies
    const std::filesystem::path file = options_.folder / (name + extension);
    std::error_code error;
    const auto type = std::filesystem::symlink_status(file, error).type();
    if (type == std::filesystem::file_type::none) throw InputError(file.string(), error.message());
    if (type != std::filesystem::file_type::not_found)
      throw InputError(file.string(), "is there already: choose another name");
  }
}

// Saves the motions of its grasps as gestures of automatic regions; none if they do not move.
std::optional<std::filesystem::path> Viewer::save_gestures(const std::string& name, const Scene& played) {
  const double tolerance = played.auto_regions ? played.auto_regions->tolerance : AutoRegions{}.tolerance;
  const Scene scene = with_gestures(played, tolerance);
  if (scene.auto_regions->gestures.empty()) return {};
  const std::string file = name + "_gestures";
  io::write_file(options_.folder / (file + ".json"), to_json(scene));
  saved_.insert(file);
  return options_.folder / (file + ".json");
}

void Viewer::perform(ClientId, const request::Export& what) {
  claim(what.to);
  claim(what.to + "_gestures");
  Scene scene = to_be_saved(live_->hands_scene(), options_.folder, what.to);
  if (saves_mesh_) save_scene_mesh(resolved_.setup.mesh, options_.folder, what.to, scene);
  const std::filesystem::path file = options_.folder / (what.to + ".json");
  io::write_file(file, to_json(scene));
  saved_.insert(what.to);
  know_saved_files_of(scene);
  std::string note = "What the hands did is saved. To play it: lobe run " + file.string() + " -o out";
  if (const auto gestures = save_gestures(what.to, scene))
    note += ". With regions that are chosen for it: lobe run " + gestures->string() + " -o out";
  tell_all("note", note);
}

// ---- Painting

Painting& Viewer::painting() {
  if (!painting_) painting_.emplace(scene_, resolved_);
  return *painting_;
}

void Viewer::perform(ClientId, const request::Edit& what) { set_painting(what.on); }

// The simulation is paused while a user paints.
void Viewer::set_painting(bool on) {
  if (on == paints_) return;
  if (on) painting();
  paints_ = on;
  send({.kind = Kind::run, .on = !on});
  changed();
}

void Viewer::perform(ClientId, const request::Paint& what) {
  check_radius(what.radius);
  if (const std::optional<RegionModel> model = model_of(what.as))
    painting().paint(what.at, what.radius, *model);
  else if (what.as == "held" || what.as == "free")
    painting().hold(what.at, what.radius, what.as == "held");
  else
    throw InputError("/as", "must be " + names_of_models() + "held or free");
  repainted();
}

void Viewer::perform(ClientId, const request::PaintMaterial& what) {
  check_radius(what.radius);
  painting().paint_material(what.at, what.radius, what.material);
  repainted();
}

void Viewer::perform(ClientId, const request::NewMaterial& what) {
  painting().add_material(what.title, what.young);
  repainted();
}

void Viewer::perform(ClientId, const request::Mend& what) {
  const std::optional<RegionModel> model = model_of(what.as);
  if (what.as == "turning") {
    if (!painting().can_turn()) throw InputError("/as", "only one pre-computed part can turn by itself");
    painting().set_frame(RegionFrame::corotated);
  } else if (model && *model != RegionModel::precomputed) {
    std::vector<RegionModel> regions = painting().regions();
    for (const Index t : painting().unheld()) regions[std::size_t(t)] = *model;
    painting().use(regions);
  } else {
    throw InputError("/as", "must be turning, or a model that needs nothing held: not precomputed");
  }
  repainted();
}

void Viewer::perform(ClientId, const request::PaintAll& what) {
  const std::optional<RegionModel> model = model_of(what.as);
  if (!model) throw InputError("/as", "choose one of the models: only they can fill everything");
  painting().paint_all(*model);
  repainted();
}

void Viewer::perform(ClientId, const request::Stroke&) { painting().end_stroke(); }

void Viewer::perform(ClientId, const request::Undo&) {
  painting().undo();
  repainted();
}

// The gestures that hands have made so far, or, if there are none, those that the scene declares.
AutoRegions Viewer::wanted_gestures(double tolerance) {
  AutoRegions wanted = scene_.auto_regions.value_or(AutoRegions{});
  wanted.tolerance = tolerance;
  try {
    const Scene kept = with_gestures(live_->hands_scene(), tolerance);
    if (kept.auto_regions && !kept.auto_regions->gestures.empty())
      wanted.gestures = kept.auto_regions->gestures;
  } catch (const InputError&) {  // no scene can describe the session
  }
  return wanted;
}

void Viewer::perform(ClientId, const request::Propose& what) {
  Scene scene = painting().scene("proposed.vtu");
  AutoRegions wanted = wanted_gestures(what.tolerance);
  wanted.correct = false;
  scene.regions.clear();
  scene.auto_regions = wanted;
  begin([scene, mesh = painting().mesh()](Task& task) {
    task.resolved = resolve(scene, mesh, {true, [&](double fraction) { task.fraction = fraction; }});
  });
}

void Viewer::perform(ClientId, const request::Apply&) {
  begin([scene = painting().scene("painted.vtu"), mesh = painting().mesh(),
         options = live_options()](Task& task) {
    task.scene = scene;
    task.resolved = resolve(scene, mesh);
    LiveOptions live = options;
    live.running = true;
    live.condensing = [&](double fraction) { task.fraction = fraction; };
    task.live = start_live(scene, task.resolved, live);
  });
}

void Viewer::perform(ClientId, const request::Save& what) {
  claim(what.to);
  const auto keep_files = [&](Scene scene) {
    return to_be_saved(std::move(scene), options_.folder, what.to);
  };
  const std::filesystem::path file = painting().save(options_.folder, what.to, keep_files);
  saved_.insert(what.to);
  know_saved_files_of(read_scene(file));
  tell_all("note", "Saved. To play it: lobe view " + file.string());
}

}  // namespace lobe::view

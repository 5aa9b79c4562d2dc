#include "viewer.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <utility>
#include <variant>

#include "lobe/error.h"

namespace lobe::view {

using Json = nlohmann::json;

Viewer::Viewer(Scene scene, Resolved resolved, const ViewerOptions& options)
    : options_(options),
      scene_(std::move(scene)),
      resolved_(std::move(resolved)),
      live_(start_live(scene_, resolved_, live_options())),
      control_(options.patience),
      recordings_(options.record),
      run_(std::random_device()()) {
  if (options.haptic.device != "none") live_->take_haptics(std::make_unique<HapticRig>(options.haptic));
  if (resolved_.proposal) proposal_ = resolved_.proposal;
  chosen_ = note_choices(origin_, scene_, resolved_);
  know_files_of(scene_);
}

Viewer::~Viewer() = default;

void Viewer::set_server(Server* server) {
  const std::lock_guard lock(waking_);
  server_ = server;
}

void Viewer::wake() const {
  const std::lock_guard lock(waking_);
  if (server_) server_->wake();
}

LiveOptions Viewer::live_options() const {
  LiveOptions options = options_.live;
  options.published = [this] { wake(); };
  return options;
}

std::uint64_t Viewer::news() const {
  const std::lock_guard lock(changing_);
  const std::uint64_t task = task_ ? std::uint64_t(100 * task_->fraction) + task_->is_done : 0;
  const std::uint64_t is_due = Clock::now() >= deadline_.load();
  return live_->news() ^ (version_ << 20) ^ (task << 50) ^ (is_due << 49);
}

// ---- Who controls

void Viewer::opened(ClientId client) {
  clients_[client] = {};
  control_.opened(client);
  control_changed();
  if (!std::exchange(has_begun_, true)) send({.kind = HandCommand::Kind::run, .on = true});
}

void Viewer::closed(ClientId client) try {
  clients_.erase(client);
  control_.closed(client);
  measure_what_is_shown();
  control_changed();
} catch (const std::exception& error) {
  tell_all("error", error.what());
}

// The hands of the page that held the instruments let go.
void Viewer::control_changed() {
  deadline_ = control_.deadline();
  changed();
  if (controlling_ == control_.holder()) return;
  controlling_ = control_.holder();
  live_->change_hands(controlling_ != 0);
  measure_what_is_shown();
}

void Viewer::settle_control() {
  if (Clock::now() < control_.deadline()) return;
  control_.settle(live_->hands_hold(), Clock::now());
  if (controlling_ != control_.holder()) control_changed();
}

void Viewer::tell(ClientId client, const char* event, const std::string& text) {
  if (server_)
    server_->send(
        client, Json{{"event", event}, {"text", text}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void Viewer::tell_all(const char* event, const std::string& text) {
  for (const auto& [client, state] : clients_) tell(client, event, text);
}

// ---- Requests

bool Viewer::needs_control(const request::Any& what) const {
  return !std::holds_alternative<request::Seen>(what) && !std::holds_alternative<request::Show>(what) &&
         !std::holds_alternative<request::Skin>(what) && !std::holds_alternative<request::Control>(what);
}

// Whatever goes wrong with a request ends nothing but that.
void Viewer::received(ClientId client, std::string_view text) {
  try {
    carry_out(client, text);
  } catch (const std::exception& error) {
    tell(client, "error", error.what());
  }
}

void Viewer::carry_out(ClientId client, std::string_view text) {
  const Request request = parse_request(text);
  if (needs_control(request.what)) {
    if (client != controlling_)
      throw InputError("/do", controlling_ == 0 ? "nobody holds the instruments: take them first"
                                                : "another page holds the instruments: ask for them first");
    control_.acted(Clock::now());
    deadline_ = control_.deadline();
  }
  clients_[client].number = number_ = request.number;
  std::visit([&](const auto& what) { perform(client, what); }, request.what);
}

namespace {

[[noreturn]] void refuse_full_queue() {
  throw InputError("/do", "the simulation takes no commands at present: try again");
}

}  // namespace

std::uint64_t Viewer::sequence() const { return static_cast<std::uint64_t>(std::max(0.0, number_)); }

void Viewer::send(const HandCommand& command) {
  HandCommand numbered = command;
  numbered.sequence = sequence();
  if (!live_->send(numbered)) refuse_full_queue();
}

void Viewer::sew(const std::function<bool(SewingHand& hand)>& work) {
  SewingHand* hand = live_->sewing_hand(sequence());
  if (hand && !work(*hand)) refuse_full_queue();
}

// Measures what the client in control wants to see. Others see it if they want the same.
void Viewer::measure_what_is_shown() {
  std::string wanted = "none";
  for (const auto& [client, state] : clients_)
    if (state.scalar != "none" && (wanted == "none" || client == controlling_)) wanted = state.scalar;
  live_->measure(wanted);
}

// What is being opened is read by another thread, and stays as it was checked.
void Viewer::received_file(const std::string& name, std::string_view content) {
  if (is_preparing())
    throw InputError(name, "cannot be taken while something is being prepared: send it then");
  inbox_.take(name, content);
}

bool Viewer::abandon() {
  if (task_) task_->child.stop();
  inbox_.clear();
  const auto is_done = [](const auto& task) { return task->is_done.load(); };
  return !is_preparing() && std::all_of(abandoned_.begin(), abandoned_.end(), is_done);
}

// The scene of a session, as its recording is to be played when this program has ended. That of the first is
// the file that the program was given.
Scene Viewer::recorded() const {
  if (options_.record.empty() || sessions_ == 1) return scene_;
  return to_be_saved(scene_, std::filesystem::absolute(options_.record).parent_path(),
                     options_.record.stem().string() + "." + std::to_string(sessions_));
}

void Viewer::show_skins() {
  live_->want_skin(std::any_of(clients_.begin(), clients_.end(),
                               [](const auto& client) { return client.second.wants_skin; }));
}

// ---- Work of other threads

void Viewer::begin(const std::function<void(Task&)>& work, const std::string& title) {
  if (is_preparing()) throw InputError("/do", "something else is being prepared: wait for it");
  const auto begun = std::make_shared<Task>();
  begun->title = title;
  {
    const std::lock_guard lock(changing_);
    task_ = begun;
  }
  try {
    std::thread([task = begun, work] {
      try {
        work(*task);
      } catch (const std::exception& error) {
        task->trouble = error.what();
      }
      task->is_done = true;
    }).detach();
  } catch (...) {  // there can be no more threads
    const std::lock_guard lock(changing_);
    task_.reset();
    throw;
  }
}

void Viewer::finish_task() {
  std::erase_if(abandoned_, [](const auto& task) { return task->is_done.load(); });
  if (!task_ || !task_->is_done) return;
  std::shared_ptr<Task> task;
  {
    const std::lock_guard lock(changing_);
    task = std::move(task_);
  }
  changed();
  if (!task->trouble.empty()) return tell_all("error", task->trouble);
  for (const std::string& warning : task->resolved.warnings) tell_all("note", warning);
  if (!task->measured.is_null()) {
    measured_ = task->measured;
    ++choices_;
    return;
  }
  if (!task->errors.is_null()) {
    errors_ = task->errors;
    ++choices_;
    return;
  }
  if (!task->live) {
    proposal_ = task->resolved.proposal;
    if (proposal_) painting().use(proposal_->region_of);
    repainted();
    return;
  }
  take_over(*task);
}

// Goes on with the simulation of what was painted. The former one gives its device to it.
void Viewer::take_over(Task& task) {
  const std::shared_ptr<Live> former = live_;
  std::unique_ptr<HapticRig> rig = former->release_haptics();
  former->change_hands(false);
  try {
    recordings_.ended(former, recorded(), resolved_.setup.mesh);
  } catch (const std::exception& error) {
    tell_all("error", std::string("what was done so far is not recorded yet: ") + error.what());
  }
  {
    const std::lock_guard lock(changing_);
    live_ = task.live;
  }
  scene_ = std::move(task.scene);
  resolved_ = std::move(task.resolved);
  paints_ = false;
  saves_mesh_ = true;
  is_painted_ = !task.origin;
  errors_ = nullptr;
  ++choices_;
  ++sessions_;
  if (task.origin) {
    origin_ = *task.origin;
    chosen_ = note_choices(origin_, scene_, resolved_);
    know_files_of(scene_);
    painting_.reset();
    proposal_ = resolved_.proposal;
    ++opened_;
  }
  live_->take_haptics(std::move(rig));
  live_->change_hands(controlling_ != 0);
  measure_what_is_shown();
  show_skins();
}

const std::vector<Recordings::Written>& Viewer::write_recordings() {
  recordings_.end(live_, recorded(), resolved_.setup.mesh);
  return recordings_.written();
}

// ---- Frames

// A frame that cannot be made is said once, not for each picture.
std::string Viewer::next_frame(ClientId id) {
  Client& client = clients_[id];
  try {
    std::string frame = newest_frame(id);
    if (!frame.empty()) client.trouble.clear();
    return frame;
  } catch (const std::exception& error) {
    if (std::exchange(client.trouble, error.what()) != error.what()) tell(id, "error", error.what());
  }
  return {};
}

std::string Viewer::newest_frame(ClientId id) {
  finish_task();
  settle_control();
  for (const std::string& trouble : live_->take_troubles()) tell_all("error", trouble);
  Client& client = clients_[id];
  const std::uint64_t latest = news() ^ (painted_ << 40) ^ (paints_ ? 1 : 0);
  if (client.told.news == latest) return {};
  client.told.news = latest;
  BlockWriter out;
  write_choices(client, out);
  paints_ ? write_painting_frame(id, out) : write_live_frame(id, out);
  return out.take();
}

void Viewer::write_live_frame(ClientId id, BlockWriter& out) {
  Client& client = clients_[id];
  Json status;
  live_->write(client.scalar, client.told, out, status);
  status["has_skin"] = live_->has_skin();
  if (client.wants_skin) live_->write_skin(client.told, out);
  status["mode"] = "live";
  add_session(status, id);
  write_json(status_tag, status.dump(-1, ' ', false, Json::error_handler_t::replace), out);
}

void Viewer::add_session(Json& status, ClientId id) const {
  const bool controls = id == controlling_;
  if (!status.contains("seen") || !controls) status["seen"] = controls ? clients_.at(id).number : 0;
  status["scene"] = scene_.name;
  status["run"] = run_;
  status["controls"] = controls;
  status["controlled"] = controlling_ != 0;
  status["asks"] = control_.has_asked(id);
  status["askers"] = control_.askers().size();
  status["clients"] = clients_.size();
  if (task_ && !task_->title.empty()) status["opening"] = {{"title", task_->title}};
}

void Viewer::write_painting_frame(ClientId id, BlockWriter& out) {
  Client& client = clients_[id];
  if (client.painted != painted_ || client.told.topology != 0) {
    write_painting(out);
    client.painted = painted_;
    client.told.topology = 0;
  }
  Json status{{"mode", "edit"},
              {"edit", painting_status()},
              {"time", 0},
              {"running", false},
              {"speed", 1},
              {"can_go_back", 0.0},
              {"factor", 0},
              {"tets", resolved_.setup.mesh.tet_count()},
              {"stands_still", false}};
  if (resolved_.setup.mesh.bodies.any()) status["bodies"] = resolved_.setup.mesh.bodies.names;
  write_json(tools_tag, "[]", out);
  add_session(status, id);
  write_json(status_tag, status.dump(-1, ' ', false, Json::error_handler_t::replace), out);
}

void Viewer::write_painting(BlockWriter& out) const {
  const SurfaceMesh& surface = painting_->surface();
  write_topology(surface, painting_->rest(), out);
  write_fibres(surface, painting_->rest(), resolved_.setup.mesh.fibres, out);
  write_bodies(surface, resolved_.setup.mesh.bodies, out);
  write_positions(surface, painting_->rest(), out);
  std::vector<std::uint8_t> held, materials;
  for (const Index v : surface.mesh_vertex) held.push_back(painting_->held()[std::size_t(v)]);
  for (const auto& owner : surface.owner)
    materials.push_back(static_cast<std::uint8_t>(painting_->material_of()[std::size_t(owner.tet)]));
  out.begin(paint_tag);
  out.put(std::span<const std::uint8_t>(held));
  out.end();
  out.begin(materials_tag);
  out.put(std::span<const std::uint8_t>(materials));
  out.end();
}

Json Viewer::painting_status() const {
  const auto& held = painting_->held();
  const std::vector<double> shares = painting_->material_shares();
  Json materials = Json::array();
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const Material& material = painting_->materials()[i];
    materials.push_back({{"name", material.name}, {"young", young_of(material)}, {"share", shares[i]}});
  }
  Json edit{{"shares", painting_->shares()},
            {"held", std::count(held.begin(), held.end(), 1)},
            {"materials", materials},
            {"can_undo", painting_->can_undo()},
            {"busy", is_preparing() ? Json(task_->fraction.load()) : Json()},
            {"proposal", nullptr}};
  if (const std::vector<Index> unheld = painting_->unheld(); !unheld.empty())
    edit["unheld"] = {{"share", painting_->share_of(unheld)}, {"can_turn", painting_->can_turn()}};
  if (!proposal_) return edit;
  Json gestures = Json::array();
  for (const GestureOutcome& gesture : proposal_->gestures)
    gestures.push_back(
        {{"name", gesture.name}, {"error", gesture.measured}, {"predicted", gesture.predicted}});
  edit["proposal"] = {{"speedup", proposal_->measured_speedup},
                      {"predicted_speedup", proposal_->predicted_speedup},
                      {"linear", proposal_->linear_share},
                      {"gestures", gestures},
                      {"notes", proposal_->notes}};
  return edit;
}

}  // namespace lobe::view

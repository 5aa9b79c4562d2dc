// How the viewer answers requests for other organs.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/scene/read_scene.h"
#include "lobe/scene/scene_mesh.h"
#include "lobe/scene/tissues.h"
#include "lobe/scene/write_scene.h"
#include "viewer.h"

namespace lobe::view {

using Json = nlohmann::json;

// What is simulated goes on until the other scene is ready, and for good if that fails.
void Viewer::open(const std::string& title, const Origin& origin, const MakeFile& make_file) {
  begin(
      [origin, make_file, options = live_options()](Task& task) {
        const auto progress = [&](double fraction) { task.fraction = fraction; };
        std::tie(task.scene, task.resolved) = load_scene(make_file(task.child), progress);
        LiveOptions live = options;
        live.running = true;
        live.condensing = progress;
        task.live = start_live(task.scene, task.resolved, live);
        task.origin = origin;
        for (std::string& warning : warnings_of_mesher(task.child.said()))
          task.origin->warnings.push_back(std::move(warning));
      },
      title);
  changed();
}

void Viewer::make_and_open(Origin origin, const Choices& choices) {
  origin.warnings.clear();  // they are those of a mesh
  std::string names;
  for (const std::filesystem::path& file : origin.files)
    names += (names.empty() ? "" : ", ") + file.filename().string();
  open("Opening " + names, origin, [origin, choices, folder = inbox_.make_folder()](Child& child) {
    return make_scene_file(origin, choices, folder, child);
  });
}

namespace {

// As the scene names them.
std::vector<std::filesystem::path> files_of(Scene scene) {
  std::vector<std::filesystem::path> files{scene.mesh, scene.skin};
  for (const SceneBody& body : scene.bodies) files.push_back(body.mesh);
  for (Tool& tool : scene.tools)
    if (const std::filesystem::path* file = tool.shape_file()) files.push_back(*file);
  files.insert(files.end(), scene.obstacle_files.begin(), scene.obstacle_files.end());
  std::erase_if(files, [](const std::filesystem::path& file) { return file.empty(); });
  return files;
}

}  // namespace

// What this program has read, a page may name, too.
void Viewer::know_files_of(const Scene& scene) {
  const auto folder = std::filesystem::absolute(scene.file).parent_path();
  for (const std::filesystem::path& file : files_of(scene))
    if (!inbox_.has(folder / file)) known_.insert((folder / file).lexically_normal());
}

// What was saved beside a scene, its name is enough for.
void Viewer::know_saved_files_of(const Scene& scene) {
  for (const std::filesystem::path& file : files_of(scene))
    if (!file.has_parent_path())
      written_.insert((std::filesystem::absolute(options_.folder) / file).lexically_normal());
}

// By its path; or by its name alone, as scenes that were saved have their own files.
std::filesystem::path Viewer::known_file(const std::filesystem::path& named) const {
  const auto file = (std::filesystem::absolute(options_.folder) / named).lexically_normal();
  const auto in_library = file.lexically_relative(options_.library);
  const bool is_shipped = !options_.library.empty() && !in_library.empty() && *in_library.begin() != "..",
             is_known =
                 written_.contains(file) || (named.is_absolute() && (is_shipped || known_.contains(file)));
  std::error_code error;
  return is_known && std::filesystem::exists(file, error) ? file : std::filesystem::path();
}

void Viewer::open_sent_scene(ClientId client, const std::string& name, const std::vector<std::string>& sent) {
  const std::filesystem::path file = inbox_.path_of(name);
  const std::vector<std::string> missing = find_files_of_scene(
      file, sent, [this](const std::filesystem::path& named) { return known_file(named); });
  if (missing.empty()) return open("Opening " + name, {}, [file](Child&) { return file; });
  std::string names;
  for (const std::string& one : missing) names += (names.empty() ? "" : ", ") + one;
  const Json event{{"event", "needs"},
                   {"text", name + " names files that were not sent with it: " + names},
                   {"files", missing}};
  if (server_) server_->send(client, event.dump(-1, ' ', false, Json::error_handler_t::replace));
}

// A scene is taken as it is; anything else becomes one.
void Viewer::perform(ClientId client, const request::Open& what) {
  for (const std::string& name : what.files)
    if (inbox_.path_of(name).extension() == ".json") return open_sent_scene(client, name, what.files);
  Origin origin{surfaces_among(what.files), what.scale, what.edge};
  make_and_open(origin, {what.tissue, what.hold, what.edge, what.scale, what.springs});
}

std::vector<std::filesystem::path> Viewer::surfaces_among(const std::vector<std::string>& names) const {
  if (names.empty()) throw InputError("/files", "names no file");
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names)
    if (const auto file = inbox_.path_of(name); file.extension() != ".ele")  // which is read with its .node
      files.push_back(file);
  if (files.empty()) throw InputError("/files", "the .node file is missing");
  return files;
}

// A file that is no surface and no image has no size: it is opened without one.
void Viewer::perform(ClientId, const request::Measure& what) {
  const std::vector<std::filesystem::path> files = surfaces_among(what.files);
  begin(
      [files, names = what.files, folder = inbox_.make_folder()](Task& task) {
        task.measured = {{"files", names}, {"body", nullptr}};
        try {
          task.measured["body"] = size_of_files(files, folder, task.child);
        } catch (const InputError& error) {
          task.measured["trouble"] = error.what();
        }
      },
      "Looking at " + files.front().filename().string());
  changed();
}

void Viewer::perform(ClientId, const request::OpenShipped& what) {
  const auto found = std::find_if(library_.begin(), library_.end(),
                                  [&](const Shipped& shipped) { return shipped.name == what.what; });
  if (found == library_.end()) throw InputError("/what", "\"" + what.what + "\" does not come with lobe");
  const std::filesystem::path file = options_.library / found->name;
  if (file.extension() != ".json") return make_and_open({{file}}, {});
  open("Opening " + found->title, {}, [file](Child&) { return file; });
}

// Where neither edge nor scale change, the mesh is taken that the scene was made with. The mesh of several
// surfaces does not know their names, so that it is made again.
void Viewer::perform(ClientId, const request::Remake& what) {
  if (origin_.files.empty())
    throw InputError("/do", "the scene was not made from a file: there is nothing to choose");
  Origin origin = origin_;
  const bool keeps_mesh = what.edge == 0 && what.scale == 0;
  if (!keeps_mesh || origin.files.size() > 1) {
    if (what.edge > 0 && has_own_mesh(origin))
      throw InputError("/edge", "the file has tetrahedra of its own, whose edges stay as they are");
    const Choices choices =
        carried_over(origin, {what.tissue, what.hold, what.edge, what.scale, what.springs, what.pins});
    return make_and_open(origin, choices);
  }
  const Choices choices{what.tissue, what.hold, 0, origin.mesh_scale, what.springs, what.pins};
  open("Opening " + origin.files.front().filename().string(), origin,
       [mesh = origin.mesh, choices, folder = inbox_.make_folder()](Child& child) {
         return make_scene_file({{mesh}}, choices, folder, child);
       });
}

// Of the scene as it is at rest; what is simulated goes on.
void Viewer::perform(ClientId, const request::Judge&) {
  if (is_preparing()) throw InputError("/do", "something else is being prepared: wait for it");
  const std::filesystem::path folder = inbox_.make_folder(), file = folder / "judged.json";
  Scene scene = with_absolute_paths(scene_);
  scene.skin.clear();
  save_scene_mesh(resolved_.setup.mesh, folder, "judged", scene);
  io::write_file(file, to_json(scene));
  begin([file, folder](Task& task) { task.errors = total_errors_of(file, folder, task.child); },
        "Measuring the error");
  changed();
}

// Its thread may go on for a while; what it makes is thrown away.
void Viewer::perform(ClientId, const request::Cancel&) {
  if (!task_ || task_->title.empty()) throw InputError("/do", "nothing is being opened or measured");
  task_->child.stop();
  tell_all("note", task_->title + " was cancelled.");
  const std::lock_guard lock(changing_);
  abandoned_.push_back(std::exchange(task_, nullptr));
  changed();
}

Scene Viewer::to_be_saved(Scene scene, const std::filesystem::path& folder, const std::string& stem) const {
  scene = with_absolute_paths(std::move(scene));
  inbox_.keep(scene.skin, folder, stem);
  for (Tool& tool : scene.tools)
    if (std::filesystem::path* file = tool.shape_file()) inbox_.keep(*file, folder, stem);
  for (std::filesystem::path& file : scene.obstacle_files) inbox_.keep(file, folder, stem);
  return scene;
}

void Viewer::perform(ClientId, const request::SaveScene& what) {
  claim(what.to);
  Scene scene = to_be_saved(scene_, options_.folder, what.to);
  save_scene_mesh(resolved_.setup.mesh, options_.folder, what.to, scene);
  const std::filesystem::path file = options_.folder / (what.to + ".json");
  io::write_file(file, to_json(scene));
  saved_.insert(what.to);
  know_saved_files_of(scene);
  tell_all("note", "Saved. To play it: lobe view " + file.string());
}

// What a page may choose, and what was chosen: once, and again when another scene is open.
void Viewer::write_choices(Client& client, BlockWriter& out) {
  if (client.choices == choices_) return;
  client.choices = choices_;
  Json shipped = Json::array(), known = Json::array();
  for (const Shipped& one : library_) shipped.push_back({{"name", one.name}, {"title", one.title}});
  for (const Tissue& tissue : tissues())
    known.push_back({{"name", tissue.name}, {"young", tissue.young_modulus}, {"density", tissue.density}});
  const Json choices{{"opened", opened_},
                     {"chosen", chosen_},
                     {"is_painted", is_painted_},
                     {"errors", errors_},
                     {"measured", measured_},
                     {"pace", options_.pace},
                     {"shipped", shipped},
                     {"tissues", known},
                     {"extensions", readable_extensions()},
                     {"largest_file", Inbox::largest_file}};
  write_json(choices_tag, choices.dump(-1, ' ', false, Json::error_handler_t::replace), out);
}

}  // namespace lobe::view

// What `lobe view` serves to any number of pages, of which one is in control: a simulation or a painting.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "child.h"
#include "control.h"
#include "inbox.h"
#include "library.h"
#include "live.h"
#include "opening.h"
#include "painting.h"
#include "recordings.h"
#include "server.h"

namespace lobe::view {

struct ViewerOptions {
  LiveOptions live;
  HapticOptions haptic = {};
  std::filesystem::path folder = ".";         // folder where scenes are saved
  std::filesystem::path record = {};          // a file for what is done (recordings.h); empty: none
  std::chrono::milliseconds patience{10000};  // time for a page to answer who asks for the instruments
  bool saves_mesh = false;                    // beside each scene, since the file of the mesh will be gone
  Origin origin = {};                         // origin of the scene, if it was made
  double pace = 0;                            // as measured_pace() says [s]; 0: unknown
  std::filesystem::path library = library_folder();
};

class Viewer final : public Service {
 public:
  // `mesh` has passed prepare(), and `resolved` is of both.
  Viewer(Scene scene, Resolved resolved, const ViewerOptions& options);
  ~Viewer() override;

  // ---- The thread of the server

  // `server` is null when there is none any more.
  void set_server(Server* server);
  void opened(ClientId client) override;
  void closed(ClientId client) override;
  void received(ClientId client, std::string_view text) override;
  void received_file(const std::string& name, std::string_view content) override;
  std::string next_frame(ClientId client) override;

  // ---- Any thread

  // Changes when there may be something new for a client. Of a new picture the server is told at once.
  std::uint64_t news() const;

  // ---- After the server

  // Writes what the sessions have done, and returns the files. Throws InputError if one cannot be written;
  // the others then are.
  const std::vector<Recordings::Written>& write_recordings();
  bool is_preparing() const { return task_ && !task_->is_done; }
  // Ends what is being prepared, as far as that is another program, and removes what pages have sent. Returns
  // false if a thread goes on.
  bool abandon();

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    Told told;
    std::string scalar = "none";
    bool wants_skin = false;
    std::uint64_t painted = 0;
    double number = 0;    // number of its last request
    std::string trouble;  // reason why it got no frame
    int choices = -1;     // number of the choices that it knows
  };
  // A thread that prepares something: a simulation of what was painted, a proposal of regions, or another
  // scene.
  struct Task {
    std::atomic<double> fraction{0};
    std::atomic<bool> is_done{false};
    std::string trouble;  // fault; empty: it has ended without one
    std::shared_ptr<Live> live;
    Scene scene;
    Resolved resolved;
    std::string title;             // what is being opened or measured; empty: nothing is
    std::optional<Origin> origin;  // origin of the scene that is opened
    nlohmann::json errors;         // errors that were measured; null: none were
    nlohmann::json measured;       // size of the body in files; null: it was not asked for
    Child child;                   // process that makes it
  };

  bool needs_control(const request::Any& what) const;
  void control_changed();
  void settle_control();
  void carry_out(ClientId client, std::string_view text);
  void tell(ClientId client, const char* event, const std::string& text);
  void tell_all(const char* event, const std::string& text);
  void changed() { ++version_; }
  void repainted() {
    ++painted_;
    changed();
  }
  void set_painting(bool on);
  void finish_task();
  Scene recorded() const;
  void take_over(Task& task);
  void measure_what_is_shown();
  void show_skins();
  std::string newest_frame(ClientId id);
  void write_painting_frame(ClientId id, BlockWriter& out);
  void write_painting(BlockWriter& out) const;
  nlohmann::json painting_status() const;
  void write_live_frame(ClientId id, BlockWriter& out);
  void add_session(nlohmann::json& status, ClientId id) const;
  void send(const HandCommand& command);
  std::uint64_t sequence() const;  // of the request that is carried out, as HandCommand has it
  void sew(const std::function<bool(SewingHand& hand)>& work);
  void begin(const std::function<void(Task&)>& work, const std::string& title = {});
  using MakeFile = std::function<std::filesystem::path(Child& child)>;
  void open(const std::string& title, const Origin& origin, const MakeFile& make_file);
  void make_and_open(Origin origin, const Choices& choices);
  void open_sent_scene(ClientId client, const std::string& name, const std::vector<std::string>& sent);
  void know_files_of(const Scene& scene);
  void know_saved_files_of(const Scene& scene);
  std::filesystem::path known_file(const std::filesystem::path& named) const;
  std::vector<std::filesystem::path> surfaces_among(const std::vector<std::string>& names) const;
  void write_choices(Client& client, BlockWriter& out);
  // With absolute paths, and files that pages have sent beside it.
  Scene to_be_saved(Scene scene, const std::filesystem::path& folder, const std::string& stem) const;
  Painting& painting();
  AutoRegions wanted_gestures(double tolerance);
  void claim(const std::string& name);
  std::optional<std::filesystem::path> save_gestures(const std::string& name, const Scene& played);

  void perform(ClientId client, const request::Seen& what);
  void perform(ClientId client, const request::Take& what);
  void perform(ClientId client, const request::Bring& what);
  void perform(ClientId client, const request::TurnOn& what);
  void perform(ClientId client, const request::Lead& what);
  void perform(ClientId client, const request::LetGo& what);
  void perform(ClientId client, const request::TakeThread& what);
  void perform(ClientId client, const request::Stitch& what);
  void perform(ClientId client, const request::PullThread& what);
  void perform(ClientId client, const request::DropThread& what);
  void perform(ClientId client, const request::TieThread& what);
  void perform(ClientId client, const request::CutThreadNear& what);
  void perform(ClientId client, const request::Pause& what);
  void perform(ClientId client, const request::Step& what);
  void perform(ClientId client, const request::Speed& what);
  void perform(ClientId client, const request::Restart& what);
  void perform(ClientId client, const request::Back& what);
  void perform(ClientId client, const request::Show& what);
  void perform(ClientId client, const request::Skin& what);
  void perform(ClientId client, const request::Control& what);
  void perform(ClientId client, const request::HandOver& what);
  void perform(ClientId client, const request::Keep& what);
  void perform(ClientId client, const request::Export& what);
  void perform(ClientId client, const request::Edit& what);
  void perform(ClientId client, const request::Paint& what);
  void perform(ClientId client, const request::PaintMaterial& what);
  void perform(ClientId client, const request::NewMaterial& what);
  void perform(ClientId client, const request::Mend& what);
  void perform(ClientId client, const request::PaintAll& what);
  void perform(ClientId client, const request::Stroke& what);
  void perform(ClientId client, const request::Undo& what);
  void perform(ClientId client, const request::Propose& what);
  void perform(ClientId client, const request::Apply& what);
  void perform(ClientId client, const request::Save& what);
  void perform(ClientId client, const request::Open& what);
  void perform(ClientId client, const request::Measure& what);
  void perform(ClientId client, const request::OpenShipped& what);
  void perform(ClientId client, const request::Remake& what);
  void perform(ClientId client, const request::Judge& what);
  void perform(ClientId client, const request::Cancel& what);
  void perform(ClientId client, const request::SaveScene& what);

  void wake() const;
  LiveOptions live_options() const;

  const ViewerOptions options_;
  Scene scene_;
  Resolved resolved_;
  Server* server_ = nullptr;
  mutable std::mutex waking_;    // lock of server_, for wake()
  mutable std::mutex changing_;  // lock of live_ and task_, for news()
  std::shared_ptr<Live> live_;
  std::optional<Painting> painting_;
  bool paints_ = false;
  bool has_begun_ = false;  // the simulation: with the first page
  // The mesh is saved beside scenes: its file will be gone, or has not the labels that were painted.
  bool saves_mesh_ = options_.saves_mesh;
  Origin origin_ = options_.origin;
  const std::vector<Shipped> library_ = library(options_.library);
  Inbox inbox_;
  int sessions_ = 1;                              // number of sessions, as Recordings counts them
  int opened_ = 0;                                // scenes, since the first one
  nlohmann::json chosen_;                         // choices for the scene that is open (opening.h)
  nlohmann::json errors_;                         // errors of its mesh; null: not measured
  bool is_painted_ = false;                       // whether what is simulated was painted since
  int choices_ = 0;                               // grows when pages must hear of these
  std::vector<std::shared_ptr<Task>> abandoned_;  // tasks that were cancelled, whose threads may go on
  std::set<std::string> saved_;                   // names of files that this program has made
  std::set<std::filesystem::path> known_;         // files of scenes that were opened, by absolute paths
  std::set<std::filesystem::path> written_;       // those of scenes that were saved
  nlohmann::json measured_;                       // what was measured last; null: nothing
  double number_ = 0;                             // number of the request that is carried out
  std::uint64_t painted_ = 1;                     // grows with each change of the painting
  std::optional<Proposal> proposal_;
  std::shared_ptr<Task> task_;
  std::map<ClientId, Client> clients_;
  Control control_;
  ClientId controlling_ = 0;                                            // page whose hands the session has
  std::atomic<Clock::time_point> deadline_ = Clock::time_point::max();  // deadline of control_, for news()
  Recordings recordings_;
  const std::uint32_t run_;  // a number of this run of the program, which pages compare
  std::atomic<std::uint64_t> version_ = 1;
};

}  // namespace lobe::view

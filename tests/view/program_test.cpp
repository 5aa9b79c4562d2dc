// The program lobe-view: its browser, its files, and how it ends.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "socket_client.h"
#include "viewed.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// lobe-view, whose output is read.
class Program {
 public:
  Program(const std::vector<std::string>& arguments,
          const std::map<std::string, std::string>& variables = {}) {
    int ends[2];
    REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
    std::vector<std::string> words = {std::string(LOBE_BIN_DIR) + "/lobe-view"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    process_ = ::fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) {
      for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
      ::setpgid(0, 0);  // as a shell does
      ::dup2(ends[1], 1);
      ::dup2(ends[1], 2);
      ::execv(pointers[0], pointers.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    output_ = ends[0];
  }
  ~Program() {
    if (process_ > 0) end(SIGKILL);
    ::close(output_);
  }

  // The port of its page; 0 if it ended before it had one.
  int port() {
    std::smatch found;
    while (!std::regex_search(said_, found, std::regex(":(\\d+)/\\?token=[^\n]*\n")))
      if (!read()) return 0;
    return std::stoi(found[1]);
  }
  pid_t process() const { return process_; }
  // Its status, or 1000 and the signal that ended it.
  int end(int signal, bool whole_group = false) {
    ::kill(whole_group ? -process_ : process_, signal);
    return wait();
  }
  int wait() {
    int status = 0;
    ::waitpid(std::exchange(process_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  bool is_there() const { return ::waitpid(process_, nullptr, WNOHANG) == 0; }
  const std::string& said() {
    while (read()) {
    }
    return said_;
  }

 private:
  bool read() {
    char bytes[4096];
    const ssize_t size = ::read(output_, bytes, sizeof bytes);
    if (size > 0) said_.append(bytes, std::size_t(size));
    return size > 0;
  }

  pid_t process_ = 0;
  int output_ = -1;
  std::string said_;
};

// The scene of a small body in a folder of its own.
struct OnDisk {
  Folder folder;
  std::string scene;
  OnDisk() {
    write_vtu(folder.path / "block.vtu", box_mesh({0.06, 0.06, 0.06}, 3, 3, 3));
    scene = folder.write("block.json", block_scene).string();
  }
  std::string file(const std::string& name) const { return (folder.path / name).string(); }
};

const std::string token = "ttttttttttttttttttttttttt";

// A page of a program: the next frame's status, after a request.
class LivePage {
 public:
  explicit LivePage(int port) : client_(port) {
    REQUIRE(client_.upgrade("/live?token=" + token).starts_with("HTTP/1.1 101"));
  }
  void ask(const Json& request) { client_.say(request.dump()); }
  // Frames and texts until one of them is as wanted.
  bool hears(const std::function<bool(const Json&)>& wanted) {
    for (int i = 0; i < 2000; ++i) {
      const auto [kind, content] = client_.hear();
      if (kind == 0 || kind == 8) return false;
      if (kind == 1 && wanted(Json::parse(content))) return true;
      if (kind != 2) continue;
      client_.say(R"({"do": "seen"})");
      for (const view::Block& block : view::read_blocks(content))
        if (block.tag == view::status_tag && wanted(Json::parse(block.bytes))) return true;
    }
    return false;
  }

 private:
  Client client_;
};

bool runs_longer(const Json& json) { return json.contains("time") && json["time"].get<double>() > 0.1; }

// A stand-in for a browser's starter, which stays. It writes what it has: its files, and its session.
void write_starter(const Folder& folder) {
  const auto file = folder.write("xdg-open", "#!/bin/sh\nread -r line </proc/$$/stat\nls -l /proc/$$/fd >" +
                                                 (folder.path / "files").string() + "\necho $line >" +
                                                 (folder.path / "stat").string() + "\nexec sleep 60\n");
  std::filesystem::permissions(file, std::filesystem::perms(0755));
}

struct Started {
  pid_t process = 0, parent = 0, group = 0, session = 0;
};
Started started_in(const Folder& folder) {
  std::ifstream in(folder.path / "stat");
  std::string name, state;
  Started started;
  in >> started.process >> name >> state >> started.parent >> started.group >> started.session;
  return started;
}

}  // namespace

TEST_CASE(
    "the browser is on its own: no socket of the program, no Ctrl+C, no child; the port is free again") {
  const OnDisk disk;
  write_starter(disk.folder);
  const std::map<std::string, std::string> variables = {
      {"DISPLAY", ":77"}, {"PATH", disk.folder.path.string() + ":" + std::getenv("PATH")}};
  Program program({disk.scene, "--port", "0", "--token", token}, variables);
  const int port = program.port();
  REQUIRE(port > 0);
  REQUIRE(comes_to([&] { return started_in(disk.folder).session != 0; }));
  const Started browser = started_in(disk.folder);
  CHECK(browser.session != ::getsid(program.process()));
  CHECK(browser.group != program.process());
  CHECK(browser.parent != program.process());
  CHECK(bytes_of(disk.folder.path / "files").find("socket:") == std::string::npos);
  // No child of the program is left as a zombie.
  std::string children;
  for (const auto& thread :
       std::filesystem::directory_iterator("/proc/" + std::to_string(program.process()) + "/task"))
    children += bytes_of(thread.path() / "children");
  CHECK(children.empty());
  CHECK(program.end(SIGINT, true) == 0);
  CHECK(::kill(browser.process, 0) == 0);
  Program next({disk.scene, "--port", std::to_string(port), "--token", token, "--no-open"});
  CHECK(next.port() == port);
  CHECK(next.end(SIGTERM) == 0);
  ::kill(browser.process, SIGKILL);
}

TEST_CASE("a recording is written whichever signal ends the program, with its output closed as well") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    CAPTURE(signal);
    const OnDisk disk;
    Program program(
        {disk.scene, "--port", "0", "--token", token, "--no-open", "--record", disk.file("a.lobe")});
    const int port = program.port();
    REQUIRE(port > 0);
    LivePage page(port);
    page.ask(
        {{"do", "take"}, {"hand", 0}, {"from", {0.03, 0.03, 1}}, {"along", {0, 0, -1}}, {"radius", 0.02}});
    REQUIRE(page.hears(runs_longer));
    CHECK(program.end(signal) == 0);
    CHECK(program.said().find("lobe replay " + disk.scene + " " + disk.file("a.lobe")) != std::string::npos);
    const Scene scene = read_scene(disk.scene);
    const Recording recording = read_recording(disk.file("a.lobe"));
    World<float> world(as_recorded(recording, resolve(scene, read_mesh(mesh_path(scene)).mesh).setup));
    const ReplayResult result = replay(recording, world);
    CHECK(result.same);
    CHECK(result.time > 0.1);
  }
}

TEST_CASE("a link that leads nowhere in the folder for scenes costs an answer, not the program") {
  const OnDisk disk;
  std::filesystem::create_symlink("a.json", disk.folder.path / "a.json");
  Program program({disk.scene, "--port", "0", "--token", token, "--no-open", "--save-to",
                   disk.folder.path.string(), "--record", disk.file("b.lobe")});
  const int port = program.port();
  REQUIRE(port > 0);
  LivePage page(port);
  page.ask({{"do", "edit"}, {"on", true}});
  page.ask({{"do", "save"}, {"to", "a"}});
  CHECK(page.hears([](const Json& json) { return json.value("event", "") == "error"; }));
  CHECK(program.is_there());
  page.ask({{"do", "save"}, {"to", "c"}});
  CHECK(page.hears([](const Json& json) { return json.value("event", "") == "note"; }));
  CHECK(program.end(SIGTERM) == 0);
  CHECK(std::filesystem::exists(disk.file("b.lobe")));
}

TEST_CASE("time begins with the first page") {
  const OnDisk disk;
  Program program({disk.scene, "--port", "0", "--token", token, "--no-open"});
  const int port = program.port();
  REQUIRE(port > 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  LivePage page(port);
  double first = -1;
  REQUIRE(page.hears([&](const Json& json) {
    if (first < 0 && json.contains("time")) first = json["time"].get<double>();
    return first >= 0;
  }));
  CHECK(first < 0.5);
  CHECK(page.hears(runs_longer));
  CHECK(program.end(SIGTERM) == 0);
}

TEST_CASE("a recording that cannot be written is an error of the program") {
  const OnDisk disk;
  Program program(
      {disk.scene, "--port", "0", "--token", token, "--no-open", "--record", disk.file("no/a.lobe")});
  REQUIRE(program.port() > 0);
  CHECK(program.end(SIGTERM) == 2);
  CHECK(program.said().find("no/a.lobe") != std::string::npos);
}

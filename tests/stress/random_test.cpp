// Random commands to random bodies. After each, all of the world is valid. A world that goes on from a
// checkpoint, on another number of threads, has the same bits as the one that was saved, also where it is
// edited at once. A replay of the recording has them, too.
//
// LOBE_RANDOM_BODIES says how many bodies; LOBE_RANDOM_FIRST is the seed of the first, to play one again.
#include <doctest/doctest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "folder.h"
#include "lobe/error.h"
#include "lobe/live/timeline.h"
#include "stress/random_command.h"
#include "world_support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

// What a world says to a command that it refuses; nothing if it performs it.
template <class Perform>
std::string refusal_of(Perform&& perform) {
  try {
    perform();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class Real>
class RandomPlay {
 public:
  RandomPlay(Dice& dice, const RandomSetup& body)
      : dice_(dice), body_(body), world_(body.setup, 1), timeline_(world_, 0.1, std::size_t(64) << 20) {}

  void play(int frames) {
    for (int i = 0; i < frames && !has_failed_ && !is_crushed_; ++i) {
      if (dice_.says(0.04)) go_back();
      save_sometimes();
      for (int k = dice_.says(0.5) ? dice_.among(1, 4) : 0; k > 0 && !has_failed_; --k) {
        command();
        save_sometimes();
      }
      if (!has_failed_) advance();
    }
    World<Real> again(body_.setup, 2);
    const ReplayResult replayed = replay(timeline_.recording(), again);
    CHECK(replayed.same);
  }

 private:
  void go_back() {
    if (dice_.says(0.2))
      timeline_.restart();
    else
      timeline_.go_back(dice_.between(0, 0.5));
    restored_.reset();
  }

  // Another world goes on from here: a new one, or one that was somewhere else.
  void save_sometimes() {
    if (!dice_.says(0.06)) return;
    const Folder folder;
    write_checkpoint(folder.path / "saved", world_.save());
    if (!restored_ || dice_.says(0.6)) restored_ = std::make_unique<World<Real>>(body_.setup, 2);
    restored_->restore(read_checkpoint<Real>(folder.path / "saved"));
    check("restored");
  }

  void command() {
    const Command command = random_command(dice_, world_, body_);
    const std::string before = checkpoint_bytes(world_.save());
    const std::string refusal = refusal_of([&] { timeline_.apply(command); });
    if (refusal != "") {
      const bool left_a_trace = checkpoint_bytes(world_.save()) != before;
      CHECK_FALSE(left_a_trace);
    }
    if (restored_) CHECK(refusal_of([&] { restored_->apply(command); }) == refusal);
    check("command " + std::to_string(command.index()));
  }

  void advance() {
    const double duration = dice_.says(0.8) ? 1.0 / 120 : dice_.between(0.001, 0.03);
    const Report report = timeline_.advance(duration);
    if (restored_) {
      const Report other = restored_->advance(duration);
      CHECK(other.ok == report.ok);
      CHECK(other.steps == report.steps);
    }
    check("frame");
    // What crushes itself has ever more pairs that touch, in ever shorter steps. It is left.
    is_crushed_ = body_.setup.contact.self && report.reruns > 1;
    if (report.ok || dice_.says(0.5)) return;
    timeline_.go_back(0.2);
    restored_.reset();
  }

  void check(const std::string& after) {
    CAPTURE(after);
    CAPTURE(world_.time());
    const std::string fault = fault_of(world_);
    const bool differs = restored_ && !same_bits(*restored_, world_);
    CHECK(fault == "");
    CHECK_FALSE(differs);
    has_failed_ = fault != "" || differs;
  }

  Dice& dice_;
  const RandomSetup& body_;
  World<Real> world_;
  Timeline<Real> timeline_;
  std::unique_ptr<World<Real>> restored_;
  bool has_failed_ = false, is_crushed_ = false;
};

// False if the world refuses the setup.
template <class Real>
bool play(unsigned seed, int frames) {
  Dice dice(seed);
  const RandomSetup body = random_setup(dice);
  if (refusal_of([&] { World<Real>(body.setup); }) != "") return false;
  RandomPlay<Real>(dice, body).play(frames);
  return true;
}

// Each fourth in double precision.
bool play(unsigned seed) {
  constexpr int frames = 30;
  return seed % 4 == 0 ? play<double>(seed, frames) : play<float>(seed, frames);
}

}  // namespace

TEST_CASE("whatever is done to any body, it stays valid, and a restored one goes on to the same bits") {
  const unsigned first = number_from("LOBE_RANDOM_FIRST", 1), count = number_from("LOBE_RANDOM_BODIES", 40);
  unsigned played = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    CAPTURE(seed);
    played += play(seed);
  }
  MESSAGE(played << " of " << count << " bodies");
  if (count > 10) CHECK(played > count / 4);
}

// 268: lips of a closed cut, equally near to each other's points.
TEST_CASE("bodies that have shown faults") {
  for (const unsigned seed : {268U}) {
    CAPTURE(seed);
    CHECK(play(seed));
  }
}

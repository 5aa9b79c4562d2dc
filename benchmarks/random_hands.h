// Somebody who does whatever can be done in a session, by dice: for its benchmark and tests.
#pragma once

#include <array>
#include <random>
#include <vector>

#include "lobe/live/hand_command.h"

namespace lobe::bench {

struct RandomHandsOptions {
  Vec3d low = Vec3d::Zero(), high = Vec3d::Ones();  // of the body [m]
  bool goes_back = true;                            // also restarts
  std::vector<Index> removable;                     // tetrahedra that it removes, a few at a time
  bool brings_scalpels = false;  // in place of cauteries, and begins a stroke with hand 1 every 60th time
};

class RandomHands {
 public:
  RandomHands(unsigned seed, RandomHandsOptions options) : random_(seed), options_(std::move(options)) {}

  // What somebody asks for next: nine times in ten that a hand goes somewhere.
  HandCommand next() {
    using Kind = HandCommand::Kind;
    HandCommand command{.kind = Kind::lead, .hand = 1 + HandNumber(dice(3)), .sequence = ++sequence_};
    command.position = place();
    command.orientation = turn();
    command.radius = size() * (0.05 + 0.1 * uniform());
    constexpr std::array stroke = {Kind::let_go, Kind::bring, Kind::turn_on, Kind::lead, Kind::lead};
    const int toss = dice(1000);
    if (options_.brings_scalpels && sequence_ % 60 < stroke.size())
      command.kind = stroke[sequence_ % 60], command.hand = 1;
    else if (toss < 15)
      command.kind = Kind::take_at_point;
    else if (toss < 40)
      look_from_above(command);
    else if (toss < 50)
      command.kind = Kind::bring;
    else if (toss < 70)
      command.kind = Kind::turn_on;
    else if (toss < 90)
      command.kind = Kind::let_go;
    else if (toss < 95)
      pause(command);
    else if ((toss < 98 || sequence_ % 150 == 0) && options_.goes_back)  // not only by chance
      command.kind = Kind::back;
    else if (toss < 99 && options_.goes_back)
      command.kind = Kind::restart;
    else if (toss < 101)
      remove(command);
    command.on = command.kind == Kind::run || dice(2) == 0;
    if (command.kind == Kind::turn_on && options_.brings_scalpels) command.on = true;
    command.value = 0.3 * uniform() + 0.01;
    if (command.kind == Kind::bring) bring(command);
    return command;
  }

  double uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  int dice(int sides) { return int(random_() % unsigned(sides)); }

 private:
  double size() const { return (options_.high - options_.low).minCoeff(); }
  Vec3d place() {
    const Vec3d share(uniform(), uniform(), uniform());
    return options_.low + share.cwiseProduct(options_.high - options_.low) * 1.2 -
           0.1 * (options_.high - options_.low);
  }
  Eigen::Vector4d turn() {
    const Vec3d axis(uniform() - 0.5, uniform() - 0.5, uniform() - 0.5);
    return Eigen::Quaterniond(Eigen::AngleAxisd(uniform(), (axis + Vec3d(0, 0, 1)).normalized())).coeffs();
  }
  void look_from_above(HandCommand& command) {
    command.kind = HandCommand::Kind::take_at_ray;
    command.position.z() = options_.high.z() + 1;
    command.direction = {0.02 * (uniform() - 0.5), 0.02 * (uniform() - 0.5), -1};
  }
  void bring(HandCommand& command) {
    if (options_.brings_scalpels) {
      const Vec3d blade = size() * (turn().head<3>() + Vec3d(0, 0, 0.5));
      command.tool =
          std::make_shared<const BringTool>(BringScalpel{"", {command.position, command.position + blade}});
    } else {
      command.tool = std::make_shared<const BringTool>(
          BringCautery{"", size() * 0.02 * (0.5 + uniform()), command.position});
    }
  }
  void pause(HandCommand& command) {
    command.kind = dice(2) == 0 ? HandCommand::Kind::run : HandCommand::Kind::step;
  }
  void remove(HandCommand& command) {
    if (options_.removable.empty()) return;
    RemoveTets removal;
    for (int i = 0; i < 4; ++i)
      removal.tets.push_back(options_.removable[random_() % options_.removable.size()]);
    command.kind = HandCommand::Kind::edit;
    command.body_edit = std::make_shared<const Edit>(removal);
  }

  std::mt19937 random_;
  RandomHandsOptions options_;
  std::uint64_t sequence_ = 0;
};

}  // namespace lobe::bench

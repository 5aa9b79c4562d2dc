// Who sleeps: the vertices of patches at rest, held where they are until somebody pulls at them (theory, section 8).
#pragma once

#include <vector>

#include "lobe/types.h"

namespace lobe {

class Sleep {
 public:
  static constexpr double calm_time = 0.1;  // who has been still for so long may sleep [s]

  // What is to be kept and given back; empty where nobody ever sleeps.
  struct State {
    std::vector<std::uint8_t> asleep;   // per vertex
    std::vector<double> restless_till;  // per vertex [s]
  };

  Sleep() = default;
  // `move`: as far as a vertex that moves alone may be from its equilibrium [m]; 0: nobody sleeps.
  explicit Sleep(double move) : move_(move) {}

  bool is_on() const { return move_ > 0; }
  double move() const { return move_; }
  bool any() const { return count_ > 0; }
  Index count() const { return count_; }
  bool is_asleep(Index v) const { return any() && state_.asleep[v] != 0; }
  bool rests(Index v, double time) const {
    return state_.asleep[v] != 0 || time - state_.restless_till[v] >= calm_time;
  }

  void extend(Index vertices, double time) {  // new ones are awake
    if (!is_on()) return;
    state_.asleep.resize(std::size_t(vertices), 0);
    state_.restless_till.resize(std::size_t(vertices), time);
  }
  void stir(Index v, double time) { state_.restless_till[v] = time; }
  void put_to_sleep(Index v) {
    count_ += 1 - state_.asleep[v];
    state_.asleep[v] = 1;
  }
  void wake(Index v, double time) {
    if (!is_asleep(v)) return;
    --count_;
    state_.asleep[v] = 0;
    stir(v, time);
  }
  void wake_all(double time) {
    count_ = 0;
    state_.asleep.assign(state_.asleep.size(), 0);
    state_.restless_till.assign(state_.asleep.size(), time);
  }

  const State& state() const { return state_; }
  void set_state(const State& state) {
    state_ = state;
    count_ = 0;
    for (std::uint8_t asleep : state_.asleep) count_ += asleep;
  }

  // What a step reads while somebody sleeps:
  struct Watched {  // asleep beside who is awake
    Index vertex = 0;
    double most = 0;  // a larger force wakes it [N]
  };
  std::vector<Index> wanted;  // vertices whose forces may change
  std::vector<Watched> watched;

 private:
  double move_ = 0;  // [m]
  State state_;
  Index count_ = 0;
};

}  // namespace lobe

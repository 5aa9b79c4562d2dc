#include "lobe/live/session.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"
#include "lobe/text.h"

namespace lobe {
namespace {

using Clock = Pace::Clock;
using Kind = HandCommand::Kind;

// Whether an edit sews. A hand that pulls a thread already goes on with that.
template <class Real>
bool sews(const Edit& edit, const World<Real>& world) {
  const Pull* pull = std::get_if<Pull>(&edit);
  if (!pull)
    return std::holds_alternative<Bite>(edit) || std::holds_alternative<Tie>(edit) ||
           std::holds_alternative<CutThread>(edit);
  const Threads<Real>* threads = term_of<Threads>(world.body().terms);
  return pull->on && threads &&
         std::none_of(threads->all().begin(), threads->all().end(), [&](const Thread& thread) {
           return thread.number == pull->thread && thread.hand.holds;
         });
}

// Whether a hand begins something with it: one can go back to the moment before.
template <class Real>
bool begins_an_act(const HandCommand& command, const World<Real>& world) {
  if (command.kind == Kind::edit) return command.body_edit && sews(*command.body_edit, world);
  return command.kind == Kind::take_at_ray || command.kind == Kind::take_at_point ||
         command.kind == Kind::bring;
}

bool is_above_0(double value) { return value > 0 && std::isfinite(value); }

const SessionOptions& checked(const SessionOptions& options) {
  const auto expect = [](bool is_right, const char* what) {
    if (!is_right) throw InputError("session", what);
  };
  const HandLimits& hand = options.hand;
  expect(is_above_0(options.frame), "its frames must be longer than 0 s, and finite");
  expect(is_session_speed(options.speed), "its speed must be from 0.001 to 100 simulated seconds per second");
  expect(options.queue > 0, "its queue must have room for a command");
  expect(options.back_every >= 0, "the time between states to go back to must be at least 0 s");
  expect(options.controller_timeout >= 0, "the controllers' timeout must be 0 s or more");
  expect(
      is_above_0(hand.lag) && is_above_0(hand.top_speed) && is_above_0(hand.top_turn) && hand.force_cap > 0,
      "the limits of hands must be above 0");
  return options;
}

// Shortens a frame so that its multiples up to millions are exact. The times of frames are then the same
// however they are summed, and a scene can have them.
double with_exact_multiples(double frame) {
  constexpr int bits = 30;
  int exponent = 0;
  const double mantissa = std::frexp(frame, &exponent);
  return std::ldexp(std::floor(std::ldexp(mantissa, bits)), exponent - bits);
}

}  // namespace

template <class Real>
Session<Real>::Session(const Setup& setup, const SessionOptions& options)
    : options_(checked(options)),
      frame_(with_exact_multiples(options.frame)),
      queue_(options.queue),
      world_(setup, options.threads, options.condensing),
      pictures_(world_.snapshots()),
      timeline_(world_, options.back_every, options.back_memory),
      hands_(
          world_, [this](const Command& command) { timeline_.apply(command); }, queue_, messages_,
          options.hand),
      speed_(options.speed),
      is_running_(options.running) {
  publish({});
}

// ---- A frame

template <class Real>
bool Session<Real>::step_frame() {
  take_commands();
  if (!is_running_ && !steps_once_) {
    if (was_changed_) publish({});
    if (was_told_) publish_status();
    return false;
  }
  steps_once_ = false;
  for (SessionHook<Real>* hook : hooks_) hook->before_frame(hands_, world_, frame_);
  hands_.notice_gone_tools();
  hands_.before_frame(frame_);
  const Report report = timeline_.advance(frame_);
  ++frames_;
  hands_.after_frame();
  for (SessionHook<Real>* hook : hooks_) hook->after_frame(hands_, world_, frame_);
  for (const Condition& condition : report.conditions) report_condition(condition);
  for (const Event& event : report.events)
    if (!event.text.empty()) say(name(event.kind), event.text);
  if (!report.ok) {
    say("stands_still", "the simulation cannot go on from here: go back, or restart");
    stands_still_ = true;
    set_running(false);
  }
  publish(report);
  return true;
}

// Frames that are run again give one message, whatever number of steps each took. Snapshots have the figures.
template <class Real>
void Session<Real>::report_condition(const Condition& condition) {
  const bool is_again = condition.kind == Condition::Kind::sub_stepped;
  reruns_ += is_again;
  say(name(condition.kind), is_again ? "a frame was run again with smaller steps" : condition.text);
}

template <class Real>
void Session<Real>::publish(const Report& report) {
  world_.publish(report);
  was_changed_ = false;
  publish_status();
}

template <class Real>
void Session<Real>::publish_status() {
  was_told_ = false;
  SessionStatus* status = status_.writable();
  if (!status) return;
  if (const auto picture = pictures_.latest()) status->picture = picture->frame;
  status->time = world_.time();
  status->is_running = is_running_;
  status->stands_still = stands_still_;
  status->speed = speed_;
  status->real_time_factor = is_running_ ? pace_.factor() : 0;
  status->possible_factor = is_running_ ? pace_.possible_factor() : 0;
  status->frames = frames_;
  status->frames_late = pace_.frames_late();
  status->reruns = reruns_;
  status->can_go_back = timeline_.can_go_back();
  status->revision = world_.surface().revision();
  hands_.tell(status->hands);
  status->sequences.resize(last_commands_.size());
  std::transform(last_commands_.begin(), last_commands_.end(), status->sequences.begin(),
                 [](const LastCommand& last_command) { return last_command.sequence; });
  status->messages = messages_.all();
  status_.publish();
  if (!options_.published) return;
  try {
    options_.published();
  } catch (const std::exception& error) {
    say("failed", std::string("a picture could not be passed on: ") + error.what());
  }
}

// ---- Commands

// Performs the commands. Controllers that have gone have sent all their commands before they went.
template <class Real>
void Session<Real>::take_commands() {
  hands_.notice_gone_tools();
  const std::vector<int> gone = queue_.gone();
  while (const auto sent = queue_.take()) perform_command(*sent);
  for (int controller : gone) {
    if (const int full = hands_.drop(controller); full > 0)
      say("controller_gone",
          queue_.name(controller) + ": its " + std::to_string(full) + " tools have let go");
    last_commands_[std::size_t(controller)] = {};
    queue_.forget(controller);
    was_told_ = true;
  }
  if (options_.controller_timeout > 0) drop_silent_controllers();
}

template <class Real>
void Session<Real>::drop_silent_controllers() {
  const auto patience = std::chrono::duration<double>(options_.controller_timeout);
  for (int controller : hands_.controllers()) {
    if (Clock::now() - last_commands_[std::size_t(controller)].at < patience) continue;
    if (hands_.drop(controller) > 0)
      say("controller_gone", queue_.name(controller) + ": silent for more than " +
                                 rounded(options_.controller_timeout) + " s, its tools have let go");
  }
}

template <class Real>
void Session<Real>::perform_command(const HandQueue::Sent& sent) {
  LastCommand& last_command = last_commands_[std::size_t(sent.controller)];
  last_command = {std::max(last_command.sequence, sent.command.sequence), Clock::now()};
  was_told_ = true;
  try {
    const bool goes_back = sent.command.kind == Kind::restart || sent.command.kind == Kind::back;
    if (has_failed_ && !goes_back && sent.command.kind != Kind::alive)
      throw InputError("session", "has failed: go back, or restart");
    if (begins_an_act(sent.command, world_)) timeline_.keep();
    if (sent.command.kind <= Kind::let_go)
      hands_.perform_command(sent.controller, sent.command);
    else
      control(sent.command);
  } catch (const InputError& error) {
    say("refused", queue_.name(sent.controller) + ": " + error.what());
  }
}

template <class Real>
void Session<Real>::control(const HandCommand& command) {
  switch (command.kind) {
    case Kind::edit:
      return edit(command);
    case Kind::run:
      return set_running(command.on);
    case Kind::step:
      steps_once_ = true;
      return;
    case Kind::speed:
      if (!is_session_speed(command.value))
        throw InputError("speed", "must be from 0.001 to 100 simulated seconds per second");
      speed_ = command.value;
      return pace_.start(Clock::now());
    case Kind::restart:
    case Kind::back:
      return go_back(command);
    case Kind::alive:
      return;
    default:
      throw InputError("command", "there is none of kind " + std::to_string(int(command.kind)));
  }
}

template <class Real>
void Session<Real>::go_back(const HandCommand& command) {
  const bool restarts = command.kind == Kind::restart;
  if (!restarts && command.value != 0 && !is_above_0(command.value))
    throw InputError("back", "must be by 0 s or more");
  const double from = world_.time();
  hands_.forget();
  restarts ? timeline_.restart() : timeline_.go_back(command.value);
  stands_still_ = has_failed_ = false;
  was_changed_ = true;
  say("went_back", "from " + rounded(from) + " s to " + rounded(world_.time()) + " s");
}

template <class Real>
void Session<Real>::restore(const std::filesystem::path& file) {
  timeline_.restore(read_session<Real>(file));
  hands_.forget();
  stands_still_ = has_failed_ = false;
  say("restored", "the state at " + rounded(world_.time()) + " s of " + file.filename().string());
  publish({});
}

template <class Real>
void Session<Real>::edit(const HandCommand& command) {
  if (!command.body_edit) throw InputError("edit", "has no command for the body");
  timeline_.apply(as_command(*command.body_edit));
  was_changed_ = true;
}

template <class Real>
void Session<Real>::set_running(bool running) {
  if (running && !is_running_) {
    stands_still_ = false;
    pace_.start(Clock::now());
  }
  is_running_ = running;
}

template class Session<float>;
template class Session<double>;

}  // namespace lobe

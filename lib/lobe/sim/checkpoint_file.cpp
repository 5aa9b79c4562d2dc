#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lobe/io/scanner.h"
#include "lobe/io/sealed_file.h"
#include "lobe/sim/checkpoint.h"

namespace lobe {
namespace {

template <class Real>
constexpr io::Format format{std::is_same_v<Real, float> ? "lobestaf" : "lobestad", 10,
                            std::is_same_v<Real, float> ? "state of a world in single precision"
                                                        : "state of a world in double precision"};

template <class Matrix>
void put_matrix(io::ByteWriter& out, const Matrix& values) {
  out.put_all(std::span(values.data(), std::size_t(values.size())));
}

template <class Value>
Mat3X<Value> get_matrix(io::ByteReader& in) {
  const std::vector<Value> values = in.get_all<Value>();
  in.expect(values.size() % 3 == 0);
  return Eigen::Map<const Mat3X<Value>>(values.data(), 3, Eigen::Index(values.size() / 3));
}

void put(io::ByteWriter& out, const HeldVertices::Held& item) {
  out.put(item.vertex);
  out.put(item.holder);
  for (int i = 0; i < 3; ++i) {
    out.put(item.start[i]);
    out.put(item.goal[i]);
    out.put(std::uint8_t(item.axes[i]));
  }
}

HeldVertices::Held get_held(io::ByteReader& in) {
  HeldVertices::Held item;
  item.vertex = in.get<Index>();
  item.holder = in.get<int>();
  in.expect(item.vertex >= 0);
  for (int i = 0; i < 3; ++i) {
    item.start[i] = in.get<double>();
    item.goal[i] = in.get<double>();
    item.axes[i] = in.get_choice(2) == 1;
  }
  in.expect(item.start.allFinite() && item.goal.allFinite());
  return item;
}

void put(io::ByteWriter& out, const HeldVertices& held) {
  out.put(std::uint64_t(held.all().size()));
  for (const HeldVertices::Held& item : held.all()) put(out, item);
}

HeldVertices get_held_vertices(io::ByteReader& in, Eigen::Index vertices) {
  HeldVertices held;
  for (std::size_t left = in.get_count(1); left > 0; --left) {
    const HeldVertices::Held item = get_held(in);
    in.expect(item.vertex < vertices);
    held.hold(item);
  }
  return held;
}

void put(io::ByteWriter& out, const Edit& edit) {
  out.put(edit.kind);
  out.put(edit.model);
  out.put_all(std::span(edit.tets));
  put(out, edit.held);
  out.put(edit.due);
  out.put_all(std::span(edit.about));
}

Edit get_edit(io::ByteReader& in, Eigen::Index vertices) {
  Edit edit;
  edit.kind = Edit::Kind(in.get_choice(7));
  edit.model = RegionModel(in.get_choice(3));
  edit.tets = in.get_all<Index>();
  edit.held = get_held_vertices(in, vertices);
  edit.due = in.get<double>();
  edit.about = in.get_all<double>();
  in.expect(std::isfinite(edit.due) &&
            std::all_of(edit.about.begin(), edit.about.end(), [](double x) { return std::isfinite(x); }));
  return edit;
}

Sleep::State get_sleep(io::ByteReader& in) {
  Sleep::State sleep{in.get_all<std::uint8_t>(), in.get_all<double>()};
  for (std::uint8_t asleep : sleep.asleep) in.expect(asleep <= 1);
  for (double time : sleep.restless_till) in.expect(std::isfinite(time));
  return sleep;
}

Unravelling get_unravelling(io::ByteReader& in) {
  Unravelling unravelling;
  unravelling.tets = in.get_all<Index>();
  unravelling.stage = in.get_choice(1 + Unravelling::stages);
  unravelling.since = in.get<double>();
  in.expect(std::isfinite(unravelling.since));
  unravelling.is_lumped = in.get_choice(2) == 1;
  return unravelling;
}

FrequencyRatios get_ratios(io::ByteReader& in) {
  FrequencyRatios ratios;
  ratios.most = in.get<double>();
  ratios.own = in.get_all<float>();
  ratios.limit = in.get<double>();
  ratios.steps = in.get<int>();
  in.expect(ratios.most > 0 && std::isfinite(ratios.most) && ratios.limit >= 0);
  in.expect(ratios.steps >= 0 && ratios.steps <= FrequencyRatios::most_steps);
  for (float own : ratios.own) in.expect(own > 0 && own <= static_cast<float>(ratios.most));
  return ratios;
}

void put(io::ByteWriter& out, const Condition& condition) {
  out.put(std::uint8_t(condition.kind));
  out.put(condition.time);
  out.put_all(std::span(condition.text.data(), condition.text.size()));
}

Condition get_condition(io::ByteReader& in) {
  Condition condition;
  condition.kind = Condition::Kind(in.get_choice(1 + int(Condition::Kind::unravelling)));
  condition.time = in.get<double>();
  const std::vector<char> text = in.get_all<char>();
  condition.text.assign(text.begin(), text.end());
  return condition;
}

}  // namespace

template <class Real>
void write_checkpoint(const std::filesystem::path& file, const Checkpoint<Real>& c) {
  io::ByteWriter out;
  const auto put_each = [&](const auto& list) {
    out.put(std::uint64_t(list.size()));
    for (const auto& entry : list) put(out, entry);
  };
  out.put(c.setup);
  out.put(c.state.time);
  out.put(c.state.behind);
  put_matrix(out, c.state.u);
  put_matrix(out, c.state.v);
  put_each(c.history);
  put(out, c.held);
  out.put(std::uint64_t(c.grasps.size()));
  for (const Tools::GraspState grasp : c.grasps) out.put(grasp);
  out.put_all(std::span(c.body_of));
  out.put_all(std::span(c.body_was_held));
  out.put_all(std::span(c.sleep.asleep));
  out.put_all(std::span(c.sleep.restless_till));
  out.put(std::uint8_t(c.implicit_is_stale));
  put_matrix(out, c.acceleration);
  put_each(c.pending);
  out.put_all(std::span(c.unravelling.tets));
  out.put(std::uint8_t(c.unravelling.stage));
  out.put(c.unravelling.since);
  out.put(std::uint8_t(c.unravelling.is_lumped));
  out.put(c.ratios.most);
  out.put_all(std::span(c.ratios.own));
  out.put(c.ratios.limit);
  out.put(c.ratios.steps);
  out.put(c.mass_degree);
  io::write_sealed(file, format<Real>, out.bytes());
}

template <class Real>
Checkpoint<Real> parse_checkpoint(const std::string& name, std::string_view bytes) {
  io::ByteReader in(name, io::unseal(name, bytes, format<Real>));
  Checkpoint<Real> c;
  c.setup = in.get<std::uint64_t>();
  c.state.time = in.get<double>();
  c.state.behind = in.get<double>();
  c.state.u = get_matrix<Real>(in);
  c.state.v = get_matrix<Real>(in);
  in.expect(std::isfinite(c.state.time) && c.state.behind >= 0 && std::isfinite(c.state.behind) &&
            c.state.u.allFinite() && c.state.v.allFinite());
  for (std::size_t left = in.get_count(1); left > 0; --left)
    c.history.push_back(get_edit(in, c.state.u.cols()));
  c.held = get_held_vertices(in, c.state.u.cols());
  for (std::size_t left = in.get_count(1); left > 0; --left)
    c.grasps.push_back(Tools::GraspState(in.get_choice(3)));
  c.body_of = in.get_all<Index>();
  c.body_was_held = in.get_all<std::uint8_t>();
  c.sleep = get_sleep(in);
  c.implicit_is_stale = in.get_choice(2) == 1;
  c.acceleration = get_matrix<double>(in);
  in.expect(c.acceleration.allFinite());
  for (std::size_t left = in.get_count(1); left > 0; --left) c.pending.push_back(get_condition(in));
  c.unravelling = get_unravelling(in);
  c.ratios = get_ratios(in);
  c.mass_degree = in.get<int>();
  in.expect_end();
  return c;
}

template <class Real>
Checkpoint<Real> read_checkpoint(const std::filesystem::path& file) {
  return parse_checkpoint<Real>(file.string(), io::read_file(file));
}

template void write_checkpoint(const std::filesystem::path&, const Checkpoint<float>&);
template void write_checkpoint(const std::filesystem::path&, const Checkpoint<double>&);
template Checkpoint<float> parse_checkpoint(const std::string&, std::string_view);
template Checkpoint<double> parse_checkpoint(const std::string&, std::string_view);
template Checkpoint<float> read_checkpoint(const std::filesystem::path&);
template Checkpoint<double> read_checkpoint(const std::filesystem::path&);

}  // namespace lobe

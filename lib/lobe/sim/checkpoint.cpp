#include "lobe/sim/checkpoint.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "lobe/error.h"
#include "lobe/file/atomic_file.h"
#include "lobe/file/scanner.h"
#include "lobe/organ/kinds_of_terms.h"
#include "lobe/sim/enum_sizes.h"

namespace lobe {
namespace {

template <class Real>
constexpr io::Format format{std::is_same_v<Real, float> ? "lobestaf" : "lobestad", 32,
                            std::is_same_v<Real, float> ? "state of a world in single precision"
                                                        : "state of a world in double precision"};

// Refuses a checkpoint of the right setup with a part that this cannot have.
void expect(bool fits, const std::string& part) {
  if (!fits)
    throw InputError("checkpoint", "is of this scene, but has " + part +
                                       " that do not fit it: it was damaged or changed, take another one");
}

// Tries the saved states of terms that an application has added. They keep their own. Throws InputError, as
// the terms do.
template <class Real>
void try_added_terms(const std::vector<std::shared_ptr<ForceTerm<Real>>>& terms, const Checkpoint<Real>& c,
                     Index vertices) {
  for (const auto& entry : c.terms) {
    if (find_kind_of_term<Real>(entry.name)) continue;
    const auto term = std::find_if(terms.begin(), terms.end(),
                                   [&](const auto& each) { return each->name() == entry.name; });
    if (term == terms.end())
      throw InputError("checkpoint",
                       "has a force term \"" + entry.name + "\", which the world has not: add it");
    const std::string former = (*term)->save();
    try {
      (*term)->load(entry.saved, static_cast<Index>(c.state.u.cols()));
    } catch (...) {
      (*term)->load(former, vertices);
      throw;
    }
    (*term)->load(former, vertices);
  }
}

template <class Real>
void check_pieces(const Checkpoint<Real>& c, std::size_t tets) {
  const auto is_known = [&](Index piece) {
    return piece >= 0 && std::size_t(piece) < c.pieces.was_held.size();
  };
  const std::vector<Index>& piece_of = c.pieces.piece_of;
  expect(is_known(0) && (piece_of.empty() || piece_of.size() == tets) &&
             std::all_of(piece_of.begin(), piece_of.end(), is_known),
         "pieces");
}

template <class Real>
void check_held(const Checkpoint<Real>& c, Index vertices) {
  const auto is_holder = [&](int holder) {
    return std::any_of(c.tools.grasps.begin(), c.tools.grasps.end(), [&](const Grasp& grasp) {
      return grasp.id == holder && grasp.phase == Grasp::Phase::holding;
    });
  };
  for (const HeldVertices::Held& item : c.held.as_saved())
    expect(item.vertex >= 0 && item.vertex < vertices &&
               (item.holder == HeldVertices::boundary || is_holder(item.holder)),
           "held vertices");
}

// Tries the terms that an organ makes by itself.
template <class Real>
void check_own_terms(const Checkpoint<Real>& c, const Organ<Real>& organ) {
  for (const auto& term : c.terms)
    if (const auto* kind = find_kind_of_term<Real>(term.name)) {
      const std::shared_ptr<ForceTerm<Real>> tried = kind->make(organ.setup());
      tried->load(term.saved, organ.elements().topology.vertex_count());
      tried->acts_on(organ.body().model);  // throws for what the body does not have
    }
}

template <class Real>
void check_fits(const Checkpoint<Real>& c, Organ<Real>& organ) {
  const Index vertices = organ.elements().topology.vertex_count();
  const auto tets = std::size_t(organ.elements().topology.tet_count());
  const std::size_t sleepers = organ.body().sleep.state().asleep.size();
  const std::vector<int> degrees = organ.body().inertia.degrees();
  expect(std::count(degrees.begin(), degrees.end(), c.mass_degree) == 1, "selective masses of a degree");
  expect(c.state.u.cols() == vertices && c.state.v.cols() == vertices, "displacements of other vertices");
  expect(c.acceleration.size() == 0 || c.acceleration.cols() == vertices, "accelerations of other vertices");
  check_pieces(c, tets);
  expect(Tools::fits(c.tools, vertices, organ.setup()), "tools");
  expect(Blades::fits(c.blades, organ.grains()), "cuts of blades");
  expect(c.sleep.asleep.size() == sleepers && c.sleep.still_since.size() == sleepers &&
             c.sleep.squares.size() == sleepers,
         "sleeping vertices");
  expect(c.ratios.of_vertex.size() == std::size_t(vertices), "frequencies of other vertices");
  expect(!organ.body().own_steps || organ.body().own_steps->fits(organ.body(), c.own_steps),
         "own steps of other patches");
  expect(organ.body().regions.fits(c.nodes, organ.elements()), "nodes of regions");
  expect(c.dashpots.size() == organ.body().regions.dashpots().size() &&
             std::all_of(c.dashpots.begin(), c.dashpots.end(), [](Real A) { return std::isfinite(A); }),
         "dashpots of viscous tetrahedra");
  check_own_terms(c, organ);
  for (Index t : c.unravelling.tets) expect(t >= 0 && std::size_t(t) < tets, "crushed tetrahedra");
  check_held(c, vertices);
}

}  // namespace

template <class Real>
Checkpoint<Real> World<Real>::save() const {
  Checkpoint<Real> c;
  c.setup = organ_.journal().setup;
  c.history = organ_.journal().edits;
  c.state = {body().motion.u.view(), body().motion.v.view(), time(), body().motion.velocity_lag};
  c.held = held();
  c.tools = tools_.state();
  c.blades = organ_.blades().state();
  c.pieces = organ_.pieces().state();
  c.sleep = body().sleep.state();
  c.unravelling = organ_.unravelling().state();
  c.ratios = organ_.limit().ratios();
  c.limit = organ_.limit().frame_limit();
  c.limit.is_new = c.limit.is_new || !organ_.limit().holds(body());
  if (body().own_steps) c.own_steps = body().own_steps->state();
  c.nodes = body().regions.state(body().motion);
  c.mass_degree = body().inertia.degree();
  c.dashpots = body().regions.dashpots();
  if (organ_.implicit()) c.acceleration = organ_.implicit()->acceleration(body().model);
  c.pending = organ_.unreported().conditions;
  c.transitions = organ_.unreported().transitions;
  c.wishes = organ_.wish_memory();
  for (const auto& term : body().terms) c.terms.push_back({term->name(), term->save()});
  return c;
}

template <class Real>
void World<Real>::restore(const Checkpoint<Real>& c) {
  if (c.setup != organ_.journal().setup)
    throw InputError("checkpoint", "is of another scene, mesh or version of them");
  Organ<Real>::check(c.state);
  try_added_terms(body().terms, c, elements().topology.vertex_count());
  if (c.history != organ_.journal().edits) {  // removed tetrahedra do not come back
    World fresh(organ_.initial_setup(), body().parallel.threads());
    for (const JournalEntry& entry : c.history) fresh.organ_.repeat(entry);
    check_fits(c, fresh.organ_);
    fresh.organ_.take_surroundings(organ_);
    *this = std::move(fresh);
  }
  check_fits(c, organ_);
  take(c);
}

// Terms that an application has added belong to it. They are in the order of the checkpoint, in which their
// forces are added. Those that are not in it come last and keep their state. Tools are shown from the moment
// before on, as they have the speed with which they came.
template <class Real>
void World<Real>::load_terms(const Checkpoint<Real>& c) {
  auto former = std::exchange(body().terms, {});
  std::erase_if(former, [](const auto& term) { return find_kind_of_term<Real>(term->name()) != nullptr; });
  for (const auto& entry : c.terms) {
    const auto added = std::find_if(former.begin(), former.end(),
                                    [&](const auto& term) { return term->name() == entry.name; });
    if (added != former.end()) {
      body().terms.push_back(std::move(*added));
      former.erase(added);
    }
    ForceTerm<Real>& term =
        find_kind_of_term<Real>(entry.name) ? organ_.own_term(entry.name) : *body().terms.back();
    term.load(entry.saved, elements().topology.vertex_count());
  }
  std::move(former.begin(), former.end(), std::back_inserter(body().terms));
  organ_.show_tools(tools_.bodies(time() - 2 * velocity_moment, time()));
}

template <class Real>
void World<Real>::take(const Checkpoint<Real>& c) {
  body().inertia.ask_for(c.mass_degree);
  body().inertia.use(c.unravelling.is_lumped ? 1 : c.mass_degree);
  set_state(c.state);
  body().sleep.set_state(c.sleep);
  organ_.unravelling().set_state(c.unravelling);
  body().model.held = c.held;
  organ_.take_nodes(c.nodes, c.state);
  tools_.set_state(c.tools);
  organ_.blades().set_state(c.blades);
  organ_.pieces().set_state(c.pieces);
  organ_.unreported().conditions = c.pending;
  organ_.unreported().transitions = c.transitions;
  organ_.wish_memory() = c.wishes;
  body().regions.set_dashpots(c.dashpots);
  load_terms(c);
  for (Index v = 0; v < elements().topology.vertex_count(); ++v)
    body().inertia.update_inverse(body().model, v);
  organ_.show_body_anew();  // as the step limit has to do with the stiffness of terms
  organ_.limit().set_ratios(c.ratios);
  organ_.limit().set_frame_limit(c.limit, body());
  if (body().own_steps) body().own_steps->set_state(body(), c.own_steps);
  if (organ_.implicit()) organ_.implicit()->set_acceleration(body().model, c.acceleration);
  aim_hold_springs();
}

// ---- Files

template <class Real>
std::string checkpoint_bytes(const Checkpoint<Real>& checkpoint) {
  io::ByteWriter out;
  io::put(out, checkpoint);
  return io::seal(format<Real>, out.bytes());
}

template <class Real>
void write_checkpoint(const std::filesystem::path& file, const Checkpoint<Real>& checkpoint) {
  io::write_file(file, checkpoint_bytes(checkpoint));
}

template <class Real>
Checkpoint<Real> parse_checkpoint(const std::string& name, std::string_view bytes) {
  io::ByteReader in(name, io::unseal(name, bytes, format<Real>));
  Checkpoint<Real> checkpoint;
  io::get(in, checkpoint);
  in.expect_end();
  return checkpoint;
}

AnyCheckpoint parse_any_checkpoint(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with(format<float>.name)) return parse_checkpoint<float>(name, bytes);
  if (bytes.starts_with(format<double>.name)) return parse_checkpoint<double>(name, bytes);
  throw InputError(name, "is not the state of a world");
}

template <class Real>
Checkpoint<Real> read_checkpoint(const std::filesystem::path& file) {
  return parse_checkpoint<Real>(file.string(), io::read_file(file));
}

// ---- The last few

template <class Real>
void CheckpointRing<Real>::keep(const World<Real>& world, std::size_t mark) {
  if (!entries_.empty() && world.time() < entries_.back().checkpoint.state.time + apart_ - just_before)
    return;
  keep_now(world, mark);
}

template <class Real>
void CheckpointRing<Real>::keep_now(const World<Real>& world, std::size_t mark) {
  if (most_ == 0) return;
  if (!entries_.empty() && world.time() == entries_.back().checkpoint.state.time) return;
  if (entries_.size() == most_) entries_.pop_front();
  Checkpoint<Real> checkpoint = world.save();
  const std::size_t size = io::memory_of(checkpoint);
  entries_.push_back({std::move(checkpoint), mark, size});
  while (entries_.size() > 1 && bytes() > most_bytes_) entries_.pop_front();
}

template <class Real>
std::size_t CheckpointRing<Real>::bytes() const {
  std::size_t sum = 0;
  for (const Entry& entry : entries_) sum += entry.bytes;
  return sum;
}

template <class Real>
auto CheckpointRing<Real>::latest(double time) -> const Entry* {
  while (!entries_.empty() && entries_.back().checkpoint.state.time > time) entries_.pop_back();
  return entries_.empty() ? nullptr : &entries_.back();
}

template <class Real>
bool CheckpointRing<Real>::roll_back(World<Real>& world, double seconds) {
  const Entry* entry = latest(world.time() - seconds);
  if (entry) world.restore(entry->checkpoint);
  return entry != nullptr;
}

#define LOBE_INSTANTIATE(Real)                                                           \
  template void write_checkpoint(const std::filesystem::path&, const Checkpoint<Real>&); \
  template std::string checkpoint_bytes(const Checkpoint<Real>&);                        \
  template Checkpoint<Real> parse_checkpoint(const std::string&, std::string_view);      \
  template Checkpoint<Real> read_checkpoint(const std::filesystem::path&);               \
  template class CheckpointRing<Real>;
LOBE_INSTANTIATE(float)
LOBE_INSTANTIATE(double)
#undef LOBE_INSTANTIATE

}  // namespace lobe

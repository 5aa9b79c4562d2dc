#include <fstream>

#include "folder.h"
#include "live/hands_support.h"
#include "lobe/error.h"

using namespace lobe;
using namespace lobe::test;

namespace {

// Pulls the block at its top, cuts a piece out of it, and holds it.
void pull_and_cut(Session<float>& session, Controller& hand) {
  hand.send(take_at(top));
  hand.send(lead_to(top + lift));
  step(session, 20);
  hand.send({.kind = Kind::edit, .body_edit = std::make_shared<const Edit>(RemoveTets{{10, 11}})});
  step(session, 20);
}

void pull_otherwise(Session<float>& session, Controller& hand) {
  hand.send(take_at(top));
  hand.send(lead_to(top - lift));
  step(session, 30);
}

}  // namespace

TEST_CASE("another session goes on from a saved one to the same bits, and its record is replayed") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "saved.lobe";
  const Setup setup = block();
  Session<float> first(setup), second(setup);
  Controller a = first.connect("a"), b = second.connect("b");
  pull_and_cut(first, a);
  first.save(file);
  const std::uint64_t saved = digest(first.world());
  pull_otherwise(second, b);
  second.restore(file);
  CHECK(digest(second.world()) == saved);
  CHECK(second.world().elements().topology.alive_count() == first.world().elements().topology.alive_count());
  CHECK(second.pictures().latest()->time == first.world().time());
  CHECK(second.status()->hands.empty());
  CHECK(times_said(second, "restored", "saved.lobe") == 1);

  step(first, 10);  // what is done after saving is undone by going back there
  first.restore(file);
  Session<float> straight(setup);  // goes on without ever being restored; its hand lets go, as all do then
  Controller c = straight.connect("c");
  pull_and_cut(straight, c);
  c.send(ask(Kind::let_go));
  for (auto [session, hand] : {std::pair(&first, &a), std::pair(&second, &b), std::pair(&straight, &c)})
    pull_otherwise(*session, *hand);
  CHECK(same_bits(first.world(), straight.world()));
  CHECK(same_bits(second.world(), straight.world()));
  CHECK(replays(second, setup));
  CHECK(replays(second, setup, 2));

  b.send(ask(Kind::restart));
  step(second, 3);
  CHECK(second.world().time() == 3 * second.frame());
  CHECK(replays(second, setup));
}

TEST_CASE("a session goes back to before it was saved, as the one that saved it would") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "saved.lobe";
  const Setup setup = block();
  Session<float> first(setup), second(setup);
  Controller a = first.connect("a"), b = second.connect("b");
  pull_and_cut(first, a);
  first.save(file);
  second.restore(file);
  step(second, 10);
  b.send(ask_for(Kind::back, 10 * second.frame()));
  second.step_frame();
  CHECK(second.world().time() <= first.world().time() + 2 * second.frame());
  CHECK(replays(second, setup));
}

TEST_CASE("what is no saved session of the same body is refused, and nothing has changed") {
  const Folder folder;
  const std::filesystem::path file = folder.path / "saved.lobe";
  Session<float> session(block());
  Controller hand = session.connect("a");
  pull_and_cut(session, hand);
  session.save(file);
  step(session, 5);
  const std::uint64_t before = digest(session.world());
  const std::size_t entries = session.recording().commands.size();
  const auto refused = [&](const std::filesystem::path& path) {
    CHECK_THROWS_AS(session.restore(path), InputError);
    CHECK(digest(session.world()) == before);
    CHECK(session.recording().commands.size() == entries);
    CHECK_FALSE(session.status()->hands.empty());  // it still holds
  };
  refused(folder.path / "nothing");
  const std::string bytes = bytes_of(file);
  refused(folder.write("cut_off", bytes.substr(0, bytes.size() / 2)));
  std::string damaged = bytes;
  damaged[damaged.size() / 2] ^= 1;
  refused(folder.write("damaged", damaged));
  write_recording(folder.path / "record", session.recording());
  refused(folder.path / "record");

  Setup other = block();
  other.damping += 1;
  Session<float>(other).save(folder.path / "other");
  refused(folder.path / "other");
  Session<double>(block()).save(folder.path / "double");
  refused(folder.path / "double");

  SavedSession<float> mixed = read_session<float>(file);
  std::vector<RecordedCommand> shorter = mixed.recording.commands.all();
  shorter.pop_back();  // does not lead there
  mixed.recording.commands = CommandLog(shorter);
  write_session(folder.path / "mixed", mixed);
  refused(folder.path / "mixed");
}

#include "control.h"

#include <doctest/doctest.h>

#include "lobe/error.h"

using namespace lobe;
using namespace lobe::view;
using std::chrono::seconds;

namespace {

const Control::Time start = std::chrono::steady_clock::now() + seconds(100);

Control with_pages(int count) {
  Control control(seconds(10));
  for (int page = 1; page <= count; ++page) control.opened(page);
  control.acted(start);
  return control;
}

}  // namespace

TEST_CASE("the first page holds the instruments, and hands them to the one that asked first") {
  Control control = with_pages(3);
  CHECK(control.holder() == 1);
  control.grant();
  CHECK(control.holder() == 1);
  control.ask(3, start);
  control.ask(2, start);
  control.ask(3, start);
  CHECK(control.askers() == std::vector<ClientId>{3, 2});
  control.grant();
  CHECK(control.holder() == 3);
  CHECK(control.has_asked(2));  // it goes on asking the new one
}

TEST_CASE("a holder that holds a tool, or acts, is not robbed; one that does neither is, after its time") {
  Control control = with_pages(2);
  control.settle(false, start + seconds(1000));
  CHECK(control.holder() == 1);  // nobody has asked
  control.ask(2, start + seconds(1000));
  CHECK(control.deadline() == start + seconds(1010));
  control.settle(false, start + seconds(1009));
  CHECK(control.holder() == 1);
  control.settle(true, start + seconds(2000));
  CHECK(control.holder() == 1);
  control.acted(start + seconds(2001));
  control.settle(false, start + seconds(2010));
  CHECK(control.holder() == 1);
  control.settle(false, start + seconds(2011));
  CHECK(control.holder() == 2);
}

TEST_CASE("who is refused does not ask again at once") {
  Control control = with_pages(3);
  control.ask(2, start);
  control.ask(3, start);
  CHECK(control.refuse(start) == std::vector<ClientId>{2, 3});
  CHECK(control.askers().empty());
  CHECK_THROWS_AS(control.ask(2, start + seconds(9)), InputError);
  control.ask(2, start + seconds(10));
  CHECK(control.has_asked(2));
}

TEST_CASE("when the holder leaves: to the one that asks, else to the former holder, else to the last page") {
  Control control = with_pages(4);
  control.ask(2, start);
  control.closed(1);
  CHECK(control.holder() == 2);
  control.ask(3, start);
  control.grant();
  control.closed(3);
  CHECK(control.holder() == 2);  // that had them before
  control.opened(5);
  control.closed(2);
  CHECK(control.holder() == 0);  // of 4 and 5 neither had them
  control.opened(6);
  CHECK(control.holder() == 0);
  control.ask(5, start);
  CHECK(control.holder() == 5);
  control.closed(4);
  control.closed(5);
  CHECK(control.holder() == 6);
  control.closed(6);
  CHECK(control.holder() == 0);
  control.opened(7);
  CHECK(control.holder() == 7);
}

TEST_CASE("a page that asked and left gets nothing") {
  Control control = with_pages(3);
  control.ask(2, start);
  control.closed(2);
  control.grant();
  CHECK(control.holder() == 1);
  control.settle(false, start + seconds(1000));
  CHECK(control.holder() == 1);
}

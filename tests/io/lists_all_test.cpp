#include "lobe/file/lists_all.h"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "lobe/types.h"

using namespace lobe;

namespace {

struct Whole {
  int a = 1;
  double b = 2;
  static constexpr auto fields = std::tuple(&Whole::a, &Whole::b);
};
struct Forgets {
  int a = 1;
  double b = 2;
  static constexpr auto fields = std::tuple(&Forgets::a);
};
struct LeavesOut {
  int a = 1;
  double b = 2;
  static constexpr auto fields = std::tuple(&LeavesOut::a);
};

struct Derived : Whole, LeavesOut {
  Vec3d x;
};
constexpr auto of_bases = std::tuple(&Whole::a, &Whole::b, &LeavesOut::a, &LeavesOut::b);

class Hidden {
 public:
  Hidden() = default;
  static constexpr auto fields() { return std::tuple(&Hidden::a_, &Hidden::b_); }
  static constexpr auto of_a() { return std::tuple(&Hidden::a_); }

 private:
  double a_ = 0;
  char b_ = 0;
};

struct CArray {
  int a[3];
  int b;
};

template <class Value>
struct Between {
  int before;
  Value value;
  double after = 0;
};
template <class... Value>
constexpr bool each_counts_once = (... && (io::member_count<Between<Value>>() == 3));

}  // namespace

template <>
inline constexpr auto io::left_out<LeavesOut> = std::tuple(&LeavesOut::b);

TEST_CASE("a list of fields is refused if it lacks a member") {
  CHECK(io::lists_all<Whole>(Whole::fields));
  CHECK_FALSE(io::lists_all<Forgets>(Forgets::fields));
  CHECK_FALSE(io::lists_all<LeavesOut>(LeavesOut::fields));
  CHECK(io::lists_all<LeavesOut>(std::tuple_cat(LeavesOut::fields, io::left_out<LeavesOut>)));
  CHECK(&io::fields_of<LeavesOut>() == &LeavesOut::fields);
}

TEST_CASE("a list has the members of the base classes too, each of them") {
  const auto own = std::tuple(&Derived::x);
  CHECK(io::lists_all<Derived>(std::tuple_cat(of_bases, own)));
  CHECK(io::lists_all<Derived>(std::tuple_cat(own, of_bases)));
  CHECK_FALSE(io::lists_all<Derived>(of_bases));
  CHECK_FALSE(io::lists_all<Derived>(own));
  CHECK_FALSE(io::lists_all<Derived>(std::tuple_cat(Whole::fields, own)));
  CHECK_FALSE(io::lists_all<Derived>(std::tuple_cat(Whole::fields, LeavesOut::fields, own)));
}

TEST_CASE("a class with private members must be filled by its fields") {
  CHECK(io::lists_all<Hidden>(Hidden::fields()));
  CHECK_FALSE(io::lists_all<Hidden>(Hidden::of_a()));
}

TEST_CASE("a member counts once whatever its type, but an item of a C array like a member") {
  CHECK(each_counts_once<bool, Vec3d, Eigen::Quaterniond, Eigen::MatrixXd, Whole, Hidden, Derived>);
  CHECK(each_counts_once<std::array<bool, 3>, std::array<Whole, 3>, std::vector<int>, std::map<int, int>>);
  CHECK(each_counts_once<std::string, std::filesystem::path, std::function<void(int)>>);
  CHECK(each_counts_once<std::variant<int, Whole>, std::shared_ptr<const int>, std::unique_ptr<int>>);
  CHECK(each_counts_once<std::optional<int>, std::optional<Vec3d>, std::optional<std::vector<Whole>>>);
  CHECK(io::member_count<CArray>() == 4);
  CHECK_FALSE(io::lists_all<CArray>(std::tuple(&CArray::a, &CArray::b)));
}

// What checkpoints, recordings and saved sessions hold, beside the number of their format. If a field of a
// struct in them changes, the format needs a new number, or old files would be read as something else.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include "folder.h"
#include "lobe/file/fields.h"
#include "lobe/file/scanner.h"
#include "lobe/live/timeline.h"
#include "lobe/run/recording.h"
#include "lobe/sim/checkpoint.h"
#include "lobe/sim/enum_sizes.h"
#include "support.h"

using namespace lobe;
using namespace lobe::test;

namespace {

template <class T>
std::string layout();

template <class Variant>
std::string layout_of_choices() {
  return []<std::size_t... i>(std::index_sequence<i...>) {
    return (std::string("<") + ... + (layout<std::variant_alternative_t<i, Variant>>() + "|")) + ">";
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>());
}

template <class Class, class Member>
Member member_type(Member Class::*);  // not defined

// What io::put() writes of a type, in words.
template <class T>
std::string layout() {
  if constexpr (std::is_same_v<T, CommandLog>) {  // packed by itself
    return layout<CommandLog::Saved>() + layout<std::variant<Command, GoBack>>();
  } else if constexpr (io::Fielded<T>) {
    return std::apply(
        [](auto... member) {
          return (std::string("{") + ... + (layout<decltype(member_type(member))>() + ",")) + "}";
        },
        T::fields);
  } else if constexpr (std::is_enum_v<T>) {
    return "enum" + std::to_string(sizeof(T)) + "/" + std::to_string(io::enum_size<T>);
  } else if constexpr (std::is_arithmetic_v<T>) {
    return (std::is_same_v<T, bool>       ? "bool"
            : std::is_floating_point_v<T> ? "real"
                                          : "int") +
           std::to_string(sizeof(T));
  } else if constexpr (io::Converted<T>) {
    return layout<std::remove_cvref_t<decltype(std::declval<const T&>().as_saved())>>();
  } else if constexpr (io::Dense<T>) {
    return "matrix" + std::to_string(T::RowsAtCompileTime) + "x" + std::to_string(T::ColsAtCompileTime) +
           layout<typename T::Scalar>();
  } else if constexpr (io::is_vector<T> || std::is_same_v<T, std::string>) {
    return "[" + layout<typename T::value_type>() + "]";
  } else if constexpr (io::is_array<T>) {
    return std::to_string(std::tuple_size_v<T>) + "*" + layout<typename T::value_type>();
  } else if constexpr (io::is_variant<T>) {
    return layout_of_choices<T>();
  } else if constexpr (io::is_optional<T>) {
    return "?" + layout<typename T::value_type>();
  } else {
    return "?" + layout<std::remove_const_t<typename T::element_type>>();
  }
}

// The number that a file of lobe has after the eight letters of its format's name.
std::uint32_t format_number(const std::filesystem::path& file) {
  const std::string bytes = io::read_file(file);
  std::uint32_t number = 0;
  REQUIRE(bytes.size() > 12);
  std::memcpy(&number, bytes.data() + 8, sizeof number);
  return number;
}

struct Known {
  std::uint32_t format;
  std::uint64_t layout;  // its digest
};

template <class T>
void check(const std::filesystem::path& file, const Known& known) {
  INFO("if the layout has changed, give the format its next number, then write both here");
  CHECK(format_number(file) == known.format);
  CHECK(io::digest(layout<T>()) == known.layout);
}

}  // namespace

TEST_CASE("a layout says what io::put() writes") {
  CHECK(layout<Advance>() != layout<RemoveTets>());
  CHECK(layout<std::vector<Index>>() == "[int4]");
  CHECK(layout<std::optional<Vec3d>>() == "?matrix3x1real8");
  CHECK(layout<std::array<bool, 3>>() == "3*bool1");
  CHECK(layout<Spring>() == "{int4,real8,matrix3x1real8,}");
}

TEST_CASE("a file of another layout has another format number") {
  const Folder folder;
  const auto file = folder.path / "file";
  World<float> world(setup_of(irregular_box(2)));
  write_checkpoint(file, world.save());
  check<Checkpoint<float>>(file, {32, 13001362121170453768u});
  write_recording(file, {});
  check<Recording>(file, {19, 9774613966117998006u});
  write_session(file, SavedSession<float>{world.save(), {}});
  check<SavedSession<float>>(file, {15, 17586966544185205867u});
}

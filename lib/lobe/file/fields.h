// Structs that list their fields once, `static constexpr auto fields = std::tuple(&A::x, &A::y)`, are
// written, read back and given a digest by these functions. A list that lacks a member does not compile
// (lists_all.h), unless `left_out` has the member. After reading, is_valid() is called if a struct has it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <tuple>
#include <variant>

#include "lobe/file/lists_all.h"
#include "lobe/file/sealed_file.h"

namespace lobe::io {

template <class T>
concept Fielded = requires {
  T::fields;
};
template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept Dense = std::is_base_of_v<Eigen::MatrixBase<T>, T>;
// A class that is stored as another type: as_saved() converts to it, from_saved() converts back.
template <class T>
concept Converted = requires(const T& x) {
  T::from_saved(x.as_saved());
};

template <class E>
inline constexpr int enum_size = 0;  // number of values of an enumeration that is read back

template <class>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;
template <class>
inline constexpr bool is_array = false;
template <class T, std::size_t n>
inline constexpr bool is_array<std::array<T, n>> = true;
template <class>
inline constexpr bool is_variant = false;
template <class... T>
inline constexpr bool is_variant<std::variant<T...>> = true;
template <class>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class>
inline constexpr bool is_shared = false;
template <class T>
inline constexpr bool is_shared<std::shared_ptr<const T>> = true;

template <class T>
void put(ByteWriter& out, const T& x) {
  if constexpr (Fielded<T>) {
    std::apply([&](auto... member) { (put(out, x.*member), ...); }, fields_of<T>());
  } else if constexpr (Plain<T>) {
    out.put(x);
  } else if constexpr (Converted<T>) {
    put(out, x.as_saved());
  } else if constexpr (Dense<T>) {
    if constexpr (T::SizeAtCompileTime == Eigen::Dynamic) out.put(std::uint64_t(x.cols()));
    for (Eigen::Index i = 0; i < x.size(); ++i) out.put(x.data()[i]);
  } else if constexpr (is_vector<T> || std::is_same_v<T, std::string>) {
    out.put(std::uint64_t(x.size()));
    for (const auto& item : x) put(out, item);
  } else if constexpr (is_array<T>) {
    for (const auto& item : x) put(out, item);
  } else if constexpr (is_variant<T>) {
    out.put(std::uint8_t(x.index()));
    std::visit([&](const auto& held) { put(out, held); }, x);
  } else {
    static_assert(is_shared<T> || is_optional<T>);
    out.put(std::uint8_t(bool(x)));
    if (x) put(out, *x);
  }
}

template <class T>
void get(ByteReader& in, T& x);

template <class T>
void get_variant(ByteReader& in, T& x) {
  const int index = in.get_choice(int(std::variant_size_v<T>));
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (void)((index == int(i) ? (get(in, x.template emplace<i>()), true) : false) || ...);
  }
  (std::make_index_sequence<std::variant_size_v<T>>());
}

template <class T>
void get_dense(ByteReader& in, T& x) {
  if constexpr (T::SizeAtCompileTime == Eigen::Dynamic) {
    constexpr auto rows = std::size_t(T::RowsAtCompileTime);
    x.resize(Eigen::Index(rows), Eigen::Index(in.get_count(rows * sizeof(typename T::Scalar))));
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = in.get<typename T::Scalar>();
}

template <class T>
void get(ByteReader& in, T& x) {
  if constexpr (Fielded<T>) {
    std::apply([&](auto... member) { (get(in, x.*member), ...); }, fields_of<T>());
    if constexpr (requires { x.is_valid(); }) in.expect(x.is_valid());
  } else if constexpr (std::is_same_v<T, bool>) {
    x = in.get_choice(2) == 1;
  } else if constexpr (std::is_enum_v<T>) {
    static_assert(enum_size<T> > 0 && sizeof(T) == 1);
    x = T(in.get_choice(enum_size<T>));
  } else if constexpr (Plain<T>) {
    x = in.get<T>();
  } else if constexpr (Converted<T>) {
    auto saved = x.as_saved();
    get(in, saved);
    x = T::from_saved(saved);
  } else if constexpr (Dense<T>) {
    get_dense(in, x);
  } else if constexpr (is_vector<T> || std::is_same_v<T, std::string>) {
    x.resize(in.get_count(Plain<typename T::value_type> ? sizeof(typename T::value_type) : 1));
    for (auto& item : x) get(in, item);
  } else if constexpr (is_array<T>) {
    for (auto& item : x) get(in, item);
  } else if constexpr (is_variant<T>) {
    get_variant(in, x);
  } else if constexpr (is_optional<T>) {
    x.reset();
    if (in.get_choice(2) == 1) get(in, x.emplace());
  } else {
    static_assert(is_shared<T>);
    std::remove_const_t<typename T::element_type> value;
    if (in.get_choice(2) == 0) return x.reset();
    get(in, value);
    x = std::make_shared<typename T::element_type>(std::move(value));
  }
}

// About how much memory it takes with what it owns, without what it shares with others [bytes].
template <class T>
std::size_t memory_of(const T& x) {
  std::size_t bytes = sizeof(T);
  if constexpr (Fielded<T>) {
    std::apply([&](auto... member) { ((bytes += memory_of(x.*member) - sizeof(x.*member)), ...); },
               fields_of<T>());
  } else if constexpr (requires { x.unshared_bytes(); }) {
    bytes += x.unshared_bytes();
  } else if constexpr (Converted<T>) {
    bytes += memory_of(x.as_saved());
  } else if constexpr (Dense<T>) {
    if constexpr (T::SizeAtCompileTime == Eigen::Dynamic) bytes += std::size_t(x.size()) * sizeof(*x.data());
  } else if constexpr (is_vector<T> || std::is_same_v<T, std::string>) {
    if constexpr (Plain<typename T::value_type>) return bytes + x.size() * sizeof(typename T::value_type);
    for (const auto& item : x) bytes += memory_of(item);
  } else if constexpr (is_variant<T>) {
    std::visit([&](const auto& held) { bytes += memory_of(held) - sizeof(held); }, x);
  }
  return bytes;
}

template <class T>
std::uint64_t digest_of_fields(const T& x) {
  ByteWriter out;
  put(out, x);
  return digest(out.bytes());
}

}  // namespace lobe::io

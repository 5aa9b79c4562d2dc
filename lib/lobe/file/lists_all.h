// fields_of() refuses a struct whose list of fields (fields.h) lacks a member. The compiler counts the
// members of an aggregate: it is the largest n for which T{x₁, …, xₙ} is well-formed, where each x converts
// to anything. A member counts once whatever its type: std::array, Eigen's vectors and nested structs are one
// value each. A base class counts as one member too, and the list must have its members as well.
//
// Not counted are C arrays, which would count once per item (the assertion then fails: use std::array), and
// classes with private members, which are no aggregates. The fields of such a class, laid out one after the
// other, must fill it. A forgotten member that fits into the padding between them is not seen.
#pragma once

#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>

namespace lobe::io {

template <class Whole>
struct Anything {
  template <class T>
  requires(!std::is_same_v<T, Whole>) operator T() const;  // never defined
};
template <class T, class... Value>
concept MadeFrom = requires {
  T{std::declval<Value>()...};
};

// Members and direct bases of an aggregate. std::nullopt stands for an optional, which can be made from
// Anything in two ways.
template <class T, class... Value>
constexpr std::size_t member_count() {
  if constexpr (MadeFrom<T, Value..., std::nullopt_t>)
    return member_count<T, Value..., std::nullopt_t>();
  else if constexpr (MadeFrom<T, Value..., Anything<T>>)
    return member_count<T, Value..., Anything<T>>();
  else
    return sizeof...(Value);
}

template <class Class, class Value>
Class class_of(Value Class::*);  // not defined
template <class Class, class Value>
Value value_of(Value Class::*);  // not defined

template <class Class, class... Pointer>
constexpr std::size_t own_fields = (std::size_t(0) + ... +
                                    std::size_t(std::is_same_v<decltype(class_of(Pointer())), Class>));

// One after the other, as a class of this alignment has them.
template <class... Pointer>
constexpr std::size_t size_of_fields(std::size_t alignment) {
  std::size_t end = 0;
  const auto add = [&](std::size_t size, std::size_t multiple) {
    end = (end + multiple - 1) / multiple * multiple + size;
  };
  (add(sizeof(value_of(Pointer())), alignof(decltype(value_of(Pointer())))), ...);
  add(0, alignment);
  return end;
}

template <class T, class... Pointer>
constexpr bool lists_all(std::tuple<Pointer...>) {
  if constexpr (!std::is_aggregate_v<T>) {
    return sizeof(T) == size_of_fields<Pointer...>(alignof(T));
  } else {
    // Of each field's class, whether all members are listed. A base class has no bases of its own.
    constexpr auto is_whole = []<class Class>() {
      return own_fields<Class, Pointer...> == member_count<Class>();
    };
    std::size_t bases = 0, of_base = 0;  // of_base: fields of the base class that the list goes through
    const auto visit = [&]<class Class>() {
      if (std::is_same_v<Class, T>) return;
      bases += of_base == 0;
      of_base = (of_base + 1) % own_fields<Class, Pointer...>;
    };
    (visit.template operator()<decltype(class_of(Pointer()))>(), ...);
    return own_fields<T, Pointer...> + bases == member_count<T>() &&
           (... && (std::is_same_v<decltype(class_of(Pointer())), T> ||
                    is_whole.template operator()<decltype(class_of(Pointer()))>()));
  }
}

template <class T>
inline constexpr auto left_out = std::tuple();  // members that are not in T::fields on purpose

// T::fields, once it has been found complete.
template <class T>
constexpr const auto& fields_of() {
  static_assert(lists_all<T>(std::tuple_cat(T::fields, left_out<T>)),
                "a member is not in the list of fields");
  return T::fields;
}

}  // namespace lobe::io

// Rows of the tables of keys that the structs of a scene have in JSON.
//
// A row says a key, its member, what values it takes, and in a sentence what it means. The default is that of
// the struct. Reader and writer follow the rows; scene.schema.json and the tables of docs/scene.md are
// compared with them by tests/scene/key_table_test.cpp, which writes the former.
#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <limits>
#include <tuple>
#include <type_traits>
#include <variant>

#include "lobe/types.h"

namespace lobe::keys {

// What a key takes: a range of numbers, their unit, and whether the key must be there.
struct Takes {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool is_above = false, is_below = false;  // without the limit itself
  const char* unit = "";
  const char* schema = "";      // as JSON, where neither type nor range says it
  const char* type = "";        // in words, where the type of the member does not say it
  std::size_t least_items = 0;  // of a list
  bool is_one_or_list = false;  // a list, or one item of it by itself
  bool is_or_false = false;     // a number, or false in place of 0
  bool is_required = false;
  bool has_default = true;  // that of the struct; else something depends on whether the key is there
  bool is_quiet = false;    // not written where it has its default

  template <class Value>
  constexpr Takes with(Value Takes::*member, Value value) const {
    Takes changed = *this;
    changed.*member = value;
    return changed;
  }
  constexpr Takes up_to(double limit) const { return with(&Takes::most, limit); }
  constexpr Takes below(double limit) const { return up_to(limit).with(&Takes::is_below, true); }
  constexpr Takes in(const char* symbol) const { return with(&Takes::unit, symbol); }
  constexpr Takes items(std::size_t count) const { return with(&Takes::least_items, count); }
  constexpr Takes or_one() const { return with(&Takes::is_one_or_list, true); }
  constexpr Takes or_false() const { return with(&Takes::is_or_false, true); }
  constexpr Takes required() const { return with(&Takes::is_required, true); }
  constexpr Takes quiet() const { return with(&Takes::is_quiet, true); }
  constexpr Takes derived() const { return with(&Takes::has_default, false); }
  constexpr Takes optional() const { return derived().quiet(); }
  constexpr Takes as(const char* json, const char* words) const {
    return with(&Takes::schema, json).with(&Takes::type, words);
  }
};
inline constexpr Takes any{};
constexpr Takes at_least(double limit) { return {.least = limit}; }
constexpr Takes above(double limit) { return {.least = limit, .is_above = true}; }
inline constexpr double most_index = std::numeric_limits<Index>::max();
inline constexpr Takes index = at_least(0).up_to(most_index);

template <class Member>  // pointer to a member, or a function that finds one
struct Key {
  const char* key;
  Member member;
  Takes takes;
  const char* sentence;
  constexpr Key(const char* k, Member m, Takes t, const char* s) : key(k), member(m), takes(t), sentence(s) {}
};

// ---- What else a row may have for a member. Reading calls it with a struct that changes, for what is set;
// writing with one that does not, for a pointer: null where the struct has something else.

// A member of a member.
template <class Struct, class Part, class Value>
struct In {
  Part Struct::*part;
  Value Part::*member;
  constexpr In(Part Struct::*p, Value Part::*m) : part(p), member(m) {}
  Value& operator()(Struct& whole) const { return whole.*part.*member; }
  const Value& operator()(const Struct& whole) const { return whole.*part.*member; }
};
// A member that means something where another one has a certain value, which reading sets.
template <class Struct, class Tag, class Value>
struct Case {
  Tag Struct::*tag;
  Tag required;
  Value Struct::*member;
  constexpr Case(Tag Struct::*t, Tag r, Value Struct::*m) : tag(t), required(r), member(m) {}
  Value& operator()(Struct& whole) const {
    whole.*tag = required;
    return whole.*member;
  }
  const Value* operator()(const Struct& whole) const {
    return whole.*tag == required ? &(whole.*member) : nullptr;
  }
};
// One of the types that a member may have, or the whole (std::identity); or a member of that type.
template <class Part, class What>
struct Alternative {
  What what;
  template <class Struct>
  Part& operator()(Struct& whole) const {
    return std::invoke(what, whole).template emplace<Part>();
  }
  template <class Struct>
  const Part* operator()(const Struct& whole) const {
    return std::get_if<Part>(&std::invoke(what, whole));
  }
};
template <class Part, class What>
constexpr auto alternative(What what) {
  return Alternative<Part, What>{what};
}
template <class What, class Part, class Value>
struct PartOfAlternative {
  Alternative<Part, What> part;
  Value Part::*member;
  template <class Struct>
  Value& operator()(Struct& whole) const {
    return part(whole).*member;
  }
  template <class Struct>
  const Value* operator()(const Struct& whole) const {
    const Part* found = part(whole);
    return found ? &(found->*member) : nullptr;
  }
};
template <class What, class Part, class Value>
constexpr auto alternative(What what, Value Part::*member) {
  return PartOfAlternative<What, Part, Value>{{what}, member};
}
// A member that is written only where a condition holds.
template <class Struct, class Value, class Condition>
struct When {
  Value Struct::*member;
  Condition holds;
  constexpr When(Value Struct::*m, Condition c) : member(m), holds(c) {}
  Value& operator()(Struct& whole) const { return whole.*member; }
  const Value* operator()(const Struct& whole) const { return holds(whole) ? &(whole.*member) : nullptr; }
};
inline constexpr auto never = [](const auto&) { return false; };
struct True {};  // a key that can only be true
inline True is_true;
// The value of a member, said by the key alone.
template <class Struct, class Tag>
struct Says {
  Tag Struct::*tag;
  Tag said;
  constexpr Says(Tag Struct::*t, Tag s) : tag(t), said(s) {}
  True& operator()(Struct& whole) const {
    whole.*tag = said;
    return is_true;
  }
  const True* operator()(const Struct& whole) const { return whole.*tag == said ? &is_true : nullptr; }
};

// What a hook reads, and nothing writes.
template <class Value>
struct NotKept {
  bool is_not_kept = true;
  template <class Struct>
  Value& operator()(Struct&) const;
  template <class Struct>
  const Value* operator()(const Struct&) const {
    return nullptr;
  }
};

template <class Struct, class Member>
using MemberType = std::remove_cvref_t<std::invoke_result_t<Member, Struct&>>;

template <class... Rows>
struct Table {
  const char* definition;  // its name in the schema
  const char* rules;       // what the schema says of keys that go together or are gone, as JSON; or ""
  std::tuple<Rows...> rows;
  constexpr Table(const char* d, const char* r, Rows... all) : definition(d), rules(r), rows(all...) {}
};
// For a member: an object with keys of the same struct, which has a certain value where the object is.
template <class Struct, class Tag, class... Rows>
struct Inner {
  Tag Struct::*tag;
  Tag said;
  Table<Rows...> table;
  constexpr Inner(Tag Struct::*t, Tag s, Table<Rows...> rows) : tag(t), said(s), table(rows) {}
};
struct NoTable {};
template <class Struct>
inline constexpr NoTable table_of{};
template <class Struct>
concept HasKeys = !std::same_as<std::remove_cvref_t<decltype(table_of<Struct>)>, NoTable>;
// The words for the values of an enumeration.
template <class Enum>
inline constexpr std::array<const char*, 0> words_of{};
template <class Enum>
concept HasWords = (words_of<Enum>.size() > 0);

// How a type is read and written that has a form of its own, and its schema.
template <class Value>
struct Form;
template <class Value>
concept HasForm = requires {
  Form<Value>::schema;
};

}  // namespace lobe::keys

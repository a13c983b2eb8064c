#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/numbers.h"

// A column of a table: how a batch's row gives its value, and where a list's row takes it.
namespace uplink::storage {

/// What a column is; each store has its own type for it.
enum class ColumnType : std::uint8_t {
  kBool,
  kInt4,
  kInt8,
  kReal,
  kText,
  kBytes,
  kTime,
  kSession,
  /// An integer: the row's number in the order of writing, over all tables (Entry).
  kEntry,
};

/// A value on its way into a column, or out of one; by the column's type, bytes are a text and
/// numbers of every width one integer. Without a value: NULL. A view must outlive it.
using ColumnValue = std::variant<std::monostate, bool, std::int64_t, double, SystemTime,
                                 model::SessionId, std::string_view, std::string>;

/// Bytes of a column that is no text.
struct Bytes {
  std::string_view view;
};

/// What a row's number is written from: the number itself (SQLite), or the row's place in its
/// batch, from which the database makes the number (PostgreSQL).
struct Entry {
  constexpr Entry() = default;
  // NOLINTBEGIN(google-explicit-constructor): what a store counts is one
  constexpr Entry(std::int32_t place) : number(place) {}
  constexpr Entry(std::uint64_t entry) : number(static_cast<std::int64_t>(entry)) {}
  // NOLINTEND(google-explicit-constructor)

  std::int64_t number = 0;
};

/// Sixteen bytes that name something: a process, a connection.
using IdBytes = std::array<std::uint8_t, model::SessionId::kBytes>;

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// The type of the columns that hold a T, or an optional of it.
template <typename T>
consteval ColumnType ColumnTypeOf() {
  if constexpr (IsOptional<T>()) {
    return ColumnTypeOf<typename T::value_type>();
  } else if constexpr (std::is_same_v<T, bool>) {
    return ColumnType::kBool;
  } else if constexpr (std::is_same_v<T, std::int32_t> || std::is_enum_v<T>) {
    return ColumnType::kInt4;
  } else if constexpr (std::is_integral_v<T>) {
    return ColumnType::kInt8;
  } else if constexpr (std::is_same_v<T, double>) {
    return ColumnType::kReal;
  } else if constexpr (std::is_same_v<T, SystemTime>) {
    return ColumnType::kTime;
  } else if constexpr (std::is_same_v<T, model::SessionId> || std::is_same_v<T, IdBytes>) {
    return ColumnType::kSession;
  } else if constexpr (std::is_same_v<T, Entry>) {
    return ColumnType::kEntry;
  } else if constexpr (std::is_same_v<T, Bytes>) {
    return ColumnType::kBytes;
  } else {
    static_assert(std::is_convertible_v<T, std::string_view>, "no column holds such a value");
    return ColumnType::kText;
  }
}

/// A text that is kept elsewhere becomes a view; one that was made for the column moves.
template <typename T>
[[nodiscard]] ColumnValue ValueOf(T&& value) {
  using Held = std::remove_cvref_t<T>;
  if constexpr (IsOptional<Held>()) {
    if (!value) return {};
    return ValueOf(*std::forward<T>(value));
  } else if constexpr (std::is_same_v<Held, Entry>) {
    return value.number;
  } else if constexpr (std::is_same_v<Held, Bytes>) {
    return value.view;
  } else if constexpr (std::is_same_v<Held, IdBytes>) {
    return model::SessionId(value);
  } else if constexpr (model::WireEnum<Held>) {
    return std::int64_t{NumberOf(value)};
  } else if constexpr (std::is_enum_v<Held> ||
                       (std::is_integral_v<Held> && !std::is_same_v<Held, bool>)) {
    return static_cast<std::int64_t>(value);
  } else if constexpr (std::is_same_v<Held, std::string> && std::is_lvalue_reference_v<T>) {
    return std::string_view(value);
  } else {
    return ColumnValue(std::forward<T>(value));
  }
}

/// NULL leaves a field that is not optional as it was made.
template <typename T>
void Take(const ColumnValue& value, T& field) {
  if (std::holds_alternative<std::monostate>(value)) return;
  if constexpr (IsOptional<T>()) {
    Take(value, field.emplace());
  } else if constexpr (std::is_same_v<T, std::string>) {
    field = std::get<std::string_view>(value);
  } else if constexpr (std::is_same_v<T, IdBytes>) {
    field = std::get<model::SessionId>(value).bytes();
  } else if constexpr (model::WireEnum<T>) {
    field = MemberOf<T>(std::get<std::int64_t>(value));
  } else if constexpr (std::is_enum_v<T>) {
    field = KnownMemberOf<T>(std::get<std::int64_t>(value));
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    // A time that a list's row shows as Unix milliseconds is one as well.
    const auto* const time = std::get_if<SystemTime>(&value);
    field = static_cast<T>(time != nullptr ? UnixMs(*time) : std::get<std::int64_t>(value));
  } else {
    field = std::get<T>(value);
  }
}

/// What an upsert does to a column of a row that is there.
enum class Role : std::uint8_t {
  /// By the key's columns the row is found.
  kKey,
  /// The value is replaced.
  kValue,
  /// What the first insert wrote stays.
  kKept,
};

/// In: what a row is written from. Out: a list's row.
template <typename In, typename Out>
struct Column {
  std::string_view name;
  ColumnType type = ColumnType::kText;
  Role role = Role::kValue;
  ColumnValue (*value)(const In& row) = nullptr;
  /// Not set: lists leave the column out. Not a null pointer: with UBSan, GCC 12 takes no
  /// comparison of a function's address for a constant.
  std::optional<void (*)(const ColumnValue& value, Out& row)> take = std::nullopt;
  /// SQL of an update's value, where it is not the inserted one; the row that is there is `t`.
  std::string_view update = {};
};

/// A column by its functions: Get gives its value in an In, Field points to its member in an Out.
/// Converts to a Column of any such pair; lists leave it out where Field takes no Out.
template <typename Get, typename Field>
class ColumnBy final {
 public:
  explicit constexpr ColumnBy(std::string_view name) : name_(name) {}

  [[nodiscard]] constexpr ColumnBy Key() const { return With(Role::kKey, {}); }
  [[nodiscard]] constexpr ColumnBy Kept() const { return With(Role::kKept, {}); }
  [[nodiscard]] constexpr ColumnBy Updated(std::string_view sql) const {
    return With(Role::kValue, sql);
  }

  template <typename In, typename Out>
  // NOLINTNEXTLINE(google-explicit-constructor): a list of columns is written as their names
  constexpr operator Column<In, Out>() const {
    Column<In, Out> column;
    column.name = name_;
    column.type = ColumnTypeOf<std::remove_cvref_t<std::invoke_result_t<Get, const In&>>>();
    column.role = role_;
    column.value = [](const In& row) { return ValueOf(Get{}(row)); };
    if constexpr (std::is_invocable_v<Field, Out&>) {
      column.take = [](const ColumnValue& value, Out& row) { Take(value, *Field{}(row)); };
    }
    column.update = update_;
    return column;
  }

 private:
  [[nodiscard]] constexpr ColumnBy With(Role role, std::string_view update) const {
    ColumnBy made = *this;
    made.role_ = role;
    made.update_ = update;
    return made;
  }

  std::string_view name_;
  Role role_ = Role::kValue;
  std::string_view update_;
};

/// Of a column that no list reads.
struct NoField {};

/// Written as `get` says, and read to where `field` points.
template <typename Get, typename Field = NoField>
constexpr ColumnBy<Get, Field> Col(std::string_view name, Get /*get*/, Field /*field*/ = {}) {
  return ColumnBy<Get, Field>(name);
}

/// Read into a member of a list's row.
template <auto kMember, typename Get>
constexpr auto Col(std::string_view name, Get get) {
  return Col(name, get, [](auto& row) { return &(row.*kMember); });
}

/// What a row reports: where rows of batches and of lists have fields of the same names.
template <typename Row>
constexpr auto& BodyOf(Row& row) {
  if constexpr (requires { *row.body; }) {
    return *row.body;
  } else {
    return row;
  }
}

/// A field that both rows' bodies have: `field` points to it in either.
template <typename Field>
constexpr auto Same(std::string_view name, Field /*field*/) {
  constexpr auto kField = [](auto& row) { return Field{}(BodyOf(row)); };
  constexpr auto kGet = [](const auto& row) -> auto& { return *Field{}(BodyOf(row)); };
  return Col(name, kGet, kField);
}

/// A member of the type that both rows' bodies are.
template <auto kMember>
constexpr auto Same(std::string_view name) {
  return Same(name, [](auto& body) { return &(body.*kMember); });
}

/// The robot that a row of a batch is of.
template <typename Row>
constexpr const model::RobotId& RobotOf(const Row& row) {
  if constexpr (requires { row.record; }) {
    return *row.record->robot;
  } else if constexpr (requires { row.item; }) {
    return *row.item->robot;
  } else {
    return *row.last.record->robot;
  }
}

// Columns of many tables.
inline constexpr auto kRobotRuri = Col(
    "ruri", [](const auto& row) -> auto& { return RobotOf(row).ruri; });
inline constexpr auto kRobotFleet = Col(
    "fleet", [](const auto& row) -> auto& { return RobotOf(row).fleet; });
inline constexpr auto kRowEntry = Col("entry", [](const auto& row) { return row.entry; });
template <auto kMember>
inline constexpr auto kArrival = Col<kMember>("received_at", [](const auto& row) {
  return row.record->received_at;
});

}  // namespace uplink::storage

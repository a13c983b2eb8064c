#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "schema/rules/numbers.h"
#include "schema/rules/path.h"
#include "schema/rules/violations.h"

namespace uplink::cyberwave {

/// What a violation in a member does.
enum class Need : std::uint8_t {
  /// The message cannot go without it: it is rejected, of whatever class it is.
  kMust,
  /// A violation of content: a durable message is rejected, a live one goes without the member.
  kMay,
};

/// The members of one JSON object by name; a null is as absent as what is not there. Each read
/// returns the value fit to keep, or nothing after reporting the violation. Confined to one
/// judgement; object, path and violations outlive it.
class Reader final {
 public:
  Reader(const boost::json::object& object, const schema::Path& path,
         schema::Violations& violations)
      : object_(object), path_(path), violations_(violations) {}

  [[nodiscard]] const boost::json::object& object() const { return object_; }
  [[nodiscard]] const schema::Path& path() const { return path_; }
  [[nodiscard]] schema::Violations& violations() { return violations_; }

  /// Null if it is absent.
  [[nodiscard]] const boost::json::value* Find(std::string_view name) const;
  /// Null if it is absent, which is reported if it must not be, or no object.
  [[nodiscard]] const boost::json::object* Object(std::string_view name, Need need);
  /// Null if it is absent or no list.
  [[nodiscard]] const boost::json::array* List(std::string_view name, Need need);

  /// A finite number.
  [[nodiscard]] std::optional<double> Number(std::string_view name, Need need = Need::kMay);
  [[nodiscard]] std::optional<double> NumberIn(std::string_view name, schema::Bounds bounds,
                                               Need need = Need::kMay);
  [[nodiscard]] std::optional<double> NotNegative(std::string_view name);
  /// 0 to 100; noise just beyond is clamped.
  [[nodiscard]] std::optional<double> Percent(std::string_view name);
  /// A whole number from 0 to 2^53; 78.0 is whole.
  [[nodiscard]] std::optional<std::uint64_t> Count(std::string_view name);
  [[nodiscard]] std::optional<bool> Flag(std::string_view name);
  /// Empty if it is absent or invalid; with kMust it is neither.
  [[nodiscard]] std::string Text(std::string_view name, std::size_t bytes_max,
                                 Need need = Need::kMay);
  /// A time in Unix seconds as microseconds; 0 if it is absent or absurd. Never a violation: what
  /// is absurd is counted.
  [[nodiscard]] std::int64_t TimeUs(std::string_view name);

  /// Reports that a member is missing, `what` saying how.
  void Missing(std::string_view name, Need need, std::string_view what = "is missing");

 private:
  void Report(Need need, const schema::Violation& violation);
  void ReportType(std::string_view name, Need need, const boost::json::value& value,
                  std::string_view expected);
  [[nodiscard]] const boost::json::value* Wanted(std::string_view name, Need need);

  const boost::json::object& object_;
  const schema::Path& path_;
  schema::Violations& violations_;
};

/// A percentage fit to keep, as Reader::Percent.
[[nodiscard]] std::optional<double> PercentOf(schema::Violations& violations,
                                              const schema::Path& path, double value);

/// A time in Unix seconds as Reader::TimeUs.
[[nodiscard]] std::int64_t TimeUsOf(schema::Violations& violations, double seconds);

/// The finite number in `value`, or nothing after reporting a violation of content.
[[nodiscard]] std::optional<double> NumberOf(schema::Violations& violations,
                                             const schema::Path& path,
                                             const boost::json::value& value);

/// A key of boost::json, and back.
[[nodiscard]] inline boost::json::string_view ToBoost(std::string_view text) {
  return {text.data(), text.size()};
}
[[nodiscard]] inline std::string_view FromBoost(boost::json::string_view text) {
  return {text.data(), text.size()};
}

}  // namespace uplink::cyberwave

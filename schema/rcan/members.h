#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "schema/rules/path.h"
#include "schema/rules/violations.h"

namespace uplink::schema {

/// What a violation in a member does.
enum class Need : std::uint8_t {
  /// The member must be there and good: the message is rejected.
  kMust,
  /// The member is dropped.
  kMay,
};

struct WholeBounds {
  std::int64_t min = 0;
  std::int64_t max = INT64_MAX;
};

/// The members of one JSON object by name; each read returns the value fit to keep, or reports the
/// violation. Confined to one judgement; object, path and violations outlive it.
class Members final {
 public:
  Members(const boost::json::object& object, const Path& path, Violations& violations)
      : object_(object), path_(path), violations_(violations) {}

  /// A finite number. One that is beyond a double rejects the message in any case.
  [[nodiscard]] std::optional<double> Number(std::string_view name, Need need);
  [[nodiscard]] std::optional<double> NumberFrom(std::string_view name, double min);
  /// 78.0 is whole, 78.5 is not.
  [[nodiscard]] std::optional<std::int64_t> Whole(std::string_view name, Need need,
                                                  WholeBounds bounds);
  /// From 0 to 2^64-1.
  [[nodiscard]] std::optional<std::uint64_t> Bits(std::string_view name);
  [[nodiscard]] std::optional<std::string> Text(std::string_view name, Need need,
                                                std::size_t bytes_max);
  /// A string as it was sent, by no rule of texts.
  [[nodiscard]] std::optional<std::string_view> String(std::string_view name, Need need);

  /// Whether there is a member that only this object cannot go without; reported as content if not.
  [[nodiscard]] bool Has(std::string_view name);
  /// Null if it is not there, and reported if it must be.
  [[nodiscard]] const boost::json::value* Find(std::string_view name, Need need);
  void Report(Need need, const Violation& violation);
  void ReportType(Need need, std::string_view name, const boost::json::value& value,
                  std::string_view expected);

 private:
  const boost::json::object& object_;
  const Path& path_;
  Violations& violations_;
};

}  // namespace uplink::schema

#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>

#include "tools/uplink-fleet/compare/findings.h"

namespace uplink::synthetic {

inline constexpr std::uint64_t kAnyTimes = std::numeric_limits<std::uint64_t>::max();

/// How often a row must be there, and may be. A value.
struct Times {
  std::uint64_t min = 1;
  std::uint64_t max = 1;
};

/// A row that must be there. A value.
struct ExpectedRow {
  /// A hash of all that it must say; 0: that is not known.
  std::uint64_t content = 0;
  /// For people.
  std::string shown;
  Times times;
};

/// Rows of one thing that must be there, each by its key, against those that the server shows:
/// finds what is missing, doubled, different or unexpected.
///
/// Thread: confined to one comparison; `findings` outlives it.
class RowSet final {
 public:
  RowSet(Thing thing, std::string ruri, Findings& findings);

  /// Of one key as many times more as is asked.
  void Expect(const std::string& key, ExpectedRow row);
  /// A row that the server shows; true for the first one of a key that is expected.
  bool Find(const std::string& key, std::uint64_t content,
            const std::function<std::string()>& shown);
  /// All has been found that there is. No more than `dropped` rows may be missing, if any is: those
  /// went for a bound of the server.
  void Finish(std::uint64_t dropped = 0);

  [[nodiscard]] bool Expects(const std::string& key) const { return rows_.contains(key); }
  [[nodiscard]] bool Found(const std::string& key) const;

 private:
  struct Row {
    ExpectedRow expected;
    std::uint64_t found = 0;
  };

  const Thing thing_;
  const std::string ruri_;
  Findings& findings_;
  std::map<std::string, Row> rows_;
};

}  // namespace uplink::synthetic

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace uplink::identity {

/// Fleets of one scope.
inline constexpr std::size_t kScopeFleetsMax = 32;

/// The fleets that a caller may see: all, or those that it names. A value.
class Scope final {
 public:
  /// Of all fleets.
  [[nodiscard]] static Scope All() { return Scope({}, true); }
  /// Of these alone; none of them is kAllFleets. None: it may see nothing.
  [[nodiscard]] static Scope Of(std::vector<std::string> fleets);

  [[nodiscard]] bool all() const { return all_; }
  [[nodiscard]] bool Has(std::string_view fleet) const;
  /// Ascending, each once; empty if it is all.
  [[nodiscard]] const std::vector<std::string>& fleets() const { return fleets_; }

  /// The fleets that a question may look at which asks for `fleet`, or for all where that is empty.
  /// Empty: all. A fleet out of scope becomes kAllFleets, which no fleet is called, so that the
  /// answer is that for an unknown one.
  [[nodiscard]] std::vector<std::string> Restrict(const std::string& fleet) const;

  friend bool operator==(const Scope&, const Scope&) = default;

 private:
  Scope(std::vector<std::string> fleets, bool all) : fleets_(std::move(fleets)), all_(all) {}

  std::vector<std::string> fleets_;
  bool all_;
};

}  // namespace uplink::identity

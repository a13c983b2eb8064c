#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/base/clock.h"
#include "storage/reader.h"

namespace uplink::http {

/// Parameters of one request that differ in name; more are an error. One that may stand there
/// several times may do so kRepeatsMax times.
inline constexpr std::size_t kParametersMax = 16;
inline constexpr std::size_t kRepeatsMax = storage::kRurisMax;

/// What is wrong with a query: `field` is the parameter's name. A value.
struct BadParameter {
  std::string field;
  std::string message;
};

/// The query of a request, read parameter by parameter. It remembers the first mistake, which
/// Problem tells; readers get the default for a wrong value. An empty value is wrong: an
/// empty filter would show everything to a client that meant one fleet. What is read is what the
/// path takes: an answer to an unknown or empty parameter lists it. Confined to one thread.
class Parameters final {
 public:
  explicit Parameters(std::string_view query);

  /// Empty if absent.
  [[nodiscard]] std::string Text(std::string_view name);
  /// A text that may be given empty, as `pageToken` of the first page.
  [[nodiscard]] std::string TextOrEmpty(std::string_view name);
  /// `true` or `false`; false if absent.
  [[nodiscard]] bool Flag(std::string_view name);
  /// Empty if absent.
  [[nodiscard]] std::optional<bool> MaybeFlag(std::string_view name);
  /// As many finite numbers between commas; empty if absent.
  [[nodiscard]] std::vector<double> Decimals(std::string_view name, std::size_t count);
  /// From 1 to `max`; `absent` if it is not given.
  [[nodiscard]] std::uint32_t Number(std::string_view name, std::uint32_t absent,
                                     std::uint32_t max);
  /// As RFC 3339 writes it.
  [[nodiscard]] std::optional<SystemTime> Time(std::string_view name);
  /// All values of a parameter that may stand there several times; none if absent.
  [[nodiscard]] std::vector<std::string> Texts(std::string_view name);
  /// Words between commas, without empty ones; none if absent.
  [[nodiscard]] std::vector<std::string> Words(std::string_view name);

  /// The handler found the value of `name` wrong.
  void Reject(std::string_view name, std::string message);

  /// Call after all reads: the first problem, or a parameter that nothing read.
  [[nodiscard]] std::optional<BadParameter> Problem();

 private:
  struct Item {
    std::string name;
    std::string value;
    bool read = false;
  };
  void AddItem(std::string_view item);
  /// Null if absent; standing there twice is a problem.
  [[nodiscard]] const std::string* Find(std::string_view name);
  /// An unknown or empty parameter.
  void RejectUse(std::string_view name, std::string message);
  /// Null if absent or empty, which is a problem.
  [[nodiscard]] const std::string* FindSome(std::string_view name);

  std::vector<Item> items_;
  /// How many different ones.
  std::size_t names_ = 0;
  /// What the path takes: the names that were read.
  std::vector<std::string> taken_;
  std::optional<BadParameter> problem_;
  /// The problem's message is to go on with what the path takes.
  bool lists_taken_ = false;
};

/// `pageSize` of every list.
[[nodiscard]] std::uint32_t ReadPageSize(Parameters& parameters);

}  // namespace uplink::http

#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>
#include <boost/json.hpp>

#include "tools/link/http_client.h"

namespace uplink::ctl {

/// The parameters of a request, in their order.
using Query = std::vector<std::pair<std::string, std::string>>;

/// `/api/v1/events?kind=a%20b`.
[[nodiscard]] std::string PathWith(const std::string& path, const Query& query);

/// Rows of a list, perhaps of several pages. A value.
struct Rows {
  boost::json::array rows;
  /// There are further ones.
  bool more = false;
  /// The last page without its rows: `total`, `droppedByReason`.
  boost::json::object beside;
};

/// Rows of one page; the server's own bound.
inline constexpr std::size_t kPageRowsMax = 1000;

/// How often a command is sent to a server that says it comes too fast.
inline constexpr int kCommandTriesMax = 30;
/// The longest that is waited before the next time. A server that asks for more is believed.
inline constexpr std::chrono::seconds kRetryAfterMax{5};

/// Questions and commands to a server's API.
///
/// Errors: kInvalidArgument for a question that the server refuses, kNotFound, kUnauthenticated
/// (401,
///         or its certificate is not believed), kPermissionDenied (403), kResourceExhausted (409,
///         429), kUnavailable if it cannot be reached or says 503, kInternal otherwise. Each says
///         what to try.
/// Thread: confined to one thread; blocks.
class Api final {
 public:
  /// How the server is reached.
  using Ask = std::function<absl::StatusOr<link::HttpAnswer>(const std::string& target)>;
  /// The same of a command with this body.
  using Send = std::function<absl::StatusOr<link::HttpAnswer>(const std::string& target,
                                                              const std::string& json)>;

  /// Lets time pass before a command is sent again.
  using Wait = std::function<void(std::chrono::seconds time)>;

  /// `prefix` comes before each path; `source` says where the address comes from. Without `wait` no
  /// command is sent again.
  Api(Ask ask, std::string prefix, std::string source, Send send = {}, Wait wait = {})
      : ask_(std::move(ask)),
        send_(std::move(send)),
        wait_(std::move(wait)),
        prefix_(std::move(prefix)),
        source_(std::move(source)) {}

  /// The object that a path answers.
  [[nodiscard]] absl::StatusOr<boost::json::object> Get(const std::string& path,
                                                        const Query& query = {});
  /// What the server answers to a command, which it has done then. One that comes too fast (429) is
  /// sent again after Retry-After, kCommandTriesMax times in all.
  [[nodiscard]] absl::StatusOr<boost::json::object> Post(const std::string& path,
                                                         const boost::json::object& body);
  /// Up to `limit` rows of the list below `member`, over as many pages as they take.
  [[nodiscard]] absl::StatusOr<Rows> List(const std::string& path, const std::string& member,
                                          const Query& query, std::size_t limit);

 private:
  [[nodiscard]] absl::StatusOr<boost::json::object> ObjectOf(
      const std::string& path, absl::StatusOr<link::HttpAnswer> answer) const;
  [[nodiscard]] absl::Status ErrorOf(const std::string& path, const link::HttpAnswer& answer) const;

  Ask ask_;
  Send send_;
  Wait wait_;
  std::string prefix_;
  std::string source_;
};

}  // namespace uplink::ctl

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/link.h"
#include "storage/postgres/store.h"

namespace uplink::storage::postgres {

/// What passes between the two round trips of one transaction, at most: then the server ends it, so
/// that a client whose network was lost in between holds its locks no longer.
inline constexpr milliseconds kBetweenTripsMax{500};

/// A connection of one's own, beside those of the writers: made when it is needed, and made anew
/// after it broke. A resource.
///
/// Errors:  those of Connection; kUnavailable while the server is away, and every call tries again.
/// Thread:  confined to one thread at a time.
class OwnConnection final {
 public:
  /// Does not connect. Of the options: the URL, the password, the timeouts. `clock` must outlive
  /// this. `when_shut_out`: as Link::Options.
  ///
  /// Errors: kInvalidArgument for the URL.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<OwnConnection>> Make(
      const StoreOptions& options, const Clock& clock, bool when_shut_out = false);
  OwnConnection(const OwnConnection&) = delete;
  OwnConnection& operator=(const OwnConnection&) = delete;

  /// The answers to statements of one transaction, durable on the server that gave them.
  [[nodiscard]] absl::StatusOr<std::vector<Result>> Write(std::vector<StoreCall> work,
                                                          std::string_view doing);
  /// The same for one statement.
  [[nodiscard]] absl::StatusOr<Result> Write(StoreCall call, std::string_view doing);
  /// What is written, by what was read.
  using Decide =
      std::function<absl::StatusOr<std::vector<StoreCall>>(const std::vector<Result>& read)>;
  /// Two round trips of one transaction: `read`, then what `decide` makes of the answers, and the
  /// commit. The answers to the second; what `decide` refuses rolls back and is the answer. A
  /// connection that stood before is asked for a sign of life, which may take `most`, and made anew
  /// without one. kBetweenTripsMax bounds what `decide` takes.
  [[nodiscard]] absl::StatusOr<std::vector<Result>> ReadAndWrite(std::vector<StoreCall> read,
                                                                 const Decide& decide,
                                                                 std::string_view doing,
                                                                 milliseconds most);
  /// The answers to statements that change nothing.
  [[nodiscard]] absl::StatusOr<std::vector<Result>> Read(const std::vector<StoreCall>& calls,
                                                         std::string_view doing);
  [[nodiscard]] absl::StatusOr<Result> Read(StoreCall call, std::string_view doing);
  /// The same, asked again over a new connection if that which stood before had died.
  [[nodiscard]] absl::StatusOr<Result> ReadAgain(const StoreCall& call, std::string_view doing);
  /// As Read, within `most` if the connection stood before: then a network that has lost it
  /// without a word costs no more, and the next call makes a new one. A new one has the time of any
  /// call, so that a server that is slow answers.
  [[nodiscard]] absl::StatusOr<Result> ReadSoon(StoreCall call, std::string_view doing,
                                                milliseconds most);
  /// Store::ServerRun.
  [[nodiscard]] const std::string& server_run() const { return link_.facts().run; }
  /// Link::connections.
  [[nodiscard]] std::uint64_t connections() const { return link_.connections(); }

 private:
  OwnConnection(Link::Options options, const Clock& clock) : link_(std::move(options), clock) {}
  absl::StatusOr<Connection*> Alive(milliseconds most);

  Link link_;
};

/// A Part over a connection of its own. Errors: as OwnConnection::Make.
template <typename Part, typename... Args>
[[nodiscard]] absl::StatusOr<std::unique_ptr<Part>> MakeOverOwn(const StoreOptions& options,
                                                                const Clock& clock,
                                                                const Args&... args) {
  auto connection = OwnConnection::Make(options, clock);
  if (!connection.ok()) return connection.status();
  return std::make_unique<Part>(*std::move(connection), args...);
}

}  // namespace uplink::storage::postgres

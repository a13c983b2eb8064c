#include "server/relay/environment.h"

#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>

namespace uplink::relay {
namespace {

constexpr char kPollVariable[] = "GRPC_POLL_STRATEGY";
constexpr char kSuitesVariable[] = "GRPC_SSL_CIPHER_SUITES";
/// Needs a pre-shared key, which no peer has.
constexpr char kUnusableSuite[] = "PSK-AES128-GCM-SHA256";

}  // namespace

absl::Status CheckEnvironment(const EnvironmentLookup& lookup) {
  const char* value = lookup(kPollVariable);
  if (value == nullptr) return absl::OkStatus();
  const std::string_view engines(value);
  // gRPC takes the first of the list that the machine has; epoll1 is on every Linux.
  const std::string_view first = engines.substr(0, engines.find(','));
  if (first.empty() || first == "all" || first == "epoll1") return absl::OkStatus();
  return absl::FailedPreconditionError(
      fmt::format("{}={}: only epoll1 is served; unset the variable", kPollVariable, engines));
}

void ApplyTlsMinimum(config::TlsVersion minimum) {
  switch (minimum) {
    case config::TlsVersion::k12:
      return;
    case config::TlsVersion::k13:
      // No other thread runs yet, as the contract of this function says.
      ::setenv(kSuitesVariable, kUnusableSuite, 1);  // NOLINT(concurrency-mt-unsafe): see above
      return;
  }
}

void SilenceProtobuf() { google::protobuf::SetLogHandler(nullptr); }

}  // namespace uplink::relay

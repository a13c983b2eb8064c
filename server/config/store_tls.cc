#include "server/config/store_tls.h"

#include <cstddef>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "storage/postgres/link/verified.h"

namespace uplink::config {
namespace {

/// Longest part of a host that a warning repeats.
constexpr std::size_t kHostBytesMax = 255;
constexpr std::size_t kModeBytesMax = 32;

}  // namespace

std::optional<std::string> UnverifiedStoreText(const StoreConfig& store) {
  if (!IsPostgres(store)) return std::nullopt;
  const auto url = storage::postgres::ParseUrl(store.url);
  if (!url.ok()) return std::nullopt;  // CheckRelations says so
  const auto found = storage::postgres::FindUnverified(*url);
  if (!found) return std::nullopt;
  return fmt::format(
      "sslmode is {}, so that {} need not prove that it is the database that was named; set "
      "sslmode=verify-full, and sslrootcert",
      PrintableUtf8(found->sslmode, kModeBytesMax), PrintableUtf8(found->host, kHostBytesMax));
}

}  // namespace uplink::config

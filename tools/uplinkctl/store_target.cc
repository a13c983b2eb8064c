#include "tools/uplinkctl/store_target.h"

#include "server/config/config.h"
#include "storage/postgres/link/url.h"

namespace uplink::ctl {

absl::StatusOr<StoreTarget> TargetOf(const std::string& url, const std::string& password_file) {
  if (storage::postgres::IsPostgresUrl(url)) {
    storage::postgres::StoreOptions options;
    options.url = url;
    options.password_file = password_file;
    // No message is acked here.
    options.accept_unsafe = true;
    return options;
  }
  config::StoreConfig store;
  store.url = url;
  std::string path = config::SqlitePath(store);
  if (path.empty()) {
    return absl::InvalidArgumentError(
        "the URL is of no store: it must be sqlite:/// and the absolute path of a file, or begin "
        "with postgresql://");
  }
  return path;
}

}  // namespace uplink::ctl

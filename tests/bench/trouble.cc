#include "tests/bench/trouble.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/core.h>

namespace uplink::bench {
namespace {

constexpr milliseconds kReadLogEvery{200};

}  // namespace

void FreshFile::Remove() const {
  std::error_code ignored;
  for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path_ + end, ignored);
}

absl::StatusOr<std::unique_ptr<PinnedServer>> StartServer(const TroubleRun& run,
                                                          const std::string& store_url,
                                                          int descriptors_max) {
  return PinnedServer::Start(
      run.world.folder,
      {.program = run.server_bin,
       .environment = {"UPLINKD_STORE_URL=" + store_url, "UPLINKD_STORE_MIGRATE=true",
                       // Half of the default: a window must be long enough to show a robot as away.
                       "UPLINKD_PRESENCE_TIMEOUT=5s", "UPLINKD_DRAIN_TIMEOUT=5s"},
       .descriptors_max = descriptors_max});
}

void Say(const std::string& text) {
  fmt::print(stderr, "{}{}", text, text.ends_with('\n') ? "" : "\n");
}

bool Scene::Turn() {
  const auto memory = static_cast<double>(server_.use().rss_bytes) / kMiB;
  memory_max_mib_ = std::max(memory_max_mib_, memory);
  const SteadyTime now = clock_.Steady();
  if (now - log_read_ > kReadLogEvery) {
    server_.ReadLog();
    log_read_ = now;
  }
  return !run_.stopped() && !server_.ended();
}

Others::OnTurn Scene::For(milliseconds time) {
  return [this, end = clock_.Steady() + time] { return Turn() && clock_.Steady() < end; };
}

}  // namespace uplink::bench

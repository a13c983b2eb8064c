#include "tools/uplinkctl/store_clock.h"

#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <absl/status/statusor.h>
#include <fmt/chrono.h>
#include <fmt/core.h>

#include "server/config/config.h"
#include "server/store/clock_judge.h"
#include "server/store/kernel_clock.h"
#include "storage/postgres/clock_marks.h"
#include "storage/postgres/link/url.h"
#include "storage/sqlite/clock_marks.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/question.h"

namespace uplink::ctl {
namespace {

using Marks = std::unique_ptr<storage::ClockMarks>;

absl::StatusOr<Marks> Open(const StoreClockRequest& request, const Clock& clock) {
  if (storage::postgres::IsPostgresUrl(request.url)) {
    storage::postgres::StoreOptions options;
    options.url = request.url;
    options.password_file = request.password_file;
    // No message is acked here.
    options.accept_unsafe = true;
    return storage::postgres::PostgresClockMarks::Make(options, clock);
  }
  config::StoreConfig store;
  store.url = request.url;
  const std::string path = config::SqlitePath(store);
  if (path.empty()) {
    return absl::InvalidArgumentError(
        "the store's URL is sqlite:/// and the absolute path of a file, or postgresql://");
  }
  return storage::sqlite::SqliteClockMarks::Open(path);
}

std::string TextOf(const std::optional<SystemTime>& time, const char* without) {
  if (!time) return without;
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", std::chrono::floor<std::chrono::seconds>(*time));
}

absl::StatusOr<store::ClockFacts> Look(storage::ClockMarks& marks, const Clock& clock) {
  const absl::StatusOr<storage::ClockReading> reading = marks.Read();
  if (!reading.ok()) return reading.status();
  return store::ClockFacts{clock.System(), reading->mark, store::KernelClockSynchronised(),
                           reading->database};
}

store::Voucher Show(const store::ClockFacts& facts) {
  fmt::print("mark            {}\n", TextOf(facts.mark, "none"));
  fmt::print("this machine    {}\n", TextOf(facts.now, ""));
  fmt::print("database        {}\n", TextOf(facts.database, "as this machine"));
  fmt::print("synchronised    {}\n", facts.kernel_synchronised ? "yes" : "no");
  const store::Voucher voucher = store::VoucherOf(facts);
  switch (voucher) {
    case store::Voucher::kNobody:
      fmt::print("vouched for     no: {}\n", store::WhyNobodyVouches(facts));
      break;
    case store::Voucher::kMark:
      fmt::print("vouched for     yes, by the mark\n");
      break;
    case store::Voucher::kKernel:
      fmt::print("vouched for     yes, by the kernel\n");
      break;
  }
  return voucher;
}

constexpr std::string_view kQuestion =
    "Is this machine's time right? Whatever is too old by it will be deleted.";

}  // namespace

int StoreClock(const StoreClockRequest& request) {
  const SystemClock clock;
  const absl::StatusOr<Marks> marks = Open(request, clock);
  if (!marks.ok()) return ExitOf(marks.status());
  const absl::StatusOr<store::ClockFacts> facts = Look(**marks, clock);
  if (!facts.ok()) return ExitOf(facts.status());
  const store::Voucher voucher = Show(*facts);
  if (!request.confirm) return voucher == store::Voucher::kNobody ? kExitFailed : kExitDone;
  if (!request.yes && !SaysYes(kQuestion)) {
    fmt::print("nothing was changed\n");
    return kExitFailed;
  }
  const SystemTime now = clock.System();
  const absl::Status set = (*marks)->Set(now);
  if (!set.ok()) return ExitOf(set);
  fmt::print("the mark is {} now\n", TextOf(now, ""));
  return kExitDone;
}

}  // namespace uplink::ctl

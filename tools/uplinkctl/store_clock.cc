#include "tools/uplinkctl/store_clock.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <absl/status/statusor.h>
#include <fmt/chrono.h>
#include <fmt/core.h>

#include "server/admin/actions.h"
#include "server/store/clock_judge.h"
#include "storage/postgres/parts.h"
#include "storage/sqlite/parts.h"
#include "tools/uplinkctl/command.h"
#include "tools/uplinkctl/store_access.h"
#include "tools/uplinkctl/store_target.h"

namespace uplink::ctl {
namespace {

using Marks = std::unique_ptr<storage::ClockMarks>;

absl::StatusOr<Marks> Open(const StoreClockRequest& request, const Clock& clock) {
  const auto target = TargetOf(request.url, request.password_file);
  if (!target.ok()) return target.status();
  if (const auto* path = std::get_if<std::string>(&*target)) {
    return storage::sqlite::OpenClockMarks(*path);
  }
  return storage::postgres::MakeClockMarks(std::get<storage::postgres::StoreOptions>(*target),
                                           clock);
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
    case store::Voucher::kNone:
      fmt::print("vouched for     no: {}\n", store::WhyNotVouched(facts));
      break;
    case store::Voucher::kMark:
      fmt::print("vouched for     yes, by the mark\n");
      break;
    case store::Voucher::kKernel:
      fmt::print("vouched for     yes, by the kernel\n");
      break;
    case store::Voucher::kMonotonic:
      // Of servers alone: who looks once has seen no clock go on.
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
  if (!request.confirm) return voucher == store::Voucher::kNone ? kExitFailed : kExitDone;
  if (!request.yes && !SaysYes(kQuestion)) {
    fmt::print("nothing was changed\n");
    return kExitFailed;
  }
  const SystemTime now = clock.System();
  const absl::Status set = (*marks)->Set(now);
  if (!set.ok()) return ExitOf(set);
  NoteDone(request.url, request.password_file, admin::kClockConfirm, {});
  fmt::print("the mark is {} now\n", TextOf(now, ""));
  return kExitDone;
}

}  // namespace uplink::ctl

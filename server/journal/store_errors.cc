#include "server/journal/store_errors.h"

#include <utility>

namespace uplink::journal {

void StoreErrors::NoteCall(const absl::Status& status) {
  if (!status.ok()) probe_.store_errors.Add();
  const std::lock_guard lock(mutex_);
  Set(status, status.ok() ? absl::OkStatus() : duty_);
}

void StoreErrors::NoteDuty(const absl::Status& status) {
  if (!status.ok()) probe_.store_errors.Add();
  const std::lock_guard lock(mutex_);
  Set(call_, status);
}

void StoreErrors::NoteCompare(const absl::Status& status) {
  if (!status.ok()) probe_.store_errors.Add();
  const std::lock_guard lock(mutex_);
  const bool call_failed = !status.ok() && !call_.ok();
  Set(call_failed ? status : call_, call_failed ? duty_ : status);
}

absl::Status StoreErrors::last() const {
  const std::lock_guard lock(mutex_);
  return call_.ok() ? duty_ : call_;
}

void StoreErrors::Set(absl::Status call, absl::Status duty) {
  const bool worked = call_.ok() && duty_.ok();
  call_ = std::move(call);
  duty_ = std::move(duty);
  const bool works = call_.ok() && duty_.ok();
  if (works != worked) probe_.store_failing.Add(works ? -1 : 1);
}

}  // namespace uplink::journal

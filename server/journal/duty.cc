#include "server/journal/duty.h"

namespace uplink::journal {

void Duty::NoteError(const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  if (failing_ != nullptr && error_.ok() != status.ok()) failing_->Add(status.ok() ? -1 : 1);
  error_ = status;
}

absl::Status Duty::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace uplink::journal

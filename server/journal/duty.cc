#include "server/journal/duty.h"

namespace uplink::journal {

void DutyError::Note(const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  if (error_.ok() != status.ok()) failing_.Add(status.ok() ? -1 : 1);
  error_ = status;
}

absl::Status DutyError::last() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace uplink::journal

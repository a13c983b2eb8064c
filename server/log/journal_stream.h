#pragma once

#include <string_view>

namespace uplink::log {

/// Whether a descriptor leads to systemd's journal. `journal_stream` is the variable
/// JOURNAL_STREAM: the device and inode of the stream that systemd made (`8:1234`). A descriptor
/// that was redirected since has others. False if the variable is empty or has
/// another form.
///
/// Source: systemd.exec(5).
/// Thread: any.
[[nodiscard]] bool IsJournal(std::string_view journal_stream, int descriptor);

}  // namespace uplink::log

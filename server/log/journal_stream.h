#pragma once

#include <string_view>

namespace uplink::log {

/// Whether a descriptor leads to systemd's journal: `journal_stream`, the variable JOURNAL_STREAM
/// of systemd.exec(5), names the device and inode of the stream that systemd made (`8:1234`). A
/// descriptor that was turned elsewhere since, to a file or a pipe, is another one. False if
/// the variable is empty or has another form.
[[nodiscard]] bool IsJournal(std::string_view journal_stream, int descriptor);

}  // namespace uplink::log

#include "server/run/supervisor.h"

#include <systemd/sd-daemon.h>

namespace uplink::run {
namespace {

/// Works also without a manager, or with one that refuses the message.
void Tell(const char* state) { static_cast<void>(sd_notify(0, state)); }

}  // namespace

void Supervisor::NoteReady() { Tell("READY=1"); }

void Supervisor::NoteStopping() { Tell("STOPPING=1"); }

void Supervisor::NoteAlive() { Tell("WATCHDOG=1"); }

}  // namespace uplink::run

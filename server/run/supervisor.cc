#include "server/run/supervisor.h"

#include <systemd/sd-daemon.h>

namespace uplink::run {
namespace {

/// Nobody to tell, or one that does not take it, changes nothing for us.
void Tell(const char* state) { static_cast<void>(sd_notify(0, state)); }

}  // namespace

void Supervisor::NoteReady() { Tell("READY=1"); }

void Supervisor::NoteStopping() { Tell("STOPPING=1"); }

void Supervisor::NoteAlive() { Tell("WATCHDOG=1"); }

}  // namespace uplink::run

"""Stops single threads of a process that goes on: a server with one part that stands still."""

import contextlib
import ctypes
import os
import pathlib

PTRACE_DETACH = 17
PTRACE_SEIZE = 0x4206
PTRACE_INTERRUPT = 0x4207
# waitpid: threads too, which are no children of their own.
WALL = 0x40000000

_libc = ctypes.CDLL(None, use_errno=True)
_libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
_libc.ptrace.restype = ctypes.c_long


def _ptrace(request, thread):
    if _libc.ptrace(request, thread, None, None) != 0:
        code = ctypes.get_errno()
        raise OSError(code, f"ptrace {request:#x}: {os.strerror(code)}")


def threads_of(process, prefix):
    """The ids of the threads whose name begins with `prefix`."""
    found = []
    for task in pathlib.Path(f"/proc/{process}/task").iterdir():
        # Others may end meanwhile.
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            if (task / "comm").read_text().startswith(prefix):
                found.append(int(task.name))
    return found


@contextlib.contextmanager
def standing_still(threads):
    """These threads stand still meanwhile. Held by the thread that calls."""
    held = []
    try:
        for thread in threads:
            _ptrace(PTRACE_SEIZE, thread)
            held.append(thread)
            _ptrace(PTRACE_INTERRUPT, thread)
            os.waitpid(thread, WALL)
        yield
    finally:
        for thread in held:
            _ptrace(PTRACE_DETACH, thread)

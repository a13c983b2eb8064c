"""What was found clean before: one empty file per key, in the user's cache folder."""

import os
import time

KEEP_DAYS = 60
KEEP_COUNT = 20000  # forty states of the whole tree


def default_folder():
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(base, "uplinkd", "lint")


class Passed:
    """Bounded by age and by count. A folder that cannot be written remembers nothing."""

    def __init__(self, folder):
        self.folder = folder
        try:
            os.makedirs(folder, exist_ok=True)
        except OSError:
            pass

    def holds(self, key):
        """Whether the key was remembered; it then counts as used today."""
        try:
            os.utime(os.path.join(self.folder, key))
        except FileNotFoundError:
            return False
        except OSError:
            return os.path.exists(os.path.join(self.folder, key))
        return True

    def remember(self, key):
        try:
            with open(os.path.join(self.folder, key), "wb"):
                pass
        except OSError:
            pass

    def prune(self):
        """Forgets what was not used for KEEP_DAYS, and beyond KEEP_COUNT what was not for longest."""
        try:
            entries = [(each.stat().st_mtime, each.path) for each in os.scandir(self.folder)]
        except OSError:
            return
        entries.sort(reverse=True)
        oldest = time.time() - KEEP_DAYS * 86400
        for at, path in entries[KEEP_COUNT:] + [each for each in entries[:KEEP_COUNT] if each[0] < oldest]:
            try:
                os.unlink(path)
            except OSError:
                pass

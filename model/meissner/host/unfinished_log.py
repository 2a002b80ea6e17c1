"""The file beside a log's target that holds the packets until the log gets its name."""

import os
from pathlib import Path


def part_of(path: str | Path, kind: str, number: int = 1) -> Path:
    """The name of the file beside ``path``, a log of ``kind``; ``number``: above 1 beside earlier ones."""
    path = Path(path)
    return path.with_name(f"{path.name}.part{number if number > 1 else ''}{kind}")


class UnfinishedLog:
    """An append-only file. Every write reaches the system before it returns, so the data survive any end of
    the process; ``give_up`` takes back a write that could not be completed.
    """

    def __init__(self, path: str | Path, kind: str) -> None:
        number = 1
        while True:
            self.path = part_of(path, kind, number)
            try:  # never overwrites an earlier log's spool
                self._fd = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
                break
            except FileExistsError:
                number += 1
        self._at = self._kept = 0

    def write(self, data: bytes) -> None:
        left = memoryview(data).cast("B")
        while left:
            count = os.write(self._fd, left)
            self._at += count
            left = left[count:]

    def tell(self) -> int:
        return self._at

    def flush(self) -> None:
        """Mark everything written so far as kept."""
        self._kept = self._at

    def give_up(self) -> None:
        """Cut the file off at the last ``flush`` and close it."""
        os.ftruncate(self._fd, self._kept)
        self.close()

    def close(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)
        self._fd = -1

    def remove(self) -> None:
        self.close()
        self.path.unlink(missing_ok=True)

    def rename(self, path: str | Path) -> None:
        self.close()
        os.replace(self.path, path)

"""Keeps the memory of large messages in the process from one message to the next."""

from __future__ import annotations

# Messages at least this large make it worth while. Bytes.
LARGE = 64 << 10
# glibc gives blocks above its "mmap threshold" (128 KiB at first) back to the kernel when they are freed, and fetches
# them again for the next message, one page fault for each 4 KiB: a 1 MiB string then costs 0.5 ms instead of 0.05. The
# threshold rises to the size of a freed block, if that is no larger than 32 MiB (mallopt(3), M_MMAP_THRESHOLD). Up to
# twice this much freed memory may stay with the process.
_BLOCK = 31 << 20

_done = False


def keep_large_blocks() -> None:
    """From now on freed blocks of up to 31 MiB stay with the process. The block that says so is never touched, so it costs
    no memory; without glibc nothing changes."""
    global _done
    if not _done:
        _done = True
        try:
            bytes(_BLOCK)
        except MemoryError:
            return

"""What this machine can do at all, beside which things are measured."""

import subprocess
import sys
import time


def busy(seconds_of_work):
    """Two busy processes beside one: how many times as much gets done."""
    work = f"x = 0\nfor i in range({seconds_of_work}): x += i * i"

    def run(count):
        began = time.perf_counter()
        children = [subprocess.Popen([sys.executable, "-c", work]) for _ in range(count)]
        for child in children:
            child.wait()
        return time.perf_counter() - began

    return 2.0 * min(run(1) for _ in range(3)) / min(run(2) for _ in range(3))

"""Child processes for tests that need a master of their own: started, watched, ended by their ids."""

import os
import signal
import socket
import subprocess
import sys
import time

DEADLINE = 150.0  # [s] of wall time for each thing that is waited for


class Children:
    """Processes that end with the `with` block."""

    def __init__(self):
        self.running = []

    def __enter__(self):
        return self

    def start(self, *command, **options):
        child = subprocess.Popen(command, start_new_session=True, stdout=options.pop('stdout', subprocess.DEVNULL),
                                 stderr=subprocess.DEVNULL, **options)
        self.running.append((command[0], child))
        return child

    def stop(self, child):
        """Ends one as Ctrl-C would, and waits for it."""
        self.running = [(name, other) for name, other in self.running if other is not child]
        os.killpg(child.pid, signal.SIGINT)
        try:
            child.wait(30)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            sys.exit('a process did not end in 30 s')

    def check(self):
        for name, child in self.running:
            if child.poll() is not None:
                sys.exit('%s ended with code %s' % (name, child.returncode))

    def __exit__(self, *_):
        for how in (signal.SIGINT, signal.SIGKILL):
            for _name, child in reversed(self.running):
                if child.poll() is None:
                    os.killpg(child.pid, how)
            end = time.monotonic() + 10
            while time.monotonic() < end and any(child.poll() is None for _name, child in self.running):
                time.sleep(0.05)


def wait(children, what, done):
    """What `done` returns, once it is true; ends the test when a child dies or the deadline passes."""
    end = time.monotonic() + DEADLINE
    while time.monotonic() < end:
        result = done()
        if result:
            return result
        children.check()
        time.sleep(0.1)
    sys.exit('waited %g s in vain for %s' % (DEADLINE, what))


def free_port():
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]

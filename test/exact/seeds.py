"""Replays of random scenes, a seed each, held against an answer that shares nothing with the package."""

import json
import pathlib
import random
import subprocess
import sys
import tempfile


def main(replay, first, count, write_and_check):
    """Exit code. `write_and_check(rng, folder)` writes scene.yaml and in.bag into the folder and returns what takes the
    replay's events and returns (faults, how many CONFIRMED events held a true change, how many that ought to be CONFIRMED are
    POSSIBLE). Prints the seed of each fault."""
    faults, held, possible = [], 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        lines = folder / 'events.jsonl'
        for seed in range(first, first + count):
            check = write_and_check(random.Random(seed), folder)
            done = subprocess.run([replay, folder / 'scene.yaml', folder / 'in.bag', '--jsonl', lines],
                                  capture_output=True, text=True, check=False)
            if done.returncode != 0:
                faults.append('seed %d: exit code %d: %s' % (seed, done.returncode, done.stderr))
                continue
            events = [json.loads(line) for line in lines.read_text(encoding='utf-8').splitlines()]
            found, good, undecided = check(events)
            faults += ['seed %d: %s' % (seed, fault) for fault in found]
            held += good
            possible += undecided
    print('seeds %d to %d: %d confirmed events hold a true change of contact, %d are possible'
          % (first, first + count - 1, held, possible))
    if held < 2 * count:
        faults.append('fewer than two a seed: this proves little')
    if possible > held // 20 + 1:
        faults.append('more than one of twenty is only possible')
    print('\n'.join(faults) or 'all right')
    return 1 if faults else 0

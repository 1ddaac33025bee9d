#!/usr/bin/python3
"""The demo's replay against the truth: every true change of contact lies in one event's bracket and ball, none is
extra, brackets are no wider than 1e-9 s and balls no larger than 1e-6 m, and a second run gives the same bytes.

    replay.py config/efp_tank path/to/replay
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

WIDTH, BALL = 1e-9, 1e-6  # [s], [m]


def run(replay, demo, folder):
    """{file name: bytes} of one replay into a new folder."""
    folder.mkdir()
    for method in ('certified', 'paper_a', 'paper_b'):
        subprocess.run([replay, str(demo / 'scene.yaml'), str(demo / 'efp_tank.bag'), '--method', method,
                        '--jsonl', str(folder / (method + '.jsonl')), '--csv', str(folder / (method + '.csv')),
                        '--out', str(folder / (method + '.bag'))], check=True, stdout=subprocess.DEVNULL)
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}


def main():
    demo, replay = pathlib.Path(sys.argv[1]), sys.argv[2]
    shots = json.loads((demo / 'truth.json').read_text(encoding='utf-8'))['shots']
    faults = []
    with tempfile.TemporaryDirectory() as name:
        first, second = [run(replay, demo, pathlib.Path(name, part)) for part in ('first', 'second')]
        faults += ['%s: a second run gives other bytes' % file for file in first if first[file] != second[file]]
        subprocess.run(['/usr/bin/python3', '-B', str(demo / 'show.py'), str(demo / 'truth.json'), name + '/first'],
                       check=False)
        events = show.read_events(pathlib.Path(name, 'first', 'certified.jsonl'))
    faults += ['the table above has a row that does not hold'] * bool(show.certified_rows(shots, events)[1])
    for event in events:
        what = '%s at %d ns' % (event['kind'], event['interval_start'])
        if event['certificate'] != 'CONFIRMED':
            faults.append('%s is %s' % (what, event['certificate']))
        ball = event['position_error']
        if event['toi_upper'] - event['toi_lower'] > WIDTH or ball is None or ball > BALL:
            faults.append('%s: bracket or ball is too wide' % what)
    # The comparison itself must be able to say no.
    for key, step in (('ns', 2), ('ns', -2)):
        moved = copy.deepcopy(shots)
        moved[0]['events'][0][key] += step
        if not show.certified_rows(moved, events)[1]:
            faults.append('a truth moved by %d ns still "holds"' % step)
    print('\n'.join(faults) or '%d events hold' % len(events))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.path.insert(0, sys.argv[1])
    import show
    sys.exit(main())

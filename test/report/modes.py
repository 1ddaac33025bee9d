#!/usr/bin/python3
"""Runs `report --stability --quick`, `--scene --bag` and `--from-bag` on the demo, and checks what came out.

    modes.py REPORT REPLAY DEMO

Exit 0, or 1 and a line for each fault.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

MARKS = ('kept', 'undecided', 'missed', 'false', 'late', 'early', 'bound', 'not_asked', 'not_offered')
WRONG = ('missed', 'false', 'late', 'early', 'bound')


def run(command, expected=0):
    ran = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    text = ran.stdout.decode(errors='replace')
    return text, [] if ran.returncode == expected else ['%s: exit %d: %s' % (' '.join(map(str, command)), ran.returncode, text[-2000:])]


def read(path):
    with open(path, encoding='utf-8', newline='') as file:
        return list(csv.DictReader(file))


def has_matplotlib():
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        return False
    return True


def stability(report, out):
    _, faults = run([report, '--stability', '--quick', '--out', out])
    if faults:
        return faults
    rows = read(out / 'stability.csv')
    methods = list(dict.fromkeys(row['method'] for row in rows))
    rungs = {}
    for row in rows:
        rungs.setdefault((row['direction'], row['value']), []).append(row)
    for rung, cells in rungs.items():
        if [row['method'] for row in cells] != methods:
            faults.append('%s %s: not a row for each method' % rung)
        if len({sum(int(row[mark]) for mark in MARKS) for row in cells}) != 1:
            faults.append('%s %s: the marks do not add up to the same trials' % rung)
    for row in rows:
        if row['method'] == 'ours' and (any(row[mark] != '0' for mark in WRONG) or row['not_asked'] != '0' or row['not_offered'] != '0'):
            faults.append('ours is wrong or not asked: %s' % row)
    if (out / 'stability.md').read_text(encoding='utf-8').count('\n| ') != 1 + len({row['direction'] for row in rows}):
        faults.append('stability.md: not a line for each direction')
    if has_matplotlib() and not ((out / 'stability.png').is_file() and (out / 'stability.svg').is_file()):
        faults.append('stability.png, .svg: not drawn')
    return faults


def own_scene(report, demo, out):
    """The pairs that touch are those of the demo's truth, and nothing of ours is wrong beside the reference."""
    text, faults = run([report, '--scene', demo / 'scene.yaml', '--bag', demo / 'efp_tank.bag', '--quick', '--out', out])
    if faults:
        return faults
    rows = [row for row in read(out / 'results.csv') if not row['reason']]
    for row in rows:
        if row['family'] == 'ours' and any(row[key] != '0' for key in ('missed', 'false_hits', 'late', 'broken_bounds', 'undecided')):
            faults.append('%s on %s is wrong or undecided' % (row['method'], row['scene']))
    hit = {frozenset(row['scene'].split(' - ')) for row in rows if row['method'] == 'ours, 1e-8 s' and row['found'] != '0'}
    with open(demo / 'truth.json', encoding='utf-8') as file:
        true = {frozenset((shot['object'], '%s.%s' % (shot['target'], event['link'])))
                for shot in json.load(file)['shots'] for event in shot['events']}
    if hit != true or not true:
        faults.append('found hits of %s, true are those of %s: %s' % (sorted(map(sorted, hit)), sorted(map(sorted, true)), text))
    _, refused = run([report, '--scene', demo / 'scene.yaml', '--bag', demo / 'scene.yaml', '--out', out], expected=2)
    return faults + refused


def from_bag(report, replay, demo, out):
    bag, events = out / 'run.bag', out / 'events.jsonl'
    _, faults = run([replay, demo / 'scene.yaml', demo / 'efp_tank.bag', '--out', bag, '--jsonl', events, '--timing'])
    _, more = run([report, '--from-bag', bag, '--out', out])
    faults += more
    if faults:
        return faults
    beats = read(out / 'from_bag.csv')
    with open(events, encoding='utf-8') as file:
        brackets = [event['toi_upper'] - event['toi_lower'] for event in map(json.loads, file)]
    if sum(int(beat['events']) for beat in beats) != len(brackets):
        faults.append('from_bag.csv: %d events, recorded were %d' % (sum(int(beat['events']) for beat in beats), len(brackets)))
    worst = max(float(beat['worst_bracket_s']) for beat in beats)
    if not abs(worst - max(brackets)) <= 1e-4 * worst:
        faults.append('from_bag.csv: worst bracket %g s, recorded %g s' % (worst, max(brackets)))
    if not all(float(beat['wall_time_s']) > 0 for beat in beats):
        faults.append('from_bag.csv: a heartbeat without wall time')
    _, unmeasured = run([replay, demo / 'scene.yaml', demo / 'efp_tank.bag', '--out', out / 'plain.bag'])
    text, refused = run([report, '--from-bag', out / 'plain.bag', '--out', out], expected=2)
    if '--timing' not in text:
        faults.append('a recording without wall times is not told how to get them: ' + text)
    return faults + unmeasured + refused


def main():
    report, replay, demo = map(pathlib.Path, sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        faults = stability(report, out) + own_scene(report, demo, out) + from_bag(report, replay, demo, out)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())

#!/usr/bin/python3
"""Runs `report --quick` and checks what came out: no row is missing, and the claims that the pages make hold.

    quick.py PROGRAM

Exit 0, or 1 and a line for each fault.
"""

import csv
import pathlib
import subprocess
import sys
import tempfile

SCENES = {'efp_point', 'efp_sphere', 'tumbling_1k', 'tumbling_10k', 'tumbling_100k', 'spinning_blade', 'grazing_spheres',
          'grazing_tip', 'sliding', 'deep_overlap', 'ballistic', 'large_offset', 'high_spin', 'swarm'}
FAMILIES = {'ours', 'ours, budget', 'paper A', 'paper B', 'static test at stamps', 'line of sight', 'subdivision',
            '4D intersection', 'FCL naive', 'fcl::distance advancement', 'FCL shape advancement', 'Bullet convex sweep',
            'Bullet continuous', 'Embree ray'}
PEERS = {'FCL': 'FCL', 'fcl::': 'FCL', 'Bullet': 'Bullet', 'Embree': 'Embree'}


def complete(rows, faults):
    """Every method on every scene, once: with numbers, or with the reason why not."""
    methods = {row['method'] for row in rows}
    seen = [(row['scene'], row['method']) for row in rows]
    if {row['scene'] for row in rows} != SCENES or {row['family'] for row in rows} != FAMILIES:
        faults.append('scenes or families of methods are not those that the pages name')
    if len(seen) != len(set(seen)) or len(seen) != len(SCENES) * len(methods):
        faults.append('%d rows for %d scenes and %d methods' % (len(seen), len(SCENES), len(methods)))
    for row in rows:
        where = '%s on %s: ' % (row['method'], row['scene'])
        if row['reason']:
            if not any(row['family'].startswith(peer) for peer in PEERS):
                faults.append(where + 'not run, but it takes anything: ' + row['reason'])
        elif not (int(row['answered']) > 0 and float(row['time_p50_s']) > 0.0):
            faults.append(where + 'neither numbers nor a reason')


def claims(rows, faults):
    """Ours: all queries asked, 0 missed, 0 false, 0 late, every bound holds. At any precision all are decided."""
    for row in rows:
        where = '%s on %s: ' % (row['method'], row['scene'])
        if row['reason']:
            continue
        if row['unjudged'] != '0':
            faults.append(where + '%s queries have no truth' % row['unjudged'])
        if not row['family'].startswith('ours'):
            continue
        for key in ('missed', 'false_hits', 'late', 'broken_bounds'):
            if row[key] != '0':
                faults.append(where + '%s is %s' % (key, row[key]))
        if row['answered'] != row['queries']:
            faults.append(where + 'only %s of %s queries were asked' % (row['answered'], row['queries']))
        if row['family'] == 'ours' and (row['undecided'] != '0' or row['found'] != row['hits']):
            faults.append(where + '%s undecided, %s of %s hits found' % (row['undecided'], row['found'], row['hits']))
        if row['hits'] == '0':
            faults.append(where + 'no hit to find')


def pictures(folder, faults):
    if not (folder / 'results.md').read_text(encoding='utf-8').count('| ours, 1e-12 s |') == len(SCENES):
        faults.append('results.md: not a table for each scene')
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        return
    for name in ('error_time', 'error_time_shots', 'error_time_meshes', 'error_time_hard', 'error_time_rest', 'line_of_sight'):
        for ending in ('.png', '.svg'):
            if not (folder / (name + ending)).is_file():
                faults.append(name + ending + ': not drawn')


def main():
    faults = []
    with tempfile.TemporaryDirectory() as out:
        ran = subprocess.run([sys.argv[1], '--quick', '--out', out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if ran.returncode != 0:
            faults.append('exit %d: %s' % (ran.returncode, ran.stdout.decode(errors='replace')[-2000:]))
        results = pathlib.Path(out, 'results.csv')
        if results.is_file():
            with open(results, encoding='utf-8', newline='') as file:
                rows = list(csv.DictReader(file))
            complete(rows, faults)
            claims(rows, faults)
            pictures(pathlib.Path(out), faults)
            print('%d rows' % len(rows))
        else:
            faults.append('no results.csv')
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())

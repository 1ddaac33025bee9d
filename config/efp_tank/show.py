#!/usr/bin/python3
"""Prints the demo's impacts beside the truth, and what the paper's methods say of each shot.

    show.py truth.json folder     (folder: certified.jsonl, paper_a.jsonl, paper_b.jsonl from `replay --jsonl`)

Exit 1 when a true change of contact has no certified event that holds it, or an event has no truth.
"""

import json
import math
import pathlib
import sys
from fractions import Fraction


def read_events(path):
    with open(path, encoding='utf-8') as lines:
        return [json.loads(line) for line in lines if line.strip()]


def true_time(truth):
    """[ns since 1970], exact."""
    return truth['ns'] + Fraction(truth['fraction_ns'])


def bracket(event):
    """[toi_lower, toi_upper] in ns since 1970, exact."""
    return [event['interval_start'] + Fraction(event[key]) * 10**9 for key in ('toi_lower', 'toi_upper')]


def off(event, truth):
    """Distance of the event's point from the true one [m]."""
    gap = [Fraction(event['position'][axis]) - Fraction(p) for axis, p in zip('xyz', truth['position'])]
    return math.sqrt(sum(g * g for g in gap))


def in_ball(event, truth):
    """Whether the true point lies in the event's ball; decided exactly. No ball (a paper's method): no."""
    if event['position_error'] is None:
        return False
    gap = [Fraction(event['position'][axis]) - Fraction(p) for axis, p in zip('xyz', truth['position'])]
    return sum(g * g for g in gap) <= Fraction(event['position_error'])**2


def sides(event, target):
    """(the shot's side, the target's side) of an event."""
    return (event['b'], event['a']) if event['a']['object'] == target else (event['a'], event['b'])


def holds(event, shot, truth):
    """Whether `event` is this true change of contact: same links, kind and zone, time in bracket, point in ball."""
    mine, other = sides(event, shot['target'])
    low, high = bracket(event)
    return (mine['object'] == shot['object'] and other['object'] == shot['target'] and other['link'] == truth['link']
            and other['zone'] == truth['zone'] and event['kind'] == truth['kind']
            and low <= true_time(truth) <= high and in_ball(event, truth))


def seconds(ns):
    """Whole nanoseconds as seconds, without a detour through doubles."""
    return '%d.%09d' % divmod(math.floor(ns), 10**9)


def place(link, zone):
    return link + ('/' + zone if zone else '')


def table(rows):
    """Prints rows of text in columns."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        print('  ' + '  '.join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip())


def certified_rows(shots, events):
    """Table rows, and how many truths or events are left without a partner."""
    rows = [('shot', 'event', 'link/zone', 'true time [s]', 'bracket minus truth [s]', 'holds', 'ball [m]', 'point off [m]',
             'holds', 'certificate')]
    left, wrong = list(events), 0
    for shot in shots:
        for truth in shot['events']:
            found = next((event for event in left if holds(event, shot, truth)), None)
            start = (shot['object'], truth['kind'], place(truth['link'], truth['zone']), seconds(true_time(truth)))
            if found is None:
                rows.append(start + ('no event holds it', 'NO', '', '', '', ''))
                wrong += 1
                continue
            left.remove(found)
            low, high = [float((t - true_time(truth)) / 10**9) for t in bracket(found)]
            rows.append(start + ('%+.1e .. %+.1e' % (low, high), 'yes', '%.1e' % found['position_error'],
                                 '%.1e' % off(found, truth), 'yes', found['certificate']))
        if not shot['events']:
            through = ', goes through the bounding box of ' + ', '.join(shot['bounding_boxes_entered']) \
                if shot['bounding_boxes_entered'] else ''
            own = [event for event in left if shot['object'] in (event['a']['object'], event['b']['object'])]
            rows.append((shot['object'], '-', '-', '-', 'misses by %.3f m%s' % (shot['clearance_m'], through),
                         'NO' if own else 'yes', '', '', '', ''))
    for event in left:
        rows.append(('?', event['kind'], '%s - %s' % (event['a']['object'], event['b']['object']), seconds(bracket(event)[0]),
                     'no such truth', 'NO', '', '', '', event['certificate']))
    return rows, wrong + len(left)


def paper_cell(shot, events):
    """What a method's first impact of this shot says, against the true first one."""
    impacts = [e for e in events if e['kind'] == 'IMPACT' and sides(e, shot['target'])[0]['object'] == shot['object']
               and sides(e, shot['target'])[1]['object'] == shot['target']]
    true_first = next((truth for truth in shot['events'] if truth['kind'] == 'IMPACT'), None)
    if not impacts:
        return 'no impact: MISSED' if true_first else 'no impact: right'
    first = min(impacts, key=lambda event: bracket(event)[0])
    said = sides(first, shot['target'])[1]
    text = place(said['link'], said['zone'])
    if true_first is None:
        return text + ': WRONG, there is no impact'
    late = float((bracket(first)[0] - true_time(true_first)) / 10**9)
    text += ', %+.1e s, %.1e m off' % (late, off(first, true_first))
    return text + ('' if said['link'] == true_first['link'] else ', WRONG link')


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding='utf-8') as file:
        shots = json.load(file)['shots']
    folder = pathlib.Path(sys.argv[2])
    rows, wrong = certified_rows(shots, read_events(folder / 'certified.jsonl'))
    print('\nCertified impacts, and the truth in closed form:')
    table(rows)
    rows = [('shot', 'body', 'truth', 'method A', 'method B')]
    paper = {name: read_events(folder / name) for name in ('paper_a.jsonl', 'paper_b.jsonl')}
    for shot in shots:
        first = next((truth for truth in shot['events'] if truth['kind'] == 'IMPACT'), None)
        body = shot['shape'] + (' %g m' % shot['radius'] if shot['radius'] else '')
        rows.append((shot['object'], body, place(first['link'], first['zone']) if first else 'miss',
                     paper_cell(shot, paper['paper_a.jsonl']), paper_cell(shot, paper['paper_b.jsonl'])))
    print("\nFirst impact of each shot by the paper's methods, which take a shot for a point:")
    table(rows)
    if wrong:
        sys.exit('show.py: %d of the answers and truths above do not belong together' % wrong)


if __name__ == '__main__':
    main()

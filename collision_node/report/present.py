#!/usr/bin/python3
"""Makes tables and diagrams of what `report` measured.

    present.py FOLDER                  results.csv, shots.csv, tank.csv there -> results.md and, with matplotlib, diagrams
    present.py --docs DOCS FOLDER      the same into the pages of this package: its tables, numbers and pictures
    present.py --check DOCS            are the pages' tables those of DOCS/report/results.csv? exit 1 and a line each if not

A page holds a table between `<!-- table NAME -->` and `<!-- end -->`.
"""

import csv
import pathlib
import re
import shutil
import sys

sys.dont_write_bytecode = True  # the package's folder may be a checkout, or not writable

# Families as the diagrams order and the tables name them.
SHORT = ['ours, 1e-2 s', 'ours, 1e-6 s', 'ours, 1e-12 s', 'paper A', 'paper A, sampled near S', 'paper B',
         'paper B, sampled near S', 'static test at stamps', 'line of sight', 'subdivision 100', 'subdivision 10000',
         '4D intersection, 100 samples', 'FCL naive 1000', 'fcl::distance advancement, 1e-5 m', 'FCL shape advancement',
         'Bullet convexSweepTest', 'btContinuousConvexCollision', 'Embree ray']


def read(path):
    with open(path, encoding='utf-8', newline='') as file:
        return list(csv.DictReader(file))


def by_scene(rows):
    scenes = {}
    for row in rows:
        scenes.setdefault(row['scene'], []).append(row)
    return scenes


def number(row, key):
    return float(row[key]) if row.get(key) else None


def readable(value, unit):
    """Two digits and a prefix; a dash where there is no number."""
    if value is None:
        return '-'
    if value == 0.0:
        return '0'
    if unit == 'B':
        for scale, name in ((1e6, 'MB'), (1e3, 'kB'), (1.0, 'B')):
            if value >= scale:
                return '%.3g %s' % (value / scale, name)
        return '0'
    for scale, name in ((1.0, ''), (1e-3, 'm'), (1e-6, 'u'), (1e-9, 'n'), (1e-12, 'p'), (1e-15, 'f')):
        if value >= 0.9995 * scale:
            return '%.2g %s%s' % (value / scale, name, unit) if value < 99.5 * scale else '%.0f %s%s' % (value / scale, name, unit)
    return '%.0e %s' % (value, unit)


# ---------------------------------------------------------------- tables

COLUMNS = ('method', 'asked', 'time', 'p99', 'missed', 'false', 'late', 'undecided', 'TOI error', 'p99', 'worst', 'point error',
           'worst', 'claimed: time', 'ball', 'bounds broken', 'memory')


def table_row(row):
    seconds = lambda key: readable(number(row, key), 's')
    metres = lambda key: readable(number(row, key), 'm')
    late = row['late'] if row['late'] == '0' else '%s (%s)' % (row['late'], seconds('worst_late_s'))
    certified = row['family'].startswith('ours')
    return (row['method'], row['answered'], seconds('time_p50_s'), seconds('time_p99_s'), '%s of %s' % (row['missed'], row['hits']),
            row['false_hits'], late, row['undecided'], seconds('toi_error_p50_s'), seconds('toi_error_p99_s'),
            seconds('toi_error_max_s'), metres('point_error_p50_m'), metres('point_error_max_m'), seconds('claimed_time_max_s'),
            metres('claimed_ball_max_m'), row['broken_bounds'] if certified else '-', readable(number(row, 'bytes'), 'B'))


def markdown(columns, rows):
    lines = ['| ' + ' | '.join(columns) + ' |', '|' + '---|' * len(columns)]
    return '\n'.join(lines + ['| ' + ' | '.join(row) + ' |' for row in rows]) + '\n'


def scene_table(rows, methods=None):
    ran = [row for row in rows if not row['reason'] and (methods is None or row['method'] in methods)]
    return markdown(COLUMNS, [table_row(row) for row in ran])


def all_tables(scenes):
    parts = []
    for scene, rows in scenes.items():
        parts.append('## %s\n\n%s queries; steps of %s; the truth is known to %s.\n' % (
            scene, rows[0]['queries'], readable(number(rows[0], 'step_s'), 's'), readable(number(rows[0], 'truth_error_s'), 's')))
        parts.append(scene_table(rows))
        reasons = {}
        for row in rows:
            if row['reason']:
                reasons.setdefault(row['reason'], []).append(row['method'])
        parts += ['Not run (%s): %s.\n' % (reason, '; '.join(names)) for reason, names in reasons.items()]
    return '\n'.join(parts)


def same_work(rows):
    """The fastest method that is not ours, makes no fault on a scene, and is off by a thousandth of a step at most; or None."""
    none = ('missed', 'false_hits', 'undecided', 'unjudged')
    right = [row for row in rows if not row['reason'] and not row['family'].startswith('ours') and row['found'] != '0' and
             all(row[key] == '0' for key in none) and number(row, 'toi_error_max_s') <= 1e-3 * number(row, 'step_s')]
    return min(right, key=lambda row: number(row, 'time_p50_s'), default=None)


def summary(scenes):
    """One line for each scene: ours, and the fastest of the others that will do."""
    lines = []
    for scene, rows in scenes.items():
        ours = next(row for row in rows if row['method'] == 'ours, 1e-8 s')
        other = same_work(rows)
        line = [scene, '%s of %s' % (ours['hits'], ours['answered']), readable(number(ours, 'time_p50_s'), 's'),
                readable(number(ours, 'toi_error_max_s'), 's'),
                '%s/%s/%s/%s' % (ours['missed'], ours['false_hits'], ours['undecided'], ours['broken_bounds'])]
        if other:
            line += [other['method'], readable(number(other, 'time_p50_s'), 's'), readable(number(other, 'toi_error_max_s'), 's'),
                     '%.3g' % (number(other, 'time_p50_s') / number(ours, 'time_p50_s'))]
        else:
            line += ['none', '-', '-', '-']
        lines.append(line)
    return markdown(('scene', 'hits', 'ours', 'worst TOI error', 'missed/false/undecided/bounds broken',
                     'fastest other that will do', 'its time', 'its worst TOI error', 'its time over ours'), lines)


def sights(shots):
    rows = []
    for index, shot in enumerate(shots, 1):
        gap = sum((number(shot, 'true_' + k) - number(shot, 'sighted_' + k))**2 for k in 'xyz')**0.5 if shot['sighted_part'] else None
        rows.append((str(index), shot['true_part'], shot['sighted_part'] or 'nothing', readable(gap, 'm')))
    return markdown(('shot', 'it hits', 'line of sight says', 'off by'), rows)


def tables_of(folder):
    """Name -> Markdown of every table that a page may hold."""
    scenes = by_scene(read(folder / 'results.csv'))
    tables = {'scene ' + scene: scene_table(rows, SHORT) for scene, rows in scenes.items()}
    tables['summary'] = summary(scenes)
    tables['sights'] = sights(read(folder / 'shots.csv'))
    return tables


def pasted(page, tables):
    """The page with its tables made anew; KeyError when it asks for one that does not exist."""
    return re.sub(r'(<!-- table (.+?) -->\n).*?(<!-- end -->)', lambda m: m.group(1) + tables[m.group(2)] + m.group(3), page,
                  flags=re.S)


def pages(docs):
    return [page for page in [docs / 'report.md', docs / '../../README.md'] if page.exists()]


def check(docs):
    folder = docs / 'report'
    tables, faults = tables_of(folder), 0
    for page in pages(docs):
        text = page.read_text(encoding='utf-8')
        if pasted(text, tables) != text:
            print('%s: a table is not what report/results.csv says; run present.py --docs' % page)
            faults += 1
    if (folder / 'results.md').read_text(encoding='utf-8') != all_tables(by_scene(read(folder / 'results.csv'))):
        print('%s: not what results.csv says; run present.py --docs' % (folder / 'results.md'))
        faults += 1
    return 1 if faults else 0


def into_docs(docs, folder):
    kept = docs / 'report'
    kept.mkdir(exist_ok=True)
    for name in ('results.csv', 'results.md', 'shots.csv'):
        shutil.copy(folder / name, kept / name)
    for picture in sorted(folder.glob('*.png')):
        shutil.copy(picture, docs / 'img' / picture.name)
    for page in pages(docs):
        page.write_text(pasted(page.read_text(encoding='utf-8'), tables_of(kept)), encoding='utf-8')


def main():
    words = sys.argv[1:]
    if len(words) == 2 and words[0] == '--check':
        return check(pathlib.Path(words[1]))
    if not words or words[0] == '--docs' and len(words) != 3 or words[0] != '--docs' and len(words) != 1:
        print(__doc__)
        return 2
    folder = pathlib.Path(words[-1])
    (folder / 'results.md').write_text(all_tables(by_scene(read(folder / 'results.csv'))), encoding='utf-8')
    print('Tables: %s' % (folder / 'results.md'))
    try:
        import diagrams
    except ImportError as error:
        print('No diagrams: %s; apt-get install python3-matplotlib' % error)
    else:
        for picture in diagrams.draw(folder, by_scene(read(folder / 'results.csv')), read(folder / 'shots.csv'), read(folder / 'tank.csv')):
            print('Diagram: %s' % picture)
    if words[0] == '--docs':
        into_docs(pathlib.Path(words[1]), folder)
    return 0


if __name__ == '__main__':
    sys.exit(main())

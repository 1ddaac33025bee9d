#!/usr/bin/python3
"""Makes tables and diagrams of `report --scene --bag`: FOLDER/results.csv -> results.md and, with matplotlib, a diagram of each
twelve pairs that touch."""

import pathlib
import sys

sys.dont_write_bytecode = True  # the package's folder may be a checkout, or not writable

import present


def main():
    folder = pathlib.Path(sys.argv[1])
    scenes = present.by_scene(present.read(folder / 'results.csv'))
    (folder / 'results.md').write_text(present.all_tables(scenes), encoding='utf-8')
    print('Tables: %s' % (folder / 'results.md'))
    try:
        import diagrams
    except ImportError as error:
        print('No diagrams: %s; apt-get install python3-matplotlib' % error)
        return
    names = [name for name, rows in scenes.items() if any(row['hits'] not in ('', '0') for row in rows)]
    for first in range(0, len(names), 12):
        shown = {name: scenes[name] for name in names[first:first + 12]}
        for picture in diagrams.error_time(folder, 'error_time_%d' % (first // 12 + 1), shown):
            print('Diagram: %s' % picture)


if __name__ == '__main__':
    main()

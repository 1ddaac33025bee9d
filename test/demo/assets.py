#!/usr/bin/python3
"""The committed demo files are what make_demo.py writes today: meshes, URDF and truth byte by byte, the bag message
by message, and the bag is small.

    assets.py config/efp_tank
"""

import pathlib
import subprocess
import sys
import tempfile

import rosbag

LIMIT = 200000  # bytes


def messages(path):
    """[(topic, arrival, type, bytes of the message)] of a bag, and its latched topics."""
    with rosbag.Bag(str(path)) as bag:
        rows = [(topic, str(time), raw[0], raw[1]) for topic, raw, time in bag.read_messages(raw=True)]
        latched = sorted(c.topic for c in bag._get_connections() if c.header.get('latching') in ('1', b'1'))
    return rows, latched


def main():
    committed = pathlib.Path(sys.argv[1])
    faults = []
    with tempfile.TemporaryDirectory() as name:
        fresh = pathlib.Path(name)
        subprocess.run(['/usr/bin/python3', '-B', str(committed / 'make_demo.py'), name], check=True)
        files = sorted(p.relative_to(fresh) for p in fresh.rglob('*') if p.is_file() and p.suffix != '.bag')
        if len(files) < 6:
            faults.append('only %s were made' % files)
        faults += ['%s: differs from what make_demo.py writes' % file for file in files
                   if (fresh / file).read_bytes() != (committed / file).read_bytes()]
        if messages(fresh / 'efp_tank.bag') != messages(committed / 'efp_tank.bag'):
            faults.append('efp_tank.bag: its messages differ from what make_demo.py writes')
    rows, latched = messages(committed / 'efp_tank.bag')
    if latched != ['/tf_static']:
        faults.append('efp_tank.bag: latched topics are %s, /tf_static alone should be' % latched)
    if (committed / 'efp_tank.bag').stat().st_size > LIMIT:
        faults.append('efp_tank.bag: larger than %d bytes' % LIMIT)
    print('\n'.join(faults) or '%d files and %d messages as the script writes them' % (len(files), len(rows)))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())

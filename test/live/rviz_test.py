#!/usr/bin/python3
"""The result bag in a real rviz: the confirmed impact's red is on the screen in two rounds of the looping player, and not
before the impact. The package's own view is shown, without its TF display: the axes there are red, too.

    rviz_test.py path/to/replay path/to/repository [picture.png]

Runs its own master, screen, rviz and player, and ends them by their ids. With `picture.png` rviz's view after the second shot
is kept: the README's picture.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import yaml
from processes import Children, free_port, wait

SKIP = 77  # told to ctest
IMPACT_NS = 1700000001795415322  # the first confirmed impact of the demo
SECOND_SHOT_NS = 1700000002250000000  # both its impacts are over, the third shot has not come
VIEW = '900x740+364+62'  # rviz's view on the screen
RED = 100  # pixels of the marker's colour that a picture must hold


def red_pixels(environment, picture):
    """How many pixels of the screen are red and nothing else."""
    taken = subprocess.run(['import', '-window', 'root', '-depth', '8', str(picture)], env=environment, check=False,
                           stderr=subprocess.DEVNULL)
    if taken.returncode:
        return 0
    pixels = subprocess.run(['convert', str(picture), '-depth', '8', 'rgb:-'], check=True,
                            stdout=subprocess.PIPE).stdout
    return sum(1 for r, g, b in zip(pixels[0::3], pixels[1::3], pixels[2::3]) if r > 120 and g < 25 and b < 25)


def view_without_tf(config, target):
    view = yaml.safe_load(config.read_text(encoding='utf-8'))
    manager = view['Visualization Manager']
    manager['Displays'] = [display for display in manager['Displays'] if display['Class'] != 'rviz/TF']
    target.write_text(yaml.safe_dump(view), encoding='utf-8')


def red_in_round(children, wanted, rounds, now, count_red):
    """(red pixels after the first impact, red pixels shortly before it) of round `wanted`. rviz may show the round before
    for a moment after the player has jumped back, so the last picture before the impact counts."""
    before = [-1]

    def seen():
        if rounds[0] > wanted:
            sys.exit('round %d went by without the red of an impact' % wanted)
        start = (rounds[0], now[0])
        count = count_red()
        if start[0] != wanted or rounds[0] != wanted:
            return False  # the picture may be of another round
        if now[0] < IMPACT_NS:
            before[0] = count
            return False
        return count if start[1] >= IMPACT_NS and count >= RED else False

    count = wait(children, 'red in round %d' % wanted, seen)
    if before[0] < 0:
        sys.exit('no picture of round %d before the impact' % wanted)
    if before[0] >= RED:
        sys.exit('%d red pixels in round %d before the impact' % (before[0], wanted))
    return count, before[0]


def main():
    replay, repository = sys.argv[1], pathlib.Path(sys.argv[2])
    missing = [name for name in ('rviz', 'Xvfb', 'import', 'convert', 'rosmaster') if not shutil.which(name)]
    if missing:
        print('skipped: not installed: ' + ', '.join(missing))
        return SKIP
    demo = repository / 'config' / 'efp_tank'
    with tempfile.TemporaryDirectory() as folder, Children() as children:
        bag, picture = pathlib.Path(folder, 'impacts.bag'), pathlib.Path(folder, 'screen.png')
        subprocess.run([replay, str(demo / 'scene.yaml'), str(demo / 'efp_tank.bag'), '--out', str(bag)], check=True,
                       stdout=subprocess.DEVNULL)
        read, write = os.pipe()
        children.start('Xvfb', '-displayfd', str(write), '-screen', '0', '1280x900x24', pass_fds=[write])
        os.close(write)
        display = os.read(read, 16).decode().strip()
        port = free_port()
        environment = dict(os.environ, DISPLAY=':' + display, ROS_MASTER_URI='http://127.0.0.1:%d' % port,
                           ROS_IP='127.0.0.1', HOME=folder)
        os.environ.update(environment)
        children.start('rosmaster', '--core', '-p', str(port), env=environment)

        import rosgraph  # after the environment: they read it on import
        import rospy
        from rosgraph_msgs.msg import Clock
        wait(children, 'the master', rosgraph.is_master_online)
        rospy.set_param('/use_sim_time', True)
        view = pathlib.Path(folder, 'view.rviz')
        view_without_tf(repository / 'config' / 'collision_node.rviz', view)
        children.start('rviz', '-d', str(view), env=environment)
        rounds, now = [0], [0]

        def on_clock(message):
            stamp = message.clock.to_nsec()
            if stamp < now[0] or rounds[0] == 0:
                rounds[0] += 1
            now[0] = stamp

        rospy.init_node('rviz_test', disable_signals=True)
        rospy.Subscriber('/clock', Clock, on_clock)
        master = rosgraph.Master('/rviz_test')

        def rviz_listens():
            return any(topic == '/collision_node/markers' for topic, _ in master.getSystemState()[1])

        wait(children, 'rviz to ask for the markers', rviz_listens)
        before = red_pixels(environment, picture)
        if before >= RED:
            sys.exit('%d red pixels before anything was played' % before)
        # A third of the speed leaves time for several pictures in each round.
        children.start('/usr/lib/rosbag/play', '--clock', '--loop', '-q', '-d', '2', '-r', '0.3', str(bag),
                       env=environment, stdin=subprocess.DEVNULL)
        for wanted in (1, 2):
            print('round %d: %d red pixels, %d before the impact' % (
                wanted, *red_in_round(children, wanted, rounds, now, lambda: red_pixels(environment, picture))))
        if len(sys.argv) > 3:
            wait(children, 'the second shot', lambda: now[0] >= SECOND_SHOT_NS and red_pixels(environment, picture) >= RED)
            subprocess.run(['convert', str(picture), '-crop', VIEW, '+repage', '-colors', '128', sys.argv[3]], check=True)
    return 0


if __name__ == '__main__':
    sys.exit(main())

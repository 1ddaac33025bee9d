#!/usr/bin/python3
"""A player that loops: each round is an epoch of its own and gives the same events, with the same ids.

    loop_test.py path/to/collision_node path/to/repository
"""

import copy
import os
import pathlib
import subprocess
import sys
import tempfile

from processes import Children, free_port, wait

ROUNDS = 2


def told(impact):
    """An event as text, without its epoch and roscpp's own sequence number."""
    copied = copy.deepcopy(impact)
    copied.epoch = copied.header.seq = 0
    return str(copied)


def main():
    demo = pathlib.Path(sys.argv[2], 'config', 'efp_tank')
    with tempfile.TemporaryDirectory() as folder, Children() as children:
        port = free_port()
        environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:%d' % port, ROS_IP='127.0.0.1', HOME=folder)
        os.environ.update(environment)
        children.start('rosmaster', '--core', '-p', str(port), env=environment)

        import rosgraph  # after the environment: they read it on import
        import rospy
        from collision_node.msg import Impact
        wait(children, 'the master', rosgraph.is_master_online)
        master = rosgraph.Master('/loop_test')
        master.setParam('/use_sim_time', True)
        master.setParam('/collision_node/scene', str(demo / 'scene.yaml'))
        children.start(sys.argv[1], env=environment)
        rospy.init_node('loop_test', disable_signals=True)
        heard = []
        listener = rospy.Subscriber('/collision_node/impacts', Impact, heard.append)
        wait(children, 'the node', lambda: listener.get_num_connections() == 1 and
             '/tank/pose' in dict(master.getSystemState()[1]))
        children.start('/usr/lib/rosbag/play', str(demo / 'efp_tank.bag'), '--clock', '--loop', '-q', '-d', '3',
                       '--queue=1000000', env=environment, stdin=subprocess.DEVNULL)
        # The first event of one round more proves that the rounds before it are complete.
        wait(children, '%d rounds' % ROUNDS, lambda: heard and heard[-1].epoch >= ROUNDS)
        rounds = [[told(impact) for impact in list(heard) if impact.epoch == epoch] for epoch in range(ROUNDS)]
        for events in rounds:
            print('%d events' % len(events))
        if not rounds[0] or any(events != rounds[0] for events in rounds):
            sys.exit('the rounds differ')
    return 0


if __name__ == '__main__':
    sys.exit(main())

#!/usr/bin/python3
"""A live node through mishaps: it says what replay says of the same poses.

    mishaps_test.py path/to/collision_node path/to/replay

Rounds: in order, shuffled within `reorder`, with losses, publishers that die and are born again, a clock that stands
still, a clock that goes back, a node that starts again, a master that starts again, and a player at a fifth, one and
ten times the rate.
"""

import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

from comparison import replayed, told
from processes import Children, free_port, wait

# Two seconds of poses are sent at once, one topic perhaps before the other: `timeout` is longer than that.
SCENE = """
objects:
  ball: {sphere: {radius: 0.05}, pose: {topic: /ball}}
  wall: {box: {size: [0.1, 2, 2]}, pose: {topic: /wall}}
time: {reorder: 0.1, max_gap: 1.0, timeout: 10, jump: 0.5}
stats: {period: 0.5}
"""
TOPICS = ('/ball', '/wall')
SEED = 20
PLAYED_RATES = (0.2, 1, 10)
NS = 1000000000


def pose(stamp_ns, x):
    import rospy
    from geometry_msgs.msg import PoseStamped
    message = PoseStamped()
    message.header.frame_id = 'world'
    message.header.stamp = rospy.Time(stamp_ns // NS, stamp_ns % NS)
    message.pose.position.x = x
    message.pose.orientation.w = 1
    return message


def stream(step_ns, end_ns):
    """(topic, message) in order of their stamps: a ball that swings through a wall that sways."""
    out = []
    for ns in range(0, end_ns, step_ns):
        t = ns * 1e-9
        out.append(('/ball', pose(100 * NS + ns, 3 * math.sin(9 * t))))
        out.append(('/wall', pose(100 * NS + ns + step_ns // 3, 0.5 * math.sin(5 * t))))
    return out


def shuffled(messages, chance):
    """In order of arrival, each under way for less than `reorder`."""
    return sorted(messages, key=lambda m: m[1].header.stamp.to_nsec() + chance.randrange(90000000))


class Live:
    """The node under test, what it says, and how to talk to it."""

    def __init__(self, children, node, scene, environment):
        import rosgraph
        self.children, self.node, self.environment = children, node, environment
        self.heard, self.numbers, self.clock = [], {}, 0
        self.master = rosgraph.Master('/mishaps_test')
        self.master.setParam('/collision_node/scene', scene)
        self.process = children.start(node, env=environment)

    def listen(self):
        import rospy
        from collision_node.msg import Impact
        from diagnostic_msgs.msg import DiagnosticArray
        from std_srvs.srv import Trigger
        self.listener = rospy.Subscriber('/collision_node/impacts', Impact, self.heard.append)
        self.watcher = rospy.Subscriber('/diagnostics', DiagnosticArray, self.note)
        self.flush_service = rospy.ServiceProxy('/collision_node/flush', Trigger)
        self.reset_service = rospy.ServiceProxy('/collision_node/reset', Trigger)
        self.advertise()

    def advertise(self):
        import rospy
        from geometry_msgs.msg import PoseStamped
        self.publishers = {topic: rospy.Publisher(topic, PoseStamped, queue_size=100000) for topic in TOPICS}
        self.wait_connected()

    def wait_connected(self):
        wait(self.children, 'connections', lambda: self.listener.get_num_connections() == 1 and
             self.watcher.get_num_connections() == 1 and
             all(p.get_num_connections() == 1 for p in self.publishers.values()))

    def note(self, array):
        self.clock = array.header.stamp.to_nsec()
        for status in array.status:
            self.numbers = {value.key: value.value for value in status.values}

    def count(self):
        return sum(int(self.numbers.get(key, 0)) for key in ('accepted', 'late', 'duplicate', 'rejected'))

    def publish(self, messages):
        for topic, message in messages:
            self.publishers[topic].publish(message)

    def take(self, name, messages, expected, publish=None):
        """One round: an epoch of its own."""
        before = self.count()
        del self.heard[:]
        (publish or self.publish)(messages)
        wait(self.children, 'the poses of round "%s"' % name, lambda: self.count() >= before + len(messages))
        self.flush_service()
        wait(self.children, 'the events of round "%s"' % name, lambda: len(self.heard) >= len(expected))
        events = [told(impact) for impact in self.heard]
        print('%-24s %d poses, %d events, lost %s' % (name, len(messages), len(events), self.numbers['lost']))
        if events != expected:
            sys.exit('round "%s" differs from replay:\n%s\n%s' % (name, events, expected))
        self.reset_service()


def main():
    node, replay = sys.argv[1:3]
    chance = random.Random(SEED)
    print('seed %d' % SEED)
    with tempfile.TemporaryDirectory() as folder, Children() as children:
        port = free_port()
        environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:%d' % port, ROS_IP='127.0.0.1', HOME=folder)
        os.environ.update(environment)
        start_master = lambda: children.start('rosmaster', '--core', '-p', str(port), env=environment)
        master = start_master()
        scene = pathlib.Path(folder, 'scene.yaml')
        scene.write_text(SCENE)

        import rosgraph  # after the environment: they read it on import
        import rospy
        from rosgraph_msgs.msg import Clock
        wait(children, 'the master', rosgraph.is_master_online)
        live = Live(children, node, str(scene), environment)
        live.master.setParam('/use_sim_time', True)
        rospy.init_node('mishaps_test', disable_signals=True)
        live.listen()

        messages = stream(20000000, 2 * NS)
        _, expected = replayed(replay, folder, messages, environment)
        if len(expected) < 6:
            sys.exit('the scene has too few events to compare: %s' % expected)
        live.take('in order', messages, expected)
        live.take('shuffled', shuffled(messages, chance), expected)

        some = [m for m in messages if chance.random() > 0.1]
        _, expected_of_some = replayed(replay, folder, some, environment)
        live.take('with losses', some, expected_of_some)

        def with_a_death(these):
            half = len(these) // 2
            before = live.count()
            live.publish(these[:half])
            wait(children, 'the first half', lambda: live.count() >= before + half)
            for publisher in live.publishers.values():
                publisher.unregister()
            live.advertise()
            live.publish(these[half:])
        live.take('publishers born again', messages, expected, with_a_death)

        clock = rospy.Publisher('/clock', Clock, queue_size=1, latch=True)
        clock.publish(rospy.Time(7))
        live.take('a clock that stands', messages, expected)

        # Stamps that go on, and a clock that does not: an epoch of its own, as if these were all the poses there are.
        first, second = [[m for m in messages if (m[1].header.stamp.to_nsec() < 101 * NS) == early]
                         for early in (True, False)]
        _, expected_of_second = replayed(replay, folder, second, environment)
        before = live.count()
        del live.heard[:]
        live.publish(first)
        wait(children, 'the poses before the clock goes back', lambda: live.count() >= before + len(first))
        clock.publish(rospy.Time(3))
        wait(children, 'the clock to go back', lambda: live.clock == 3 * NS)
        live.publish(second)
        wait(children, 'the poses behind it', lambda: live.count() >= before + len(messages))
        live.flush_service()
        newest = lambda: [told(i) for i in list(live.heard) if i.epoch == live.heard[-1].epoch]
        wait(children, 'the events behind it', lambda: live.heard and len(newest()) >= len(expected_of_second))
        if len({impact.epoch for impact in live.heard}) != 2 or newest() != expected_of_second:
            sys.exit('the epoch behind a clock that went back differs from replay:\n%s\n%s' % (
                newest(), expected_of_second))
        print('%-24s %d events' % ('a clock that goes back', len(expected_of_second)))
        live.reset_service()

        fast = stream(500000, 2 * NS)
        bag_file, expected_of_fast = replayed(replay, folder, fast, environment)
        for rate in PLAYED_RATES:
            def played(_):
                wait(children, 'the old player to be gone', lambda: all(
                    len(names) <= 1 for topic, names in live.master.getSystemState()[0] if topic in TOPICS))
                subprocess.run(['/usr/lib/rosbag/play', bag_file, '-q', '-r', str(rate), '-d', '1', '--queue=1000000',
                                '--wait-for-subscribers'], check=True, env=environment, stdin=subprocess.DEVNULL,
                               stdout=subprocess.DEVNULL)
            live.take('played at %g' % rate, fast, expected_of_fast, played)

        children.stop(master)
        start_master()
        wait(children, 'the master again', rosgraph.is_master_online)
        # roscpp says nothing of itself to a new master: nobody new finds the node until it starts again (README).
        if any('/collision_node' in names for _, names in live.master.getSystemState()[1]):
            sys.exit('the node has registered with the new master; the README says that it does not')
        # Whoever was connected stays so.
        before = live.count()
        live.publish(messages)
        wait(children, 'poses without the old master', lambda: live.count() >= before + len(messages))

        live.master.setParam('/collision_node/scene', str(scene))
        refused = subprocess.run([node, '__name:=refused', '_scene:=' + str(scene), '_plan:=nothing'], env=environment,
                                 capture_output=True, text=True, timeout=60)
        if refused.returncode == 0 or '~plan: must be lean' not in refused.stdout + refused.stderr:
            sys.exit('~plan: nothing was not refused: %s' % refused)
        live.master.setParam('/collision_node/plan', 'full')  # every pair on every piece: the same events
        children.stop(live.process)
        live.numbers = {}
        for endpoint in (live.listener, live.watcher, *live.publishers.values()):
            endpoint.unregister()
        live.process = children.start(node, env=environment)
        live.listen()
        live.take('a node born again', messages, expected)

        # The end of a node is the end of its data: what has come is decided and told.
        before = live.count()
        del live.heard[:]
        live.publish(messages)
        wait(children, 'the last poses', lambda: live.count() >= before + len(messages))
        children.stop(live.process)
        wait(children, 'the last events', lambda: len(live.heard) >= len(expected))
        if [told(impact) for impact in live.heard] != expected:
            sys.exit('what the node said at its end differs from replay')
        print('the end of a node: %d events' % len(expected))
    return 0


if __name__ == '__main__':
    sys.exit(main())

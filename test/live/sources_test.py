#!/usr/bin/python3
"""Every kind of source, live: the node says what replay says of the same messages.

    sources_test.py path/to/collision_node path/to/replay

One node; each round gives it another scene through ~reload_scene: a tf chain, a robot whose links have tf frames, one
moved by joint states, a whole path sent ahead of its time, gazebo's models. At last a queue that overflows.
"""

import math
import os
import pathlib
import signal
import sys
import tempfile
import xmlrpc.client

from comparison import replayed, told
from processes import Children, free_port, wait

NS = 1000000000
TIME = 'time: {reorder: 0.1, max_gap: 1.0, timeout: 10, jump: 0.5}\n'

ROBOT = """<robot name='r'>
  <link name='base'><collision><geometry><box size='0.4 0.4 0.1'/></geometry></collision></link>
  <link name='arm'><collision><origin xyz='0.5 0 0'/><geometry><box size='1 0.1 0.1'/></geometry></collision></link>
  <link name='hand'><collision><geometry><sphere radius='0.1'/></geometry></collision></link>
  <joint name='turn' type='continuous'><parent link='base'/><child link='arm'/><origin xyz='0 0 0.2'/>
    <axis xyz='0 0 1'/></joint>
  <joint name='reach' type='prismatic'><parent link='arm'/><child link='hand'/><origin xyz='1.2 0 0'/>
    <axis xyz='1 0 0'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>
</robot>"""
POLE = "  pole: {cylinder: {radius: 0.1, length: 2}, pose: {fixed: {position: [0.3, 1.4, 0]}}}\n"


def stamped(message, stamp_ns, frame):
    import rospy
    message.header.frame_id = frame
    message.header.stamp = rospy.Time(100 + stamp_ns // NS, stamp_ns % NS)
    return message


def pose(stamp_ns, x, yaw=0.0):
    from geometry_msgs.msg import PoseStamped
    message = stamped(PoseStamped(), stamp_ns, 'world')
    message.pose.position.x = x
    message.pose.orientation.z, message.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def transform(stamp_ns, parent, child, x, z=0.0, yaw=0.0):
    from geometry_msgs.msg import TransformStamped
    from tf2_msgs.msg import TFMessage
    message = stamped(TransformStamped(), stamp_ns, parent)
    message.child_frame_id = child
    message.transform.translation.x, message.transform.translation.z = x, z
    message.transform.rotation.z, message.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return TFMessage([message])


def times(step_ms, end_ms=2000):
    return [(ms * 1000000, ms * 1e-3) for ms in range(0, end_ms + 1, step_ms)]


def of_a_chain():
    out = [('/tf_static', transform(0, 'base', 'ball', -10.0))]
    out += [('/tf', transform(ns, 'world', 'odom', 5 * t, yaw=0.1 * t)) for ns, t in times(70)]
    out += [('/tf', transform(ns, 'odom', 'base', 15 * t)) for ns, t in times(30)]
    return out


def of_links():
    out = [('/tf', transform(ns, 'world', 'r/base', 0.1 * t)) for ns, t in times(50)]
    out += [('/tf', transform(ns, 'r/base', 'r/arm', 0.0, 0.2, 2 * t)) for ns, t in times(30)]
    return out + [('/tf', transform(ns, 'r/arm', 'r/hand', 1.2 + 0.2 * t)) for ns, t in times(40)]


def of_joints():
    from sensor_msgs.msg import JointState
    out = [('/base', pose(ns, 0.1 * t)) for ns, t in times(50)]
    for ns, t in times(30):
        out.append(('/joint_states', stamped(JointState(name=['turn'], position=[2 * t]), ns, '')))
    for ns, t in times(40):
        out.append(('/joint_states', stamped(JointState(name=['wheel', 'reach'], position=[9, 0.2 * t]), ns, '')))
    return out


def of_a_path():
    """All of twenty seconds at once, then once more with what follows, beside a wall that sends as time goes."""
    from nav_msgs.msg import Path
    poses = [pose(ns, 3 * math.sin(9 * t)) for ns, t in times(20, 20000)]
    out = [('/path', stamped(Path(poses=poses[:n]), 0, 'world')) for n in (900, len(poses))]
    return out + [('/wall', pose(ns, 0.5 * math.sin(5 * t))) for ns, t in times(50)]


def model_states():
    """The class, made here: gazebo_msgs is no dependency."""
    import genpy.dynamic
    from geometry_msgs.msg import Pose, Twist
    line = '\n' + '=' * 80 + '\nMSG: geometry_msgs/'
    text = ('string[] name\ngeometry_msgs/Pose[] pose\ngeometry_msgs/Twist[] twist\n' + line + 'Pose\n' +
            Pose._full_text + line + 'Twist\n' + Twist._full_text)
    made = genpy.dynamic.generate_dynamic('gazebo_msgs/ModelStates', text)['gazebo_msgs/ModelStates']
    if made._md5sum != '48c080191eb15c41858319b4d8a609c2':
        sys.exit('this is not gazebo_msgs/ModelStates: ' + made._md5sum)
    return made


def of_gazebo(model_states_type):
    from geometry_msgs.msg import Pose, Twist
    out = []
    for _, t in times(100):
        message = model_states_type(name=['ground', 'ball'], pose=[Pose(), Pose()], twist=[Twist(), Twist()])
        message.pose[1].position.x = 3 - 3 * t
        for one in message.pose:
            one.orientation.w = 1
        out.append(('/gazebo/model_states', message))
    return out


BALL_AND_WALL = "objects:\n  ball: {sphere: {radius: 0.1}, pose: {%s}}\n  wall: {box: {size: [0.1, 20, 20]}, pose: {%s}}\n"
ROBOT_AND_POLE = "objects:\n  robot: {urdf: robot.urdf, %s}\n" + POLE + "pairs: {self: true}\n"


class Live:
    """The node under test, what it says, and how to talk to it."""

    def __init__(self, children, node, folder, environment):
        import rosgraph
        import rospy
        from collision_node.msg import Impact, IntervalStats
        from diagnostic_msgs.msg import DiagnosticArray
        from std_srvs.srv import Trigger
        self.children, self.folder = children, folder
        self.heard, self.beats, self.numbers, self.message, self.publishers = [], [], {}, '', {}
        self.master = rosgraph.Master('/sources_test')
        self.write(BALL_AND_WALL % ('fixed: {}', 'fixed: {position: [5, 0, 0]}'))
        self.master.setParam('/collision_node/scene', str(folder / 'scene.yaml'))
        self.process = children.start(node, env=environment)
        self.services = {name: rospy.ServiceProxy('/collision_node/' + name, Trigger)
                         for name in ('flush', 'reload_scene')}
        self.listeners = [rospy.Subscriber('/collision_node/impacts', Impact, self.heard.append),
                          rospy.Subscriber('/collision_node/stats', IntervalStats, self.beats.append),
                          rospy.Subscriber('/diagnostics', DiagnosticArray, self.note)]
        wait(children, 'the node', lambda: all(s.get_num_connections() == 1 for s in self.listeners))

    def write(self, scene):
        (self.folder / 'scene.yaml').write_text(scene + TIME)

    def note(self, array):
        for status in array.status:
            self.message = status.message
            self.numbers = {value.key: value.value for value in status.values}

    def count(self, key):
        return int(self.numbers.get(key, 0))

    def called(self):
        """The topics on which the node is connected to a publisher."""
        node = xmlrpc.client.ServerProxy(self.master.lookupNode('/collision_node'))
        return {link[4] for link in node.getBusInfo('/sources_test')[2] if link[2] == 'i'}

    def load(self, messages):
        """Another scene: whatever is open of the old one ends, and its epoch with it."""
        import rospy
        for publisher in self.publishers.values():
            publisher.unregister()
        # What comes back while the node still hangs up on it, or calls it for another scene, is not called again.
        wait(self.children, 'the node to hang up', lambda: not self.called() & set(self.publishers))
        answer = self.services['reload_scene']()
        if not answer.success:
            sys.exit('the scene was refused: ' + answer.message)
        kinds = dict((topic, type(message)) for topic, message in messages)
        self.publishers = {topic: rospy.Publisher(topic, kind, queue_size=100000) for topic, kind in kinds.items()}
        wait(self.children, 'connections', lambda: all(
            p.get_num_connections() == 1 for p in self.publishers.values()))

    def send(self, name, messages):
        before = self.count('messages')
        del self.heard[:], self.beats[:]
        for topic, message in messages:
            self.publishers[topic].publish(message)
        wait(self.children, 'the messages of "%s"' % name, lambda: self.count('messages') >= before + len(messages))
        self.services['flush']()

    def compare(self, name, messages, expected):
        self.load(messages)
        self.send(name, messages)
        wait(self.children, 'the events of "%s"' % name, lambda: len(self.heard) >= len(expected))
        events = [told(impact) for impact in self.heard]
        print('%-16s %d messages, %d events' % (name, len(messages), len(events)))
        if events != expected:
            sys.exit('"%s" differs from replay:\n%s\n%s' % (name, events, expected))
        if len({impact.epoch for impact in self.heard}) != 1:
            sys.exit('"%s": more than one epoch' % name)


def check_gazebo(live, model_states_type):
    """The stamps are guessed, so replay has others; what happens is the same."""
    messages = of_gazebo(model_states_type)
    live.write(BALL_AND_WALL % ('topic: gazebo/model_states, model: ball', 'fixed: {}'))
    live.load(messages)
    live.send('gazebo', messages)
    wait(live.children, 'the events of gazebo', lambda: len(live.heard) >= 2)
    said = [(i.kind, i.certificate, i.reason) for i in live.heard]
    if said != [(0, 2, 6), (1, 2, 6)]:
        sys.exit('gazebo: %s' % said)
    # The ball comes from 3 m: it touches at x = 0.05, whatever the stamps.
    if abs(live.heard[0].position.x - 0.05) > 1e-6 + live.heard[0].position_error:
        sys.exit('gazebo: in the wrong place: %s' % live.heard[0].position)
    wait(live.children, 'a heartbeat', lambda: live.beats)
    if not all(beat.pairs_clear == beat.pairs_culled == 0 for beat in live.beats):
        sys.exit('gazebo: guessed stamps were called clear')
    print('gazebo           2 events, STAMP_GUESSED')


def check_left_out(live):
    """What is in no pair is not subscribed; once the scene pairs it, it is."""
    scene = BALL_AND_WALL % ('topic: ball', 'fixed: {}') + '  zero: {point: {}, pose: {topic: zero}}\n' \
        '  scout: {point: {}, pose: {tf: scout}}\n'

    def heard():
        return {topic for topic, nodes in live.master.getSystemState()[1] if '/collision_node' in nodes}
    live.write(scene + 'pairs: {only: [[ball, wall]]}\n')
    live.load([('/ball', pose(0, 0))])
    if '/ball' not in heard() or heard() & {'/zero', '/tf', '/tf_static'}:
        sys.exit('subscribed, with zero and scout in no pair: %s' % heard())
    live.send('ball', [('/ball', pose(i * NS // 10, 0.0)) for i in range(30)])
    wait(live.children, 'a heartbeat of the ball alone', lambda: live.beats)
    if any(beat.uncovered_objects or beat.pairs_uncovered for beat in live.beats):
        sys.exit('waited for what is in no pair: %s' % live.beats)
    live.write(scene)
    live.load([('/ball', pose(0, 0))])
    wait(live.children, 'all to be subscribed', lambda: {'/ball', '/zero', '/tf', '/tf_static'} <= heard())
    print('left out         not subscribed, until a pair needs it')


def check_overflow(live):
    """A queue of ten, and a node that sleeps through a burst: what is lost is counted, and its topic named."""
    live.write(BALL_AND_WALL % ('topic: ball', 'fixed: {}'))
    live.master.setParam('/collision_node/queue', 10)
    burst = 20000
    live.load([('/ball', pose(0, 0))])
    live.send('the first ball', [('/ball', pose(0, 5.0))])  # numbers are missed from the first that comes
    before, lost_before, sent = live.count('messages'), live.count('lost'), 0
    while live.count('lost') == lost_before:
        os.killpg(live.process.pid, signal.SIGSTOP)
        for i in range(burst):
            live.publishers['/ball'].publish(pose((sent + i + 1) * 100000, 5.0))
        os.killpg(live.process.pid, signal.SIGCONT)
        sent += burst
        # The newest is never dropped, so all that is missing before it has been seen.
        wait(live.children, 'all of the burst, or word of it',
             lambda: live.count('messages') - before + live.count('lost') - lost_before >= sent)
    taken, lost = live.count('messages') - before, live.count('lost') - lost_before
    if taken + lost != sent or int(live.numbers.get('lost on /ball', 0)) != lost:
        sys.exit('%d sent, %d taken, %s lost' % (sent, taken, live.numbers))
    if 'messages lost on /ball' not in live.message:
        sys.exit('the topic is not named: ' + live.message)
    print('overflow         %d sent, %d lost and counted' % (sent, lost))


def main():
    node, replay = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as place, Children() as children:
        port = free_port()
        folder = pathlib.Path(place)
        environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:%d' % port, ROS_IP='127.0.0.1', HOME=place)
        os.environ.update(environment)
        children.start('rosmaster', '--core', '-p', str(port), env=environment)

        import rosgraph  # after the environment: they read it on import
        import rospy
        wait(children, 'the master', rosgraph.is_master_online)
        rospy.init_node('sources_test', disable_signals=True)
        (folder / 'robot.urdf').write_text(ROBOT)
        live = Live(children, node, folder, environment)
        for name, scene, messages in (
                ('tf chain', BALL_AND_WALL % ('tf: ball', 'fixed: {}'), of_a_chain()),
                ('links', ROBOT_AND_POLE % 'pose: {tf: r/base, links: true}', of_links()),
                ('joint states', ROBOT_AND_POLE % 'pose: {topic: base}, joints: {topic: joint_states}', of_joints()),
                ('path', BALL_AND_WALL % ('topic: path', 'topic: wall'), of_a_path())):
            live.write(scene)
            _, expected = replayed(replay, place, messages, environment)
            if len(expected) < 2:
                sys.exit('"%s" has too few events to compare: %s' % (name, expected))
            live.compare(name, messages, expected)
        check_gazebo(live, model_states())
        check_left_out(live)
        check_overflow(live)
        # A scene that cannot be read leaves the old one at work.
        live.write('objects: {}\n')
        if live.services['reload_scene']().success:
            sys.exit('an empty scene was taken')
        live.send('the old scene', [('/ball', pose(100 * NS, 5.0))])
    return 0


if __name__ == '__main__':
    sys.exit(main())

#!/usr/bin/python3
"""Writes the demo into a folder (default: this one): tank.urdf, meshes/, efp_tank.bag and truth.json.

A tank drives straight at 15 m/s. From a target-sensitivity projectile that sinks on its parachute some 150 m
away four explosively formed projectiles are fired at it at more than 2000 m/s. Everything is streamed at 30 Hz,
so a shot moves about 70 m between two of its poses and no stamp shows contact. After a hit the shots simply go
on. The output depends on nothing but this folder's scripts and scene.yaml's radii and zones.
"""

import argparse
import math
import pathlib
import shutil

import genpy
import rosbag
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

import tank_shapes
import truth

START_NS = 1700000000123456789
PERIOD_NS = 33333333
DURATION_NS = 4000000000
TANK_YAW = 0.35          # [rad], constant
TANK_SPEED = 15.0        # [m/s]
TANK_START_NS = START_NS + 2030000000  # when the tank passes the world's origin
TSP_SINK = 9.0           # [m/s]
TSP_OFFSET = (-0.8, 128.0)  # [m] where it hangs, seen from the origin: forward, left

# name: release [ns after START], speed [m/s], where the line meets the tank (tank frame) [m], message type
SHOTS = {
    'efp_1': (1600000417, 2053.0, (-0.83, 0.87, 1.88), Odometry),
    'efp_2': (1911000203, 2391.0, (-2.83, 0.21, 1.40), PoseStamped),
    'efp_3': (2217000611, 2309.0, (2.79, 0.02, 1.49), Odometry),
    'efp_4': (2523000819, 2087.0, (-0.31, 0.11, 4.20), Odometry),
}


class Jitter:
    """A small fixed pseudo-random sequence (Lehmer), so that stamps are as uneven as real ones and never change."""

    def __init__(self, seed):
        self.state = seed

    def ns(self, width):
        self.state = self.state * 48271 % 2147483647
        return self.state % (2 * width + 1) - width


def stamps(first_ns, last_ns, seed):
    jitter = Jitter(seed)
    result, tick = [], first_ns
    while tick <= last_ns:
        result.append(tick if not result else tick + jitter.ns(400000))
        tick += PERIOD_NS
    return result


def tank_position(stamp_ns):
    way = TANK_SPEED * ((stamp_ns - TANK_START_NS) * 1e-9)
    return (way * math.cos(TANK_YAW), way * math.sin(TANK_YAW), 0.0)


def from_tank(point, stamp_ns):
    """World position of a point in the tank's frame."""
    c, s = math.cos(TANK_YAW), math.sin(TANK_YAW)
    x, y, z = tank_position(stamp_ns)
    return (x + c * point[0] - s * point[1], y + s * point[0] + c * point[1], z + point[2])


def tsp_position(stamp_ns):
    x, y, _ = from_tank(TSP_OFFSET + (0.0,), TANK_START_NS)
    return (x, y, 77.0 - TSP_SINK * ((stamp_ns - TANK_START_NS) * 1e-9))


def yaw_quaternion(yaw):
    return (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))


def quaternion_to(direction):
    """Turns z to `direction` by the shortest way; a shot's own axis z points along its flight."""
    x, y, z = direction
    length = math.sqrt(y * y + x * x + (1 + z) * (1 + z))
    return (-y / length, x / length, 0.0, (1 + z) / length)


def flight(name):
    """Release position, unit direction and velocity of a shot: 2 m clear of the projectile that fires it."""
    release, speed, aim, _ = SHOTS[name]
    release_ns = START_NS + release
    muzzle = tsp_position(release_ns)
    hit_ns = release_ns
    for _ in range(20):  # the tank drives on while the shot flies: a contraction by 15/2000
        target = from_tank(aim, hit_ns)
        way = [b - a for a, b in zip(muzzle, target)]
        distance = math.sqrt(sum(w * w for w in way))
        hit_ns = release_ns + round((distance - 2.0) / speed * 1e9)
    direction = [w / distance for w in way]
    start = [p + 2.0 * d for p, d in zip(muzzle, direction)]
    return start, direction, [speed * d for d in direction]


def ros_time(stamp_ns):
    return genpy.Time(stamp_ns // 10**9, stamp_ns % 10**9)


def fill(pose, position, quaternion):
    pose.position.x, pose.position.y, pose.position.z = position
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = quaternion


def transform(parent, child, stamp_ns, translation, quaternion):
    message = TransformStamped()
    message.header.stamp = ros_time(stamp_ns)
    message.header.frame_id, message.child_frame_id = parent, child
    message.transform.translation.x, message.transform.translation.y, message.transform.translation.z = translation
    (message.transform.rotation.x, message.transform.rotation.y, message.transform.rotation.z,
     message.transform.rotation.w) = quaternion
    return message


def tank_messages():
    for stamp_ns in stamps(START_NS, START_NS + DURATION_NS, 11):
        message = PoseStamped()
        message.header.stamp, message.header.frame_id = ros_time(stamp_ns), 'world'
        fill(message.pose, tank_position(stamp_ns), yaw_quaternion(TANK_YAW))
        yield '/tank/pose', stamp_ns, message


def shot_messages(name, seed):
    release, speed, _, kind = SHOTS[name]
    release_ns = START_NS + release
    start, direction, velocity = flight(name)
    for stamp_ns in stamps(release_ns, release_ns + 6 * PERIOD_NS, seed):
        seconds = (stamp_ns - release_ns) * 1e-9
        message = kind()
        message.header.stamp, message.header.frame_id = ros_time(stamp_ns), 'world'
        position = [p + v * seconds for p, v in zip(start, velocity)]
        if kind is Odometry:
            message.child_frame_id = name
            fill(message.pose.pose, position, quaternion_to(direction))
            message.twist.twist.linear.z = speed  # in the child's frame, whose z is the flight
            yield '/%s/odom' % name, stamp_ns, message
        else:
            fill(message.pose, position, quaternion_to(direction))
            yield '/%s/pose' % name, stamp_ns, message


def tsp_messages():
    """The canopy moves in /tf; the projectile hangs 1.5 m under it by a static transform."""
    static = transform('tsp/canopy', 'tsp/case', START_NS, (0.0, 0.0, -1.5), (0.0, 0.0, 0.0, 1.0))
    yield '/tf_static', START_NS, TFMessage([static])
    for stamp_ns in stamps(START_NS + 7000000, START_NS + DURATION_NS, 23):
        x, y, z = tsp_position(stamp_ns)
        spin = 2.0 * ((stamp_ns - START_NS) * 1e-9)
        yield '/tf', stamp_ns, TFMessage([transform('world', 'tsp/canopy', stamp_ns, (x, y, z + 1.5), yaw_quaternion(spin))])


def write_bag(path):
    """All streams, in order of arrival: a few milliseconds after their stamps, as over a network."""
    streams = [tank_messages(), tsp_messages()]
    streams += [shot_messages(name, 31 + i) for i, name in enumerate(sorted(SHOTS))]
    rows = []
    for seed, stream in enumerate(streams):
        jitter = Jitter(101 + seed)
        rows += [(stamp + 3000000 + jitter.ns(1500000), topic, message) for topic, stamp, message in stream]
    rows.sort(key=lambda row: row[:2])
    sequence = {}
    with rosbag.Bag(str(path), 'w', compression='lz4') as bag:
        for arrival_ns, topic, message in rows:
            if hasattr(message, 'header'):
                message.header.seq = sequence[topic] = sequence.get(topic, -1) + 1
            latch = None
            if topic == '/tf_static':
                latch = {'topic': topic, 'type': message._type, 'md5sum': message._md5sum,
                         'message_definition': message._full_text, 'latching': '1', 'callerid': '/make_demo'}
            bag.write(topic, message, ros_time(arrival_ns), connection_header=latch)


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folder', nargs='?', type=pathlib.Path, default=here, help='where to write (default: %(default)s)')
    folder = parser.parse_args().folder.resolve()
    tank_shapes.write_tank(folder)
    if folder != here:
        shutil.copy(here / 'scene.yaml', folder / 'scene.yaml')
    write_bag(folder / 'efp_tank.bag')
    truth.write(folder / 'truth.json', folder)


if __name__ == '__main__':
    main()

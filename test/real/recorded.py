#!/usr/bin/python3
"""Replays what a real robot recorded and compares with sampling and bisection (sampled.py).

    recorded.py husky|mustang|ardrone path/to/replay folder/of/bags

Exit 0 fine, 1 wrong, 77 the recording is not there (skipped).
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import rosbag
import yaml

import sampled

BAGS = {'husky': 'husky_outdoor_2015.bag', 'mustang': 'mustang_utm_2014.bag', 'ardrone': 'ardrone_2013.bag'}
SLACK = 1e-10  # [s] what doubles in sampled.py may be off: well under a nanometre at these speeds


def run_replay(replay, scene, bag):
    """(events, last heartbeat) of one replay; exits when it fails."""
    with tempfile.TemporaryDirectory() as folder:
        lines, result = pathlib.Path(folder, 'events.jsonl'), pathlib.Path(folder, 'result.bag')
        done = subprocess.run([replay, scene, bag, '--jsonl', lines, '--out', result], capture_output=True, text=True,
                              check=False)
        if done.returncode != 0:
            sys.exit('replay %s: exit code %d\n%s%s' % (bag, done.returncode, done.stdout, done.stderr))
        with rosbag.Bag(str(result)) as written:
            stats = [message for _, message, _ in written.read_messages(topics=['/collision_node/stats'])]
        return [json.loads(line) for line in lines.read_text(encoding='utf-8').splitlines()], stats[-1]


def read_segments(bag, topic):
    poses = []
    with rosbag.Bag(str(bag)) as recording:
        for _, message, _ in recording.read_messages(topics=['/' + topic.lstrip('/')]):
            stamp, pose = message.header.stamp, message.pose.pose
            p, q = pose.position, pose.orientation
            poses.append((stamp.secs * 10**9 + stamp.nsecs, (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)))
    return [sampled.Segment(a, b) for a, b in zip(poses, poses[1:])]


def check_point(event, robot_size, segment, s, name, obstacle):
    """Faults of the event's point: it must lie on the robot's box, and on the obstacle when that is a ball."""
    point, error = tuple(event['position'][axis] for axis in 'xyz'), event['position_error'] + 1e-8
    p, q = segment.at(s, point)
    on_robot = sampled.outside(sampled.back(q, tuple(-c for c in p)), [size / 2 for size in robot_size])
    faults = [] if abs(on_robot) <= error else ['%s: point is %.3g m off the robot, ball %.3g m' % (name, on_robot, error)]
    if 'sphere' in obstacle:
        off = math.dist(point, obstacle['pose']['fixed']['position']) - obstacle['sphere']['radius']
        if abs(off) > error:
            faults.append('%s: point is %.3g m off the ball, ball of error %.3g m' % (name, off, error))
    return faults


def compare(scene, bag, events):
    """Faults, one line each, and how many changes of contact there truly are."""
    objects = scene['objects']
    robot = next(name for name, value in objects.items() if 'topic' in value['pose'])
    size = objects[robot]['box']['size']
    segments = read_segments(bag, objects[robot]['pose']['topic'])
    faults, total, seen = [], 0, 0
    for name in sorted(set(objects) - {robot}):
        gap, reach = sampled.gap_function(size, objects[name])
        true = sampled.changes(segments, gap, reach, objects[name]['pose']['fixed']['position'])
        said = [e for e in events if name in (e['a']['object'], e['b']['object'])]
        total, seen = total + len(true), seen + len(said)
        if [kind for kind, _, _ in true] != [event['kind'] for event in said]:
            faults.append('%s: true changes %s, replay says %s' % (name, [k for k, _, _ in true], [e['kind'] for e in said]))
            continue
        for (kind, segment, s), event in zip(true, said):
            late = (segment.start_ns - event['interval_start']) * 1e-9 + s
            print('%-8s %-10s bracket minus truth %+.1e .. %+.1e s, ball %.1e m, %s %s' % (
                name, kind, event['toi_lower'] - late, event['toi_upper'] - late, event['position_error'],
                event['certificate'], event['reason']))
            if not event['toi_lower'] - SLACK <= late <= event['toi_upper'] + SLACK:
                faults.append('%s: %s is not in its bracket' % (name, kind))
            if event['certificate'] != 'CONFIRMED':
                faults.append('%s: %s is %s, reason %s' % (name, kind, event['certificate'], event['reason']))
            faults += check_point(event, size, segment, s, name, objects[name])
    if seen != len(events):
        faults.append('%d events name none of the obstacles' % (len(events) - seen))
    return faults, total


def check_ardrone(bag, events, stats):
    """Every pose has the quaternion (0, 0, 0, 0): all are rejected and counted, nothing is said to be clear."""
    with rosbag.Bag(str(bag)) as recording:
        count = recording.get_message_count('/ardrone/odometry/raw')
    said = {'accepted': stats.accepted, 'rejected': stats.rejected, 'watermark': stats.watermark.to_nsec(),
            'pairs_uncovered': stats.pairs_uncovered, 'pairs_clear': stats.pairs_clear + stats.pairs_culled}
    right = {'accepted': 0, 'rejected': count, 'watermark': 0, 'pairs_uncovered': 1, 'pairs_clear': 0}
    print(said)
    return ['an event from invalid poses: %s' % event for event in events] + [
        '%s is %d, %d is right' % (key, said[key], right[key]) for key in right if said[key] != right[key]]


def main():
    name, replay, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    bag = folder / BAGS[name]
    if not bag.exists():
        print('SKIPPED: %s is not there' % bag)
        return 77
    scene = pathlib.Path(__file__).resolve().parent / (name + '.yaml')
    events, stats = run_replay(replay, scene, bag)
    if name == 'ardrone':
        faults = check_ardrone(bag, events, stats)
    else:
        faults, total = compare(yaml.safe_load(scene.read_text(encoding='utf-8')), bag, events)
        if total < 6:
            faults.append('only %d true changes of contact: this recording would prove nothing' % total)
    print('\n'.join(faults) or 'all right')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())

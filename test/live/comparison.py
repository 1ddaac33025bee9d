"""Events of a live node beside those that replay finds in the same messages."""

import json
import os
import subprocess


def stamp_of(message):
    """When a bag received it: its stamp, or that of the last thing in it."""
    for inside in ('transforms', 'poses'):
        if getattr(message, inside, None):
            return getattr(message, inside)[-1].header.stamp
    return message.header.stamp


def told(impact):
    """What replay writes of an event, but for the epoch."""
    return (impact.event_id, impact.contact_id, impact.kind, impact.certificate, impact.interval_start.to_nsec(),
            impact.toi_lower, impact.toi_upper, impact.position.x, impact.position_error)


def replayed(replay, folder, messages, environment):
    """Writes scene.yaml's input into a bag: its name, and what replay makes of it."""
    import rosbag
    bag_file = os.path.join(folder, 'in.bag')
    with rosbag.Bag(bag_file, 'w') as bag:
        for topic, message in messages:
            bag.write(topic, message, stamp_of(message))
    scene = os.path.join(folder, 'scene.yaml')
    lines = subprocess.run([replay, scene, bag_file, '--jsonl', '-'], check=True, env=environment,
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout.splitlines()
    kinds = {'IMPACT': 0, 'SEPARATION': 1, 'INITIAL_OVERLAP': 2}
    certificates = {'CONFIRMED': 0, 'POSSIBLE': 1, 'UNCERTIFIED': 2}
    out = []
    for event in map(json.loads, lines):
        position = event['position']
        out.append((event['event_id'], event['contact_id'], kinds[event['kind']],
                    certificates[event['certificate']], event['interval_start'], event['toi_lower'],
                    event['toi_upper'], position[0] if isinstance(position, list) else position['x'],
                    event['position_error']))
    return bag_file, out

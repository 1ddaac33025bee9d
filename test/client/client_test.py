#!/usr/bin/python3
"""A user's package against the install space: installs ours, builds the listener against it, and has it hear the demo.

    client_test.py path/to/build path/to/install path/to/repository
"""

import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

REPOSITORY = pathlib.Path(sys.argv[3])
sys.path.insert(0, str(REPOSITORY / 'test' / 'live'))
from processes import Children, free_port, wait  # noqa: E402


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, text=True, **options)
    if done.returncode:
        sys.exit('%s failed:\n%s' % (shlex.join(command), done.stdout[-3000:]))
    return done.stdout


def installed_environment(prefix):
    """The environment after sourcing the install space, from one that knows no other workspace."""
    bare = {key: value for key, value in os.environ.items()
            if key not in ('CMAKE_PREFIX_PATH', 'ROS_PACKAGE_PATH', 'LD_LIBRARY_PATH', 'PYTHONPATH', 'PKG_CONFIG_PATH')}
    bare['PATH'] = '/usr/bin:/bin'
    text = run('bash', '-c', 'source "$0/setup.bash" && env -0', str(prefix), env=bare)
    return dict(line.split('=', 1) for line in text.split('\0') if '=' in line)


def main():
    build, prefix = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(prefix, ignore_errors=True)  # what an older build left must not help
    with tempfile.TemporaryDirectory() as folder, Children() as children:
        client = pathlib.Path(folder, 'client')
        run('cmake', '--install', build)
        environment = installed_environment(prefix)
        run('cmake', '-S', str(REPOSITORY / 'test' / 'client' / 'project'), '-B', str(client),
            '-DPYTHON_EXECUTABLE=/usr/bin/python3', '-DPython3_EXECUTABLE=/usr/bin/python3', env=environment)
        run('cmake', '--build', str(client), env=environment)

        environment.update(ROS_MASTER_URI='http://127.0.0.1:%d' % free_port(), ROS_IP='127.0.0.1', HOME=folder)
        os.environ.update(environment)
        sys.path[:0] = environment.get('PYTHONPATH', '').split(':')
        import rosgraph
        port = environment['ROS_MASTER_URI'].rsplit(':', 1)[1]
        children.start('rosmaster', '--core', '-p', port, env=environment)
        wait(children, 'the master', rosgraph.is_master_online)
        master = rosgraph.Master('/client_test')
        demo = prefix / 'share' / 'collision_node' / 'config' / 'efp_tank'
        master.setParam('/collision_node/scene', str(demo / 'scene.yaml'))
        children.start(str(prefix / 'lib' / 'collision_node' / 'collision_node'), env=environment)
        read, write = os.pipe()
        children.start(str(client / 'devel' / 'lib' / 'impact_listener' / 'listener'), env=environment, stdout=write)
        os.close(write)

        def connected():
            publishers, subscribers, _ = master.getSystemState()
            topics = '/collision_node/impacts'
            return topics in dict(publishers) and topics in dict(subscribers) and '/tank/pose' in dict(subscribers)

        wait(children, 'the node and the listener', connected)
        children.start('/usr/lib/rosbag/play', str(demo / 'efp_tank.bag'), '-q', '-d', '2', '--queue=1000000',
                       '--keep-alive', env=environment, stdin=subprocess.DEVNULL)
        os.set_blocking(read, False)
        heard = []

        def first_line():
            try:
                heard.append(os.read(read, 4096).decode())
            except BlockingIOError:
                pass
            return '\n' in ''.join(heard)

        wait(children, 'an impact to reach the listener', first_line)
        line = ''.join(heard).splitlines()[0]
        print(line)
        if line != 'efp_1 hits tank/turret':
            sys.exit("the first impact should read 'efp_1 hits tank/turret'")
    return 0


if __name__ == '__main__':
    sys.exit(main())

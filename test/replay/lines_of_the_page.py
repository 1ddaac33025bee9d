"""docs/replay.md shows the lines that run a folder of bags, and windows of a bag, over cores. They run, as they stand."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77


def lines_of(page):
    """The shell lines: indented, and beginning with a program."""
    for line in page.read_text().splitlines():
        if line.startswith("    ") and line.split()[0] in ("ls", "parallel", "replay"):
            yield line.strip()


def main():
    source, replay = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    if shutil.which("parallel") is None:
        print("GNU parallel is not installed (package `parallel`): skipped")
        return SKIPPED
    lines = list(lines_of(source / "collision_node/docs/replay.md"))
    assert len(lines) == 3, lines
    demo = source / "config/efp_tank"
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "bags").mkdir()
        for place in ("run.bag", "bags/one.bag", "bags/two.bag"):
            shutil.copy(demo / "efp_tank.bag", work / place)
        shutil.copy(demo / "scene.yaml", work / "scene.yaml")
        environment = dict(os.environ, PATH=f"{replay.parent}:{os.environ['PATH']}", HOME=folder)
        whole = subprocess.run([replay, "scene.yaml", "run.bag", "--jsonl", "-"], cwd=work, env=environment, check=True,
                               stdout=subprocess.PIPE).stdout
        assert whole.count(b"\n") > 5, whole
        for line in lines:
            print(line)
            subprocess.run(["bash", "-c", line], cwd=work, env=environment, check=True, stdin=subprocess.DEVNULL,
                           stdout=subprocess.DEVNULL)
        for place in ("run.jsonl", "bags/one.jsonl", "bags/two.jsonl"):
            assert (work / place).read_bytes() == whole, place
        assert len(list(work.glob("run.[0-9].jsonl"))) == 3
    print("every line runs, and writes the bytes of one run")
    return 0


if __name__ == "__main__":
    sys.exit(main())

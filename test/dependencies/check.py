#!/usr/bin/env python3
"""Holds the rooms' doors: who may include whom, what the core may know, what lies where.

  check.py --source DIR --build DIR   checks this tree and the dependency files of what was built from it
  check.py --self-test                checks the check: each rule must report a made-up offence

Exit 0: nothing found. 1: offences, one line each: where, what, which rule. The rules are DESIGN's: collision_node/docs/
architecture.md draws them. A dependency file is what the compiler really opened, so an offence hidden behind any
number of includes is seen; the scan of the sources sees what was not built.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile

PACKAGE = "collision_node"
CORE_TARGET = PACKAGE + "_core"
CORE = {"geometry", "motion", "impact", "scene"}
# Each room and the rooms it may include besides itself.
MAY_USE = {
    "geometry": set(),
    "motion": {"geometry"},
    "impact": {"geometry", "motion"},
    "scene": {"geometry", "motion", "impact"},
    "messages": CORE,
    "node": CORE | {"messages"},
    "replay": CORE | {"messages"},
    "report": CORE | {"messages"},
}
# The folders inside a room, and what of their room each may include besides itself. The room's own files may use all of
# them; of those files they may only use the room's ground.
INSIDE = {
    "impact": {"linear": set(), "convex": set(), "straight": set(), "proof": {"convex"},
               "walk": {"convex", "proof", "straight"}, "facts": {"convex", "proof", "walk"}},
    "scene": {"tracks": set(), "broad_phase": set(), "file": {"broad_phase"}},
}
GROUND = {
    "impact": {"pair_piece.h", "workspace.h", "four_doubles.h"},
    "scene": {"scene.h", "needs.h"},
}
TOP_LEVEL = {PACKAGE, "msg", "launch", "config", "test", "package.xml", "CMakeLists.txt", "README.md", "LICENSE",
             "CHANGELOG.rst"}
# Debian keeps ROS in /usr/include itself, so only names tell. urdfdom (urdf_model, urdf_parser ...) is not ROS.
ROS_FOLDER = re.compile(
    r"/include/(?:ros|roscpp\w*|rosbag\w*|rosconsole|roslib|roslz4|rospack|rosgraph\w*|rostest|rostime|tf|tf2|tf2_\w+|"
    r"\w+_msgs|std_srvs|nodelet\w*|pluginlib|class_loader|message_filters|diagnostic_updater|dynamic_reconfigure|"
    r"topic_tools|xmlrpcpp|actionlib|bond\w*|smclib|rviz|urdf|resource_retriever|image_transport|ament_\w+)/")
ROS_PREFIX = re.compile(r"^/opt/ros/")
GENERATED = re.compile(r"/include/%s/\w+\.h$" % PACKAGE)
HEAVY = re.compile(r'^\s*#\s*include\s*[<"]((?:assimp|urdf_\w+|urdfdom\w*|yaml-cpp)/[^>"]*)', re.M)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]%s/(\w+)/([^>"]*)' % PACKAGE, re.M)


def room_of(path, source):
    """The room a path of the tree lies in, or None."""
    parts = os.path.relpath(path, source).split(os.sep)
    return parts[1] if len(parts) > 2 and parts[0] == PACKAGE and parts[1] in MAY_USE else None


def inner_offence(name, room, included):
    """What is wrong with including `included`, a path within `room`, in the file `name` of the same room, or None."""
    parts = name.split(os.sep)
    if room not in INSIDE or len(parts) < 4:
        return None
    inner, other = parts[2], os.path.dirname(included)
    if inner not in INSIDE[room]:
        return "%s: a folder that the room's rules do not name" % name
    if other == inner or other in INSIDE[room][inner] or (not other and included in GROUND[room]):
        return None
    return "%s: includes %s/%s; %s/%s may use only %s" % (
        name, room, included, room, inner, ", ".join(sorted(INSIDE[room][inner] | GROUND[room])))


def limit(room):
    return "room %s may use only %s" % (room, ", ".join(sorted(MAY_USE[room])) or "itself")


def read(path):
    with open(path, encoding="utf-8", errors="replace") as f:
        return f.read()


def source_files(source, endings):
    for folder, folders, files in os.walk(os.path.join(source, PACKAGE)):
        folders.sort()
        for name in sorted(files):
            if name.endswith(endings):
                yield os.path.join(folder, name)


# ---------------------------------------------------------------- what the compiler opened

def parse_make_rule(text):
    """The prerequisites of the first rule of a Makefile fragment, as g++ -MD writes it."""
    text = text.replace("\\\n", " ")
    rule = text.split("\n", 1)[0]
    _, _, prerequisites = rule.partition(": ")
    return [p.replace("\\ ", " ") for p in re.split(r"(?<!\\)\s+", prerequisites.strip()) if p]


def from_dependency_files(build):
    """CMake >= 3.20, Makefiles: one .o.d beside each object."""
    for folder, _, files in os.walk(build):
        for name in sorted(files):
            if name.endswith(".o.d"):
                yield parse_make_rule(read(os.path.join(folder, name)))


def from_depend_internal(build):
    """CMake < 3.20, Makefiles: per target a list of objects, each followed by its indented prerequisites."""
    for folder, _, files in os.walk(build):
        for name in ("depend.internal", "compiler_depend.internal"):
            if name not in files:
                continue
            prerequisites = []
            for line in read(os.path.join(folder, name)).splitlines() + ["end"]:
                if line.startswith(" "):
                    prerequisites.append(line.strip())
                elif line and not line.startswith("#"):
                    if prerequisites:
                        yield prerequisites
                    prerequisites = []


def from_ninja(build):
    """Ninja keeps what the compiler wrote in its own log."""
    if not os.path.exists(os.path.join(build, "build.ninja")) or not shutil.which("ninja"):
        return
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], stdout=subprocess.PIPE, check=True).stdout.decode()
    for block in text.split("\n\n"):
        prerequisites = [line.strip() for line in block.splitlines() if line.startswith("    ")]
        if prerequisites:
            yield prerequisites


def built_files(source, build):
    """{source file of a room: everything its object was compiled from}; files no longer in the tree are left out."""
    found = {}
    for read_all in (from_dependency_files, from_depend_internal, from_ninja):
        for prerequisites in read_all(build):
            paths = [os.path.realpath(os.path.join(build, p)) for p in prerequisites]
            unit = next((p for p in paths if p.endswith(".cpp") and room_of(p, source)), None)
            if unit and os.path.exists(unit):
                found.setdefault(unit, set()).update(paths)
    return found


def check_built(source, build):
    built = built_files(source, build)
    if not any(room_of(unit, source) in CORE for unit in built):
        return ["%s: no dependency file of a core object: build the target %s first" % (build, CORE_TARGET)]
    offences = []
    for unit in source_files(source, ".cpp"):
        room = room_of(unit, source)
        name = os.path.relpath(unit, source)
        if unit not in built:
            if room in CORE:
                offences.append("%s: no dependency file: it is not part of what was built" % name)
            continue
        for path in sorted(built[unit]):
            if room in CORE and (ROS_PREFIX.search(path) or ROS_FOLDER.search(path) or GENERATED.search(path)):
                offences.append("%s: depends on the ROS header %s; the core knows no ROS" % (name, path))
            other = room_of(path, source)
            if other and other != room and other not in MAY_USE[room]:
                offences.append("%s: depends on %s; %s" % (name, os.path.relpath(path, source), limit(room)))
    return offences


# ---------------------------------------------------------------- what the sources say

def without_comments(text):
    """C++ text with comments and literals emptied, lines kept."""
    pattern = r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
    return re.sub(pattern, lambda m: "\n" * m.group(0).count("\n"), text, flags=re.S)


def namespaces(text):
    """Full names of the namespaces a C++ text opens."""
    stack, names = [], []
    for token in re.finditer(r"\bnamespace\s*([\w:]*)\s*\{|\{|\}", without_comments(text)):
        if token.group(0) == "}":
            stack[-1:] = []
        elif token.group(0) == "{":
            stack.append(None)
        else:
            stack.append(token.group(1))
            names.append("::".join(n for n in stack if n))
    return names


def check_sources(source):
    offences = []
    for path in source_files(source, (".h", ".hpp", ".cpp")):
        name = os.path.relpath(path, source)
        text = read(path)
        room = room_of(path, source)
        for match in INCLUDE.finditer(text):
            other = match.group(1)
            if room and other != room and other in MAY_USE and other not in MAY_USE[room]:
                offences.append("%s: includes room %s; %s" % (name, other, limit(room)))
            inner = inner_offence(name, room, match.group(2)) if other == room else None
            if inner:
                offences.append(inner)
        if not name.endswith(".cpp"):
            for match in HEAVY.finditer(text):
                offences.append("%s: includes %s; assimp, urdfdom and yaml-cpp belong in .cpp files" %
                                (name, match.group(1)))
            if os.path.dirname(name) == PACKAGE:
                offences.append("%s: a header directly in %s/; the generated messages share that prefix" %
                                (name, PACKAGE))
        for namespace in namespaces(text):
            parts = namespace.split("::")
            if parts[0] == PACKAGE and "ros" in parts:
                offences.append("%s: opens namespace %s; none of ours is called ros" % (name, namespace))
    return offences


def check_layout(source):
    offences = []
    ignored = set()
    if os.path.exists(os.path.join(source, ".gitignore")):
        ignored = {line.strip().strip("/") for line in read(os.path.join(source, ".gitignore")).splitlines()}
    for name in sorted(os.listdir(source)):
        if name not in TOP_LEVEL and not name.startswith(".") and name not in ignored:
            offences.append("%s: not one of the top level's entries: %s" % (name, ", ".join(sorted(TOP_LEVEL))))
    for top in sorted(TOP_LEVEL):
        for folder, folders, _ in os.walk(os.path.join(source, top)):
            if "ros" in folders:
                offences.append("%s: no folder is called ros" % os.path.relpath(os.path.join(folder, "ros"), source))
    return offences


def check_all(source, build):
    source, build = os.path.realpath(source), os.path.realpath(build)
    return check_built(source, build) + check_sources(source) + check_layout(source)


# ---------------------------------------------------------------- the check of the check

def write(root, path, text=""):
    path = os.path.join(root, path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)


def made_up_tree(root):
    """A small tree without offence; returns (source, build)."""
    source, build = os.path.join(root, "a checkout"), os.path.join(root, "build")
    for name in ("package.xml", "CMakeLists.txt", "README.md", ".gitignore"):
        write(source, name, "/build/\n")
    write(source, "build/anything")
    shape_h = source + "/collision_node/geometry/shape.h"
    include_shape = '#include "collision_node/geometry/shape.h"\n'
    write(source, "collision_node/geometry/shape.h", "namespace collision_node::geometry {}\n")
    write(source, "collision_node/geometry/shape.cpp", include_shape + "#include <yaml-cpp/yaml.h>\n")
    write(source, "collision_node/scene/engine.cpp", include_shape)
    write(source, "collision_node/node/main.cpp", "namespace ros { namespace message_traits {} }\n")
    depends(source, build, "geometry/shape.cpp", [shape_h, "/usr/include/urdf_model/link.h"])
    depends(source, build, "scene/engine.cpp", [shape_h, "/usr/include/c++/12/vector"])
    depends(source, build, "node/main.cpp", ["/usr/include/ros/ros.h", shape_h])
    return source, build


def depends(source, build, unit, headers):
    """Writes the dependency file g++ would write for `unit`."""
    paths = [os.path.join(source, PACKAGE, unit)] + headers
    rule = "x.o: \\\n " + " \\\n ".join(p.replace(" ", "\\ ") for p in paths) + "\n\nsome.h:\n"
    write(build, "CMakeFiles/%s.dir/%s/%s.o.d" % (CORE_TARGET, PACKAGE, unit), rule)


def self_test():
    """Each offence alone in an otherwise clean tree must give exactly one line, holding the words named here."""
    def header(path, text):
        return lambda s, b: write(s, PACKAGE + "/" + path, text)

    def dependency(unit, path):
        return lambda s, b: depends(s, b, unit, [path.replace("SOURCE", s)])

    def old_cmake(s, b):
        shutil.rmtree(b)
        unit, engine = (os.path.join(s, PACKAGE, u) for u in ("geometry/shape.cpp", "scene/engine.cpp"))
        write(b, "CMakeFiles/x.dir/depend.internal",
              "# CMAKE generated\n\na.o\n %s\n /usr/include/ros/time.h\nb.o\n %s\n" % (unit, engine))

    cases = [
        ("clean", lambda s, b: None, None),
        ("nothing built", lambda s, b: shutil.rmtree(b), "no dependency file of a core object"),
        ("not built", header("motion/new.cpp", ""), "motion/new.cpp: no dependency file"),
        ("roscpp", dependency("geometry/shape.cpp", "/usr/include/ros/time.h"), "ROS header /usr/include/ros/time.h"),
        ("tf2", dependency("scene/engine.cpp", "/usr/include/tf2/buffer_core.h"), "ROS header /usr/include/tf2/"),
        ("messages", dependency("scene/engine.cpp", "/usr/include/geometry_msgs/Pose.h"), "ROS header"),
        ("bag", dependency("scene/engine.cpp", "/usr/include/rosbag/bag.h"), "ROS header"),
        ("noetic", dependency("scene/engine.cpp", "/opt/ros/noetic/include/anything.h"), "ROS header"),
        ("generated", dependency("scene/engine.cpp", "/ws/devel/include/collision_node/Impact.h"), "ROS header"),
        ("old CMake", old_cmake, "ROS header /usr/include/ros/time.h"),
        ("upward", dependency("geometry/shape.cpp", "SOURCE/collision_node/scene/engine.h"), "may use only itself"),
        ("geometry uses motion", dependency("geometry/shape.cpp", "SOURCE/collision_node/motion/track.h"),
         "depends on collision_node/motion/track.h"),
        ("node uses replay", dependency("node/main.cpp", "SOURCE/collision_node/replay/x.h"), "room node may use only"),
        ("upward in a header", header("impact/bad.h", '#include "collision_node/scene/engine.h"\n'),
         "includes room scene"),
        ("up inside a room", header("scene/tracks/bad.h", '#include "collision_node/scene/engine.h"\n'),
         "scene/tracks may use only"),
        ("across a room", header("impact/proof/bad.h", '#include "collision_node/impact/walk/search.h"\n'),
         "impact/proof may use only"),
        ("down inside a room", header("impact/walk/good.h", '#include "collision_node/impact/proof/wrap.h"\n'), None),
        ("ground of a room", header("impact/walk/good.h", '#include "collision_node/impact/pair_piece.h"\n'), None),
        ("unknown folder", header("impact/more/bad.h", '#include "collision_node/impact/pair_piece.h"\n'),
         "rules do not name"),
        ("heavy", header("scene/bad.h", "#include <yaml-cpp/yaml.h>\n"), "includes yaml-cpp/yaml.h"),
        ("heavy 2", header("geometry/bad.h", "#  include <assimp/scene.h>\n"), "includes assimp/scene.h"),
        ("heavy 3", header("geometry/bad.h", "#include <urdf_model/model.h>\n"), "includes urdf_model/model.h"),
        ("direct header", header("bad.h", ""), "directly in collision_node/"),
        ("namespace", header("node/bad.h", "namespace collision_node::ros {}\n"), "namespace collision_node::ros"),
        ("nested namespace",
         header("node/bad.h", 'namespace collision_node {\nvoid f() { g("}"); }  // }\nnamespace ros {\n}}\n'),
         "namespace collision_node::ros"),
        ("folder", lambda s, b: write(s, "test/ros/x"), "test/ros: no folder is called ros"),
        ("top level", lambda s, b: write(s, "scripts/x"), "scripts: not one of the top level"),
    ]
    failures = 0
    for name, offend, expected in cases:
        with tempfile.TemporaryDirectory() as root:
            source, build = made_up_tree(root)
            offend(source, build)
            offences = check_all(source, build)
        right = offences == [] if expected is None else len(offences) == 1 and expected in offences[0]
        if not right:
            failures += 1
            print("self-test %s: expected %s, got %s" % (name, expected or "nothing", offences))
    print("self-test: %d cases, %d failures" % (len(cases), failures))
    return failures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source")
    parser.add_argument("--build")
    parser.add_argument("--self-test", action="store_true")
    arguments = parser.parse_args()
    if arguments.self_test:
        return 1 if self_test() else 0
    if not arguments.source or not arguments.build:
        parser.error("--source and --build are both needed")
    offences = check_all(arguments.source, arguments.build)
    for offence in offences:
        print(offence)
    print("dependencies: %d offences" % len(offences))
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())

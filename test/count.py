#!/usr/bin/python3
"""Prints `N passed, N failed[, N skipped]` from what ctest and the test programs wrote. Exit 1 when one failed or
none ran.

    count.py tests.json ctest.xml     (from ctest --show-only=json-v1 and ctest --output-junit)

A gtest or rostest counts by its own cases, any other ctest as one. A ctest that failed counts at least one failure,
even when its own file says nothing of it (crash, time limit, no file). A test that ctest never ran is a failure.
"""

import json
import re
import sys
import xml.etree.ElementTree as xml

PASSED, FAILED, SKIPPED = 0, 1, 2


def own_file(test):
    """Where a gtest or rostest writes its cases: catkin hands that path to its runner. None for a plain ctest."""
    return next((word for word in test.get('command', []) if word.endswith('.xml') and '/test_results/' in word), None)


def cases(file):
    """[passed, failed, skipped] of one gtest or rostest file; a damaged or missing one holds none.

    A rostest's own file says "passed" whatever happened inside; it names the files that know.
    """
    count = [0, 0, 0]
    try:
        root = xml.parse(file).getroot()
        inner = re.findall(r'results are in \[(.+?)\]', ''.join(root.itertext())) if '/rostest-' in file else []
        if inner:
            return [sum(column) for column in zip(*map(cases, inner))]
        for case in root.iter('testcase'):
            broken = case.find('failure') is not None or case.find('error') is not None
            skipped = case.find('skipped') is not None or case.get('status') == 'notrun'
            count[FAILED if broken else SKIPPED if skipped else PASSED] += 1
    except (OSError, xml.ParseError):
        return [0, 0, 0]
    return count


def outcomes(file):
    """Test name -> PASSED, FAILED or SKIPPED, as ctest saw it. ctest names a skipped test's status `notrun`."""
    result = {}
    for case in xml.parse(file).getroot().iter('testcase'):
        skipped = case.find('skipped')
        meant = skipped is not None and 'SKIP' in (skipped.get('message') or '')
        result[case.get('name')] = PASSED if case.get('status') == 'run' else SKIPPED if meant else FAILED
    return result


def main():
    with open(sys.argv[1], encoding='utf-8') as file:
        tests = json.load(file)['tests']
    ran = outcomes(sys.argv[2])
    total = [0, 0, 0]
    for test in tests:
        outcome = ran.get(test['name'], FAILED)
        file = own_file(test)
        count = cases(file) if file else [0, 0, 0]
        if file and outcome == PASSED and sum(count) == 0:
            outcome = FAILED  # says it passed, but ran nothing
        if outcome == FAILED and count[FAILED] == 0 or sum(count) == 0:
            count[outcome] += 1
        total = [a + b for a, b in zip(total, count)]
    text = '%d passed, %d failed' % (total[PASSED], total[FAILED])
    print(text + (', %d skipped' % total[SKIPPED] if total[SKIPPED] else ''))
    return 1 if total[FAILED] or not total[PASSED] else 0


if __name__ == '__main__':
    sys.exit(main())

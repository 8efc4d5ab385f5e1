"""A part of a script in a process of its own, so that no package is in another's way."""

import json
import subprocess
import sys


def result(script, *arguments):
    """What `script --one ARGUMENTS` prints in its last line, which is JSON."""
    command = [sys.executable, script, "--one", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{', '.join(arguments)}: {done.stderr.strip().splitlines()[-1]}")
    return json.loads(done.stdout.splitlines()[-1])

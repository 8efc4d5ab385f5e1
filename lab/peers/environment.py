"""The virtual environment with the pinned packages."""

import os
import subprocess
import sys
import venv
from pathlib import Path


def enter(folder, requirements, further=()):
    """Runs the script again in the virtual environment in `folder`, which is created if it is missing. The packages in
    `further` are built anew each time."""
    if sys.version_info < (3, 11):
        sys.exit(f"Python 3.11 or later is needed, this is {sys.version.split()[0]}")
    if Path(sys.prefix).resolve() == folder:
        return
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    installed = folder / "installed.txt"
    if not installed.exists() or installed.read_text() != requirements.read_text():
        print(f"installing the peers into {folder.name}", file=sys.stderr)
        try:
            venv.create(folder, clear=True, with_pip=True)
        except (OSError, subprocess.CalledProcessError) as error:
            sys.exit(f"cannot make a virtual environment in {folder}: {error}")
        install(python, "-r", requirements)
        installed.write_text(requirements.read_text())
    for package in further:
        install(python, "--no-deps", "--force-reinstall", package)
    # Not exec: on Windows it would return to the shell at once.
    sys.exit(subprocess.run([python, *sys.argv]).returncode)


def install(python, *what):
    command = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *what]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        complaint = (done.stderr.strip() or "no message").splitlines()[-1]
        sys.exit(f"cannot install {what[-1]}: {complaint}")

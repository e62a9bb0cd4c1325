"""The command line `switchid`, called as a user calls it: files in, one JSON document out."""

import json
import subprocess
from pathlib import Path


class CommandFailed(RuntimeError):
    """A command ended with an error."""


class CommandLine:
    """The program, working in one directory."""

    def __init__(self, program: Path, directory: Path):
        self.program = program.resolve()
        self.directory = directory

    def json(self, *arguments: str) -> dict:
        """Runs a command with `--json`; its document."""
        command = [str(self.program), *arguments, "--json"]
        done = subprocess.run(command, cwd=self.directory, capture_output=True, text=True)
        if done.returncode:
            said = done.stderr.strip()
            raise CommandFailed(f"in {self.directory}: {' '.join(command)}\n{said}\n{_error(said)}")
        return json.loads(done.stdout)


def _error(said: str) -> str:
    """The error that the last line of stderr tells as JSON; empty where it tells none."""
    try:
        return json.loads(said.splitlines()[-1])["error"]
    except (IndexError, KeyError, TypeError, ValueError):
        return ""

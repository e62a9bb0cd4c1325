"""Fetches pip's wheel, which runs without being installed, where Python comes without ensurepip.

Usage: fetch_pip.py VERSION SHA256 FILE
"""

import configparser
import hashlib
import os
import pathlib
import re
import sys
import urllib.parse
import urllib.request


def wheel_address(index, version):
    """Address of the wheel on the index's page of pip."""
    page_address = index.rstrip("/") + "/pip/"
    page = urllib.request.urlopen(page_address, timeout=60).read().decode()
    link = re.search(rf'href="([^"]*/pip-{re.escape(version)}-py3-none-any\.whl)[^"]*"', page)
    if link is None:
        sys.exit(f"{page_address} does not offer pip {version}: set PIP_INDEX_URL to an index that does")
    return urllib.parse.urljoin(page_address, link.group(1))


def index_address():
    """Address of the package index: PIP_INDEX_URL, else what pip's configuration files say."""
    files = configparser.RawConfigParser()
    home = pathlib.Path.home()
    files.read([pathlib.Path("/etc/pip.conf"), home / ".pip/pip.conf", home / ".config/pip/pip.conf"])
    index = os.environ.get("PIP_INDEX_URL") or files.get("global", "index-url", fallback=None)
    if index is None:
        sys.exit(
            "this Python has no ensurepip, and no package index is named to fetch pip from: "
            "apt-get install python3-venv, or set PIP_INDEX_URL"
        )
    return index


def main():
    version, expected, path = sys.argv[1:]
    index = index_address()
    wheel = urllib.request.urlopen(wheel_address(index, version), timeout=60).read()
    found = hashlib.sha256(wheel).hexdigest()
    if found != expected:
        sys.exit(f"pip {version} from {index} has the checksum {found}, not {expected}: it is refused")
    with open(path, "wb") as file:
        file.write(wheel)


main()
